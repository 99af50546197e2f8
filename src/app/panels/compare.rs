//! The partner of a comparison, and the tools to compare, which are the same for every partner.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Dock, Partner};
use crate::app::toolkit::menu::item;
use crate::app::toolkit::number::samples_words;
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{About, caption, command_button, command_switch, list, small};
use crate::stages::Stage;
use eframe::egui::{Label, RichText, Ui};

/// The partner and the tools.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    // What grows stands above the buttons, which stay where they are. The dock says it beside the speeds.
    if cx.model.other_device().is_none()
        || cx.model.remembered.dock != Some(Dock::Error)
        || cx.other.is_none()
    {
        verdict(ui, cx);
    }
    if cx.model.view.mode().is_some() && cx.model.not_subtractable().is_some() {
        command_button(ui, cx, Command::RenderAtPartnerSize, "Render at its size");
    }
    let shown = cx.model.view.compared(cx.document()).map(|partner| cx.model.partner_name(partner));
    let about = About::new("Compare with", "Another picture, to be wiped, flipped and subtracted");
    ui.scope(|ui| {
        ui.spacing_mut().combo_width = ui.available_width() - 100.0;
        list(ui, about, shown.as_deref().unwrap_or("Choose…"), |ui| partners(ui, cx));
    });
    if cx.model.view.mode().is_some() {
        tools(ui, cx);
    }
}

fn partners(ui: &mut Ui, cx: &PanelContext) {
    let choose = |ui: &mut Ui, command: Command| _ = item(ui, cx, command);
    for partner in cx.model.partners() {
        choose(ui, Command::CompareWith(partner));
    }
    choose(ui, Command::CompareFile);
    caption(ui, "Another stage");
    let others = Stage::ALL.iter().filter(|stage| cx.document().stage() != Some(stage));
    others.for_each(|stage| choose(ui, Command::CompareWith(Partner::Stage(stage))));
}

/// The tools, which are the same for every partner.
pub fn tools(ui: &mut Ui, cx: &PanelContext) {
    const TOOLS: [(&str, Command); 3] =
        [("Wipe", Command::Wipe), ("Flip", Command::Flip), ("Difference", Command::Difference)];
    command_switch(ui, cx, 0.0, &TOOLS);
    command_button(ui, cx, Command::AreSame, &Command::AreSame.name());
}

/// Whether the two differ by more than noise, or how far the other picture is.
pub fn verdict(ui: &mut Ui, cx: &PanelContext) {
    if let Some(verdict) = &cx.verdict {
        let colours = theme::colours(ui);
        let color = match verdict.is_equal {
            Some(true) => colours.good,
            Some(false) => colours.warn,
            None => colours.weak,
        };
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.label(RichText::new(verdict.headline).small().color(color));
            ui.add(Label::new(RichText::new(&verdict.words).small()).wrap());
        });
        return;
    }
    let [[_, name], _] = cx.model.side_names();
    match (&cx.other, cx.model.view.compared(cx.document())) {
        (_, None | Some(Partner::Kept(_) | Partner::Mine)) => {}
        (Some(other), _) => {
            _ = small(ui, format!("{name}: {}", samples_words(other.samples_per_pixel)));
        }
        (None, Some(_)) => _ = small(ui, format!("{name} is getting ready\u{2026}")),
    }
}
