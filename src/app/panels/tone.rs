//! The view of the picture and its brightness.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Channel, Show, Tone, ViewState};
use crate::app::toolkit::widgets::{
    About, Header, Number, add_command, compact, entry, fold, list, row, switch,
};
use eframe::egui::{Checkbox, Ui};

/// Draws the view and its brightness.
pub fn ui(ui: &mut Ui, view: &mut ViewState, cx: &PanelContext) {
    let (show, channel) = (view.show(), view.tone.channel);
    let mut summary = vec![show.name().trim_end_matches('…').to_lowercase()];
    summary.extend(view.shows_denoised().then(|| "denoised".to_owned()));
    summary.extend(channel.map(|channel| channel.name().to_lowercase()));
    if view.tone.exposure != 0.0 {
        let sign = if view.tone.exposure > 0.0 { "+" } else { "" };
        summary.push(format!("{sign}{} stops", compact(view.tone.exposure)));
    }
    let header = Header { title: "View", summary: &summary.join(", "), ..Header::default() };
    fold(ui, header, false, |ui| {
        let about = About::new("Show", "What is shown; files are saved as Picture");
        list(ui, about, show.name(), |ui| {
            for show in Show::ALL {
                let (command, reason) = (Command::Show(show), cx.model.useless_show(show));
                let about = About::new(show.name(), command.help()).disabled_if(reason.as_deref());
                if entry(ui, cx.is_on(command), about) {
                    cx.send(command);
                }
            }
        });
        let mut is_denoised = view.is_denoised;
        let denoise = Checkbox::new(&mut is_denoised, Command::Denoise.name());
        add_command(ui, cx, Command::Denoise, denoise);
        let reason = cx.model.no_exposure();
        brightness_ui(ui, &mut view.tone, reason.as_deref());
    });
}

fn brightness_ui(ui: &mut Ui, tone: &mut Tone, reason: Option<&str>) {
    let help = "Show one channel alone, as grey (Shift+R, G, B)";
    row(ui, About::new("Channels", help).disabled_if(reason), |ui| {
        let [red, green, blue] = Channel::ALL.map(Some);
        let options = [(None, "RGB"), (red, "R"), (green, "G"), (blue, "B")]
            .map(|(channel, name)| (channel, About::new(name, help).disabled_if(reason)));
        tone.channel = switch(ui, 0.0, tone.channel, &options).unwrap_or(tone.channel);
    });
    let help = "Brightens what you see by powers of two; saved files stay as they are (+, −, 0)";
    let about = About::new("Exposure", help).disabled_if(reason);
    let number = Number::new(about, Tone::EXPOSURES).unit(" stops").speed(0.02);
    number.slider(ui, &mut tone.exposure, Tone::EXPOSURES, false);
}
