//! The right panel: its tabs, and the view and the pixel at its foot.

use super::model::remembered::Tab;
use super::theme;
use super::widgets::{Sign, sign_button, tip};
use eframe::egui::{
    Align, Button, CentralPanel, Layout, Margin, Panel, Rangef, RichText, Role, ScrollArea, Sense, Stroke,
    Ui, UiBuilder, WidgetInfo, vec2,
};

/// Height of the tabs, points.
const TABS: f32 = 40.0;

/// Points that are left for the picture.
const PICTURE: f32 = 240.0;

impl Tab {
    fn name(self) -> &'static str {
        match self {
            Tab::Stage => "Stage",
            Tab::Code => "Code",
            Tab::Check => "Check",
            Tab::Controls => "Controls",
        }
    }

    fn width(self) -> f32 {
        match self {
            Tab::Stage | Tab::Controls => 272.0,
            Tab::Code => 536.0,
            Tab::Check => 360.0,
        }
    }
}

/// The panel for a tab, within `room`. The width of each tab is remembered.
pub fn panel(tab: Tab, room: f32) -> Panel {
    let widest = (room - PICTURE).max(272.0);
    Panel::right(tab.name())
        .default_size(tab.width().min(widest))
        .size_range(Rangef::new(240.0, widest))
        .frame(theme::panel(Margin::ZERO))
}

/// Draws the tabs. Returns the one to show from now on, and whether the present one was closed.
pub fn tabs(ui: &mut Ui, tabs: &[Tab], shown: Tab) -> (Tab, bool) {
    let colours = theme::colours(ui);
    ui.spacing_mut().item_spacing.y = 0.0;
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), TABS), Sense::hover());
    let layout = Layout::left_to_right(Align::Center);
    let mut row = ui.new_child(UiBuilder::new().max_rect(rect.shrink2(vec2(16.0, 0.0))).layout(layout));
    row.spacing_mut().item_spacing.x = 16.0;
    row.spacing_mut().button_padding.x = 0.0;
    let (mut chosen, mut is_closed) = (shown, false);
    for tab in tabs {
        let is_on = *tab == shown;
        let text = RichText::new(tab.name()).color(if is_on { colours.strong } else { colours.weak });
        let response = row.add(Button::new(text).frame(false).min_size(vec2(0.0, TABS)));
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, is_on, tab.name()));
        if is_on {
            let stroke = Stroke::new(2.0, colours.accent);
            row.painter().hline(response.rect.x_range().expand(8.0), rect.bottom() - 1.0, stroke);
        }
        if response.clicked() {
            chosen = *tab;
        }
    }
    if matches!(shown, Tab::Code | Tab::Check) {
        row.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let name = format!("Close {}", shown.name().to_lowercase());
            let response = sign_button(ui, Sign::Close, 24.0, &name);
            is_closed = tip(ui, response, "Back to the stage", None).clicked();
        });
    }
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    ui.painter().hline(rect.x_range(), rect.bottom(), line);
    (if is_closed { Tab::Stage } else { chosen }, is_closed)
}

/// What stays at the foot of the panel, at the same height for all stages.
pub fn foot(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let frame = theme::panel(Margin::symmetric(16, 4));
    Panel::bottom("foot").resizable(false).frame(frame).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 8.0;
        content(ui);
    });
}

/// What scrolls above the foot.
pub fn scrolling(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    CentralPanel::default().frame(theme::panel(Margin::ZERO)).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            theme::panel(Margin::same(16)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 8.0;
                content(ui);
            });
        });
    });
}
