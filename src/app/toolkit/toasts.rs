//! Short messages over the picture.

use super::theme;
use super::widgets::sign_button;
use crate::app::commands::Command;
use crate::system::console;
use eframe::egui::{self, Align2, Id, Label, Rect, RichText, accesskit::Live, vec2};
use std::time::{Duration, Instant};

/// How long a message is shown that doesn't stay.
const LIFETIME: Duration = Duration::from_secs(4);

const WIDTH: f32 = 320.0;

struct Toast {
    text: String,
    is_error: bool,
    since: Instant,
    /// It stays until it is closed or withdrawn.
    stays: bool,
    /// What it offers to do.
    offers: Vec<Command>,
    /// Its lower edge above that of the picture, and its height, points. It never moves.
    place: Option<(f32, f32)>,
}

impl Toast {
    /// How long the message is still shown, if it does not stay.
    fn left(&self) -> Option<Duration> {
        (!self.stays).then(|| LIFETIME.saturating_sub(self.since.elapsed()))
    }
}

/// The visible messages.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

impl Toasts {
    /// Reports a success.
    pub fn good(&mut self, text: impl Into<String>) {
        self.add(text.into(), false);
    }

    /// Reports a failure, both in the window and on the terminal. It stays until it is closed.
    pub fn bad(&mut self, text: impl Into<String>) {
        let text = text.into();
        console::note(&format!("weekender: {text}"));
        self.add(text, true);
    }

    /// Reports what is remarkable about a render, both in the window and on the terminal.
    pub fn note(&mut self, text: &str) {
        console::note(&format!("weekender: {text}"));
        self.good(text);
    }

    /// Reports a success, and offers commands that follow from it.
    pub fn good_with(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.good(text);
        self.add_offers(offers);
    }

    /// Adds commands to the newest message.
    pub fn add_offers(&mut self, offers: &[Command]) {
        self.0.last_mut().into_iter().for_each(|toast| toast.offers.extend_from_slice(offers));
    }

    /// Offers commands until one is chosen or all are withdrawn.
    pub fn offer(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.good_with(text, offers);
        self.0.last_mut().into_iter().for_each(|toast| toast.stays = true);
    }

    /// Removes the messages that offer this command.
    pub fn withdraw(&mut self, command: Command) {
        self.0.retain(|toast| !toast.offers.contains(&command));
    }

    fn add(&mut self, text: String, is_error: bool) {
        self.0.retain(|toast| toast.text != text);
        let since = Instant::now();
        self.0.push(Toast { text, is_error, since, stays: is_error, offers: Vec::new(), place: None });
    }

    /// The visible messages, oldest first.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|toast| toast.text.as_str())
    }

    /// Draws the messages above the lower edge of `over`.
    pub fn ui(&mut self, ui: &egui::Ui, over: Rect, commands: &mut Vec<Command>) {
        self.0.retain(|toast| toast.left() != Some(Duration::ZERO));
        if let Some(first) = self.0.iter().filter_map(Toast::left).min() {
            ui.ctx().request_repaint_after(first);
        }
        let mut closed = None;
        for index in 0..self.0.len() {
            let ends = self.0.iter().filter_map(|toast| toast.place).map(|(at, height)| at + height + 8.0);
            let free = ends.fold(16.0, f32::max);
            let toast = &mut self.0[index];
            let at = toast.place.map_or(free, |(at, _)| at);
            let shown = egui::Area::new(Id::unique(("toast", &toast.text)))
                .order(egui::Order::Foreground)
                .pivot(Align2::CENTER_BOTTOM)
                .fixed_pos(over.center_bottom() - vec2(0.0, at))
                .constrain_to(over)
                .show(ui.ctx(), |ui| {
                    let width = WIDTH.min(over.width() - 16.0) - 26.0;
                    theme::float_frame(ui)
                        .show(ui, |ui| {
                            ui.set_width(width);
                            toast.ui(ui, commands)
                        })
                        .inner
                });
            toast.place = Some((at, shown.response.rect.height()));
            if shown.inner {
                closed = Some(index);
            }
        }
        if let Some(index) = closed {
            self.0.remove(index);
        }
    }
}

impl Toast {
    /// Draws it. Returns whether it was closed.
    fn ui(&self, ui: &mut egui::Ui, commands: &mut Vec<Command>) -> bool {
        let mut is_closed = false;
        ui.horizontal_top(|ui| {
            let colours = theme::colours(ui);
            let color = if self.is_error { colours.bad } else { colours.text };
            let room = ui.available_width() - 28.0;
            ui.vertical(|ui| {
                ui.set_width(room);
                let label = ui.add(Label::new(RichText::new(&self.text).color(color)).wrap());
                let live = if self.is_error { Live::Assertive } else { Live::Polite };
                label.ctx.accesskit_node_builder(label.id, |node| node.set_live(live));
                if self.offers.is_empty() {
                    return;
                }
                ui.horizontal_wrapped(|ui| {
                    for command in &self.offers {
                        if ui.button(command.name()).on_hover_text(command.help()).clicked() {
                            commands.push(*command);
                            is_closed = true;
                        }
                    }
                });
            });
            is_closed |= sign_button(ui, "×", 20.0, "Close this message").clicked();
        });
        is_closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn a_message_is_told_once_and_the_newest_is_the_last() {
        let mut toasts = Toasts::default();
        for text in ["first", "second", "first"] {
            toasts.good(text);
        }
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["second", "first"]);
    }

    #[test]
    fn errors_stay_and_nothing_moves() {
        let mut toasts = Toasts::default();
        toasts.good("old");
        toasts.bad("failed");
        let context = egui::Context::default();
        let over = Rect::from_min_size(pos2(0.0, 0.0), vec2(600.0, 400.0));
        let draw = |toasts: &mut Toasts| {
            context
                .run_ui(egui::RawInput::default(), |ui| toasts.ui(ui, over, &mut Vec::new()))
                .textures_delta
                .clear();
        };
        draw(&mut toasts);
        let before = toasts.0[1].place;
        for toast in &mut toasts.0 {
            toast.since = Instant::now().checked_sub(Duration::from_secs(60)).unwrap();
        }
        draw(&mut toasts);
        assert_eq!(toasts.texts().collect::<Vec<_>>(), ["failed"]);
        assert!(
            before.is_some_and(|(at, _)| at > 16.0) && toasts.0[0].place.map(|p| p.0) == before.map(|p| p.0)
        );
    }
}
