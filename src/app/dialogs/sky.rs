//! The dialog for the colours of the sky.

use super::outcome::Outcome;
use crate::app::commands::PanelContext;
use crate::app::model::Edit;
use crate::app::toolkit::widgets::{About, Header, colour, group, hint};
use eframe::egui::Ui;

const HELP: &str = "The sky is the only lamp of the book: what it sends is what lights the scene.";

/// Draws the dialog. The picture shows a change at once.
pub(super) fn ui(ui: &mut Ui, cx: &PanelContext) -> Outcome {
    let (mut sky, own) = (cx.document().scene().sky, cx.document().origin.recipe.scene.sky);
    let reset = (sky != own).then_some("Reset sky");
    let header = Header { title: "Sky colours", reset, ..Header::default() };
    let is_reset = group(ui, header, |ui| {
        colour(ui, About::new("Overhead", "The light from straight above"), &mut sky.top);
        colour(
            ui,
            About::new("At the horizon", "The light from straight below, which fades upwards"),
            &mut sky.bottom,
        );
    });
    if is_reset {
        sky = own;
    }
    if sky != cx.document().scene().sky {
        cx.edit(Edit::Sky(sky));
    }
    hint(ui, HELP);
    if ui.button("Close").clicked() { Outcome::Close } else { Outcome::Stay }
}
