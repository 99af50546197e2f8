//! The dock under the picture: a path, the kept pictures, and the error over time.

use super::Tools;
use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Dock, Model, Partner, ViewState};
use crate::app::panels::{compare, plot};
use crate::app::toolkit::menu::item;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{
    TABS, choice, command_button, hint, panel_line, samples_words, sign_button, small, tip,
};
use crate::system::memory::words;
use eframe::egui::{
    self, Align, Atom, Frame, Image, Label, Layout, Margin, RichText, Role, ScrollArea, Sides, Ui, Vec2,
    WidgetInfo, vec2,
};

/// Height at first, at least, and in low windows, points.
const HEIGHT: f32 = 276.0;
const LEAST: f32 = 160.0;
const LOW: f32 = 200.0;

/// A card: its picture, and its height with the name.
const PICTURE: Vec2 = vec2(132.0, 74.0);
const CARD: f32 = 102.0;

/// Draws the dock.
pub fn ui(ui: &mut Ui, model: &mut Model, tools: &mut Tools, cx: &PanelContext) {
    let Some(dock) = model.remembered.dock else { return };
    let height = ui.ctx().content_rect().height();
    let usual = if height < 700.0 { LOW } else { HEIGHT };
    egui::Panel::bottom("dock")
        .frame(theme::panel(Margin::ZERO))
        .resizable(true)
        .default_size(usual)
        .size_range(LEAST..=(0.5 * height).max(LEAST))
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let row = Frame::new().inner_margin(Margin::symmetric(16, 0));
            row.show(ui, |ui| tabs(ui, dock, model, cx));
            panel_line(ui);
            Frame::new().inner_margin(Margin { left: 16, right: 16, top: 8, bottom: 8 }).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 8.0;
                match dock {
                    Dock::Path => tools.paths.ui(ui),
                    Dock::Kept => kept_ui(ui, model, cx),
                    Dock::Error => plot::ui(ui, cx),
                }
                ui.take_available_space();
            });
        });
}

fn tabs(ui: &mut Ui, dock: Dock, model: &mut Model, cx: &PanelContext) {
    let shown = &mut model.remembered.dock;
    let tabs = [
        (Dock::Path, "Path", Command::ClearPaths),
        (Dock::Kept, "Kept pictures", Command::KeptDock),
        (Dock::Error, "Error", Command::ErrorDock),
    ];
    let left = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        for (tab, name, command) in tabs {
            if tab != Dock::Path || dock == tab || cx.has_paths {
                let response = crate::app::toolkit::widgets::tab(ui, name, dock == tab);
                if tip(ui, response, command.help(), None).clicked() {
                    *shown = Some(tab);
                }
            }
        }
    };
    let right = |ui: &mut Ui| {
        let close = sign_button(ui, "×", 24.0, "Close dock");
        if tip(ui, close, "Closes the dock (Escape)", None).clicked() {
            tabs.iter().filter(|(tab, ..)| *tab == dock).for_each(|(.., command)| cx.send(*command));
        }
    };
    Sides::new().height(TABS).shrink_left().show(ui, left, right);
}

/// Its context menu.
const MENU: [Command; 6] = [
    Command::Flip,
    Command::Wipe,
    Command::Difference,
    Command::OnlyNoise,
    Command::GoOnFromKept,
    Command::DeleteKept,
];

fn kept_ui(ui: &mut Ui, model: &mut Model, cx: &PanelContext) {
    let list = &model.view.kept;
    if list.get(0).is_none() {
        hint(ui, "Nothing is kept yet. M keeps the picture as it is now, to compare with later.");
        return;
    }
    ui.horizontal_wrapped(|ui| {
        command_button(ui, cx, Command::Keep, "Keep");
        command_button(ui, cx, Command::CompareFile, "File…");
        if model.view.kept_partner().is_some() {
            compare::tools(ui, cx);
        }
        let memory = words(list.bytes());
        small(ui, format!("Kept pictures take {memory}. They are gone when the window closes."));
    });
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(20.0, 8.0);
            for place in 0..model.view.kept.iter().count() {
                card(ui, place, &mut model.view, cx);
            }
        });
    });
}

fn card(ui: &mut Ui, place: usize, view: &mut ViewState, cx: &PanelContext) {
    let Some(kept) = view.kept.get(place).cloned() else { return };
    let partner = Partner::Kept(kept.number);
    let (is_chosen, title) = (view.partner == partner, view.kept.title(&kept));
    let layout = Layout::top_down(Align::Min);
    let added = ui.allocate_ui_with_layout(vec2(PICTURE.x + 16.0, CARD), layout, |ui| {
        ui.spacing_mut().item_spacing.y = 4.0;
        let picture = Image::new(&kept.thumbnail).fit_to_exact_size(PICTURE);
        let button = choice(ui, is_chosen, (Atom::grow(), picture, Atom::grow()));
        let response = ui.add(button.min_size(PICTURE + vec2(16.0, 8.0)));
        response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen, &title));
        ui.add(Label::new(RichText::new(&title).small()).truncate());
        response
    });
    let response = added.inner;
    let chosen = ui.scope_id().with("chosen");
    if is_chosen && ui.data(|data| data.get_temp(chosen)) != Some(kept.number) {
        ui.data_mut(|data| data.insert_temp(chosen, kept.number));
        added.response.scroll_to_me(None);
    }
    if response.double_clicked() {
        view.look(place);
    } else if response.clicked() || response.secondary_clicked() {
        view.partner = partner;
    }
    response.context_menu(|ui| MENU.iter().for_each(|command| _ = item(ui, cx, *command)));
    let ([width, height], memory) = (kept.size(), words(kept.bytes()));
    let help = format!("{}, {}, {width} × {height}, {memory}", kept.name, samples_words(kept.samples()));
    tip(ui, response, &help, None);
}
