//! The view of the picture and its brightness.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Show, Tone, ViewState};
use crate::app::toolkit::menu::item;
use crate::app::toolkit::number::{Number, compact};
use crate::app::toolkit::widgets::{About, add_command, fold, list};
use eframe::egui::{Checkbox, Ui};

/// Draws the view and its brightness.
pub fn ui(ui: &mut Ui, view: &mut ViewState, cx: &PanelContext) {
    let show = view.show();
    let mut summary = vec![show.name().trim_end_matches('…').to_lowercase()];
    summary.extend(view.shows_denoised().then(|| "denoised".to_owned()));
    if view.tone.exposure != 0.0 {
        let sign = if view.tone.exposure > 0.0 { "+" } else { "" };
        summary.push(format!("{sign}{} stops", compact(view.tone.exposure)));
    }
    fold(ui, ["View", &summary.join(", ")], false, |ui| {
        let about = About::new("Show", "What is shown; files are saved as Picture");
        list(ui, about, show.name(), |ui| {
            Show::ALL.iter().for_each(|show| _ = item(ui, cx, Command::Show(*show)));
        });
        let mut is_denoised = view.is_denoised;
        let denoise = Checkbox::new(&mut is_denoised, Command::Denoise.name());
        add_command(ui, cx, Command::Denoise, denoise);
        let (help, reason) = (
            "Brightens what you see by powers of two; saved files stay as they are (+, −, 0)",
            cx.model.no_exposure(),
        );
        let about = About::new("Exposure", help).disabled_if(reason.as_deref());
        let number = Number::new(about, Tone::EXPOSURES).unit(" stops").speed(0.02);
        number.slider(ui, &mut view.tone.exposure, Tone::EXPOSURES, false);
    });
}
