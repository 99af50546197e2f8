//! Short messages below the picture, or over it where there is no room: at most two, one of a kind.

use super::theme;
use super::widgets::sign_button;
use crate::app::commands::Command;
use crate::app::model::Document;
use crate::system::console;
use eframe::egui::{self, Align2, Id, Label, Rect, RichText, accesskit::Live, vec2};
use std::time::{Duration, Instant};

/// How long a message is shown that doesn't stay.
const LIFETIME: Duration = Duration::from_secs(4);

const WIDTH: f32 = 320.0;

/// Messages shown at a time.
const SHOWN: usize = 2;

struct Toast {
    text: String,
    is_error: bool,
    since: Instant,
    /// It stays until it is closed or withdrawn.
    stays: bool,
    /// Commands that it offers.
    offers: Vec<Command>,
    /// The document in which Undo and Redo do what it offers, once that is known.
    of: Option<Document>,
}

impl Toast {
    /// How long the message is still shown, if it does not stay.
    fn left(&self) -> Option<Duration> {
        (!self.stays).then(|| LIFETIME.saturating_sub(self.since.elapsed()))
    }

    /// What an error is about: the words before the colon.
    fn subject(&self) -> Option<&str> {
        self.is_error.then(|| self.text.split(':').next().unwrap_or_default())
    }

    /// Whether this message replaces `other`. Of two errors it does so if they are about the same, of two offers if they
    /// offer the same.
    fn is_like(&self, other: &Toast) -> bool {
        let is_offer = |toast: &Toast| toast.stays && !toast.is_error;
        self.subject() == other.subject()
            && is_offer(self) == is_offer(other)
            && (!is_offer(self) || self.offers == other.offers)
    }

    /// Whether it offers something that another change of the document would make wrong.
    fn is_about_changes(&self) -> bool {
        self.offers.iter().any(|offer| matches!(offer, Command::Undo | Command::Redo))
    }
}

/// The visible messages.
#[derive(Default)]
pub struct Toasts(Vec<Toast>);

impl Toasts {
    /// Reports a success.
    pub fn good(&mut self, text: impl Into<String>) {
        self.good_with(text, &[]);
    }

    /// Reports a failure, both in the window and on the terminal. It stays until it is closed or no longer true. What it
    /// is about is said before its colon.
    pub fn bad(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.texts().any(|known| known == text) {
            console::note(&format!("weekender: {text}"));
        }
        self.add(text, (true, true), &[]);
    }

    /// Reports what is remarkable about a render, both in the window and on the terminal.
    pub fn note(&mut self, text: &str) {
        console::note(&format!("weekender: {text}"));
        self.good(text);
    }

    /// Reports a success, and offers commands that follow from it.
    pub fn good_with(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.add(text.into(), (false, false), offers);
    }

    /// Adds commands to the newest message.
    pub fn add_offers(&mut self, offers: &[Command]) {
        self.0.last_mut().into_iter().for_each(|toast| toast.offers.extend_from_slice(offers));
    }

    /// Offers commands until one is chosen or all are withdrawn.
    pub fn offer(&mut self, text: impl Into<String>, offers: &[Command]) {
        self.add(text.into(), (false, true), offers);
    }

    /// Removes the messages that offer this command.
    pub fn withdraw(&mut self, command: Command) {
        self.0.retain(|toast| !toast.offers.contains(&command));
    }

    /// Removes the error about `subject`, which is no longer true.
    pub fn end_error(&mut self, subject: &str) {
        self.0.retain(|toast| toast.subject() != Some(subject));
    }

    /// Removes errors about what the user asked for.
    pub fn end_refusals(&mut self) {
        self.0.retain(|toast| !toast.subject().is_some_and(|subject| subject.starts_with("Not ")));
    }

    /// Closes the newest message that stays, except one of work in progress. Returns whether there was one.
    pub fn close_newest(&mut self) -> bool {
        let is_closed = |toast: &Toast| toast.stays && !toast.offers.contains(&Command::StopSaving);
        let newest = self.0.iter().rposition(is_closed);
        newest.map(|newest| self.0.remove(newest)).is_some()
    }

    /// Removes offers to undo or redo once the document has changed again.
    pub fn follow(&mut self, document: &Document) {
        self.0.retain_mut(|toast| {
            !toast.is_about_changes() || toast.of.get_or_insert_with(|| document.clone()) == document
        });
    }

    fn add(&mut self, text: String, (is_error, stays): (bool, bool), offers: &[Command]) {
        let (since, offers) = (Instant::now(), offers.to_vec());
        let toast = Toast { text, is_error, since, stays, offers, of: None };
        if let Some(index) = self.0.iter().position(|other| toast.is_like(other) || toast.text == other.text)
        {
            self.0.remove(index);
        }
        self.0.push(toast);
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
        let hidden = self.0.len().saturating_sub(SHOWN);
        let area = egui::Area::new(Id::unique("toasts")).order(egui::Order::Foreground);
        let area = area.pivot(Align2::CENTER_BOTTOM).fixed_pos(over.center_bottom() - vec2(0.0, 16.0));
        let shown = area.constrain_to(over).show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(over.width() - 16.0) - 26.0);
            let frame = theme::float_frame(ui);
            let mut toasts = self.0.iter().enumerate().skip(hidden);
            // One that was closed hides those after it for this frame.
            toasts
                .find(|(_, toast)| frame.show(ui, |ui| toast.ui(ui, commands)).inner)
                .map(|(index, _)| index)
        });
        let closed = shown.inner;
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
                // In line with the cross.
                ui.add_space(2.0);
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

    #[test]
    fn there_is_one_message_of_a_kind_and_the_newest_is_the_last() {
        let mut toasts = Toasts::default();
        let texts = |toasts: &Toasts| toasts.texts().map(str::to_owned).collect::<Vec<_>>();
        for text in ["first", "second", "first"] {
            toasts.good(text);
        }
        assert_eq!(texts(&toasts), ["first"]);
        for text in ["Not opened: a", "Not saved: b", "Not opened: c"] {
            toasts.bad(text);
        }
        assert_eq!(texts(&toasts), ["first", "Not saved: b", "Not opened: c"]);
        toasts.offer("1 %", &[Command::StopSaving]);
        toasts.offer("2 %", &[Command::StopSaving]);
        toasts.good("last");
        assert_eq!(texts(&toasts), ["Not saved: b", "Not opened: c", "2 %", "last"]);
        toasts.end_error("Not saved");
        toasts.withdraw(Command::StopSaving);
        assert_eq!(texts(&toasts), ["Not opened: c", "last"]);
        assert!(toasts.close_newest() && !toasts.close_newest(), "errors and offers");
        assert_eq!(texts(&toasts), ["last"]);
        toasts.bad("Not opened: a");
        toasts.bad("Film not kept: b");
        toasts.end_refusals();
        assert_eq!(texts(&toasts), ["last", "Film not kept: b"]);
    }
}
