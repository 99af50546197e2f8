//! Short messages over the picture.

use super::command::Command;
use super::theme;
use crate::system::console;
use eframe::egui::{self, Align2, Color32, RichText};
use std::time::{Duration, Instant};

/// The kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// Success.
    Good,
    /// Failure.
    Bad,
}

struct Toast {
    text: String,
    tone: Tone,
    since: Instant,
    /// The run of the render whose picture it is about, if it is about a picture.
    run: Option<u64>,
    /// What it offers to do.
    offers: Vec<Command>,
    /// It stays until it is closed.
    stays: bool,
}

impl Toast {
    /// How long the message is still shown, if it does not stay.
    fn left(&self) -> Option<Duration> {
        (!self.stays).then(|| lifetime(self.tone).saturating_sub(self.since.elapsed()))
    }
}

/// The visible messages.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

/// How long a message is shown. Failures stay longer, because users have to read them.
fn lifetime(tone: Tone) -> Duration {
    match tone {
        Tone::Good => Duration::from_secs(4),
        Tone::Bad => Duration::from_secs(15),
    }
}

impl Toasts {
    /// Reports a success.
    pub fn good(&mut self, text: impl Into<String>) {
        self.add(text.into(), Tone::Good);
    }

    /// Reports a failure, both in the window and on the terminal.
    pub fn bad(&mut self, text: impl Into<String>) {
        let text = text.into();
        console::note(&format!("weekender: {text}"));
        self.add(text, Tone::Bad);
    }

    /// Reports what is wrong with the picture of the render with this run, in the window and on the terminal.
    pub fn warn(&mut self, text: impl Into<String>, run: u64) {
        self.bad(text);
        if let Some(toast) = self.0.last_mut() {
            toast.run = Some(run);
        }
    }

    /// Removes what was wrong with the pictures of other runs than this one.
    pub fn end_warnings(&mut self, run: u64) {
        self.0.retain(|toast| toast.run.is_none_or(|of| of == run));
    }

    /// Reports a success, and offers commands that follow from it.
    pub fn good_with(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.good(text);
        if let Some(toast) = self.0.last_mut() {
            toast.offers = offers.to_vec();
        }
    }

    /// Adds a command to the newest message.
    pub fn add_offer(&mut self, command: Command) {
        self.0.last_mut().into_iter().for_each(|toast| toast.offers.push(command));
    }

    /// Reports something that calls for a command. The message stays until it is closed, or an offer withdrawn.
    pub fn offer(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.good_with(text, offers);
        if let Some(toast) = self.0.last_mut() {
            toast.stays = true;
        }
    }

    /// Removes the messages that offer this command.
    pub fn withdraw(&mut self, command: Command) {
        self.0.retain(|toast| !toast.offers.contains(&command));
    }

    fn add(&mut self, text: String, tone: Tone) {
        self.0.retain(|toast| toast.text != text);
        self.0.push(Toast { text, tone, since: Instant::now(), run: None, offers: Vec::new(), stays: false });
    }

    /// The visible messages, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|toast| toast.text.as_str())
    }

    pub fn ui(&mut self, ui: &egui::Ui, over: egui::Rect, commands: &mut Vec<Command>) {
        self.0.retain(|toast| toast.left() != Some(Duration::ZERO));
        if self.0.is_empty() {
            return;
        }
        if let Some(first) = self.0.iter().filter_map(Toast::left).min() {
            ui.ctx().request_repaint_after(first);
        }
        let mut closed = None;
        egui::Area::new(egui::Id::unique("toasts"))
            .order(egui::Order::Foreground)
            .pivot(Align2::CENTER_BOTTOM)
            .fixed_pos(over.center_bottom() - egui::vec2(0.0, 14.0))
            .constrain_to(over)
            .show(ui.ctx(), |ui| {
                ui.set_max_width((over.width() - 24.0).clamp(120.0, 520.0));
                for (index, toast) in self.0.iter().enumerate() {
                    theme::float_frame(ui).show(ui, |ui| {
                        ui.horizontal_top(|ui| {
                            let colour = match toast.tone {
                                Tone::Good => ui.visuals().text_color(),
                                Tone::Bad => ui.visuals().error_fg_color,
                            };
                            let close = egui::Button::new(RichText::new("×").strong())
                                .fill(Color32::TRANSPARENT)
                                .small();
                            let room = ui.available_width() - 28.0;
                            ui.scope(|ui| {
                                ui.set_max_width(room);
                                let words = RichText::new(&toast.text).color(colour);
                                ui.vertical(|ui| {
                                    ui.add(egui::Label::new(words).wrap());
                                    if toast.offers.is_empty() {
                                        return;
                                    }
                                    ui.horizontal_wrapped(|ui| {
                                        for command in &toast.offers {
                                            let button = ui.button(command.name());
                                            if button.on_hover_text(command.help()).clicked() {
                                                commands.push(*command);
                                                closed = Some(index);
                                            }
                                        }
                                    });
                                });
                            });
                            if ui.add(close).on_hover_text("Close this message").clicked() {
                                closed = Some(index);
                            }
                        });
                    });
                }
            });
        if let Some(index) = closed {
            self.0.remove(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use eframe::egui::{Rect, pos2, vec2};

    #[test]
    fn a_message_is_told_once_and_the_newest_is_the_last() {
        let mut toasts = Toasts::default();
        for text in ["first", "second", "first"] {
            toasts.good(text);
        }
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["second", "first"]);
        assert!(toasts.0.iter().all(|toast| toast.tone == Tone::Good));
    }

    #[test]
    fn a_warning_ends_with_its_picture() {
        let mut toasts = Toasts::default();
        toasts.warn("too thin", 1);
        toasts.warn("no light", 1);
        toasts.bad("not saved");
        toasts.end_warnings(1);
        assert_eq!(toasts.texts().count(), 3);
        toasts.warn("too thin", 2);
        toasts.end_warnings(2);
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["not saved", "too thin"]);
        toasts.end_warnings(3);
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["not saved"]);
    }

    #[test]
    fn failures_stay_longer() {
        let ages = [(4.0, Tone::Good), (11.0, Tone::Bad), (15.0, Tone::Bad)];
        let toast = |(seconds, tone)| Toast {
            text: format!("{seconds}"),
            tone,
            since: Instant::now().checked_sub(Duration::from_secs_f64(seconds)).unwrap(),
            run: None,
            offers: Vec::new(),
            stays: false,
        };
        let mut toasts = Toasts(ages.into_iter().map(toast).collect());
        let context = egui::Context::default();
        let over = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 400.0));
        let _ = context.run_ui(egui::RawInput::default(), |ui| toasts.ui(ui, over, &mut Vec::new()));
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["11"]);
    }
}
