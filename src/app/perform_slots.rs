//! Carries out the commands for slots.

use super::command::SlotCommand;
use super::kept::Subject;
use super::model::slots::{BYTES_LIMIT, Slot, SlotNumber};
use super::model::view::{Mode, With};
use super::slots::{Copied, Reopened};
use super::window::Window;
use crate::describe::counted;
use crate::film::Film;
use crate::memory::words;
use eframe::egui;

impl Window {
    /// Carries out a command for slots, which is enabled.
    pub(super) fn perform_on_slots(&mut self, context: &egui::Context, command: SlotCommand) {
        let view = &mut self.model.view;
        let chosen = view.slots.chosen();
        match (command, chosen) {
            (SlotCommand::Keep, _) => {
                let is_free = |number: &SlotNumber| {
                    view.slots.get(*number).is_none() && !self.slot_actions.is_wanted(*number)
                };
                if let Some(number) = SlotNumber::ALL.into_iter().find(is_free) {
                    self.slot_actions.want(number);
                }
            }
            (SlotCommand::KeepIn(number), _) => self.slot_actions.want(number),
            (SlotCommand::Look(number), _) => view.look(Some(number)),
            (SlotCommand::LookLive, _) => view.look(None),
            (SlotCommand::Swap, _) => view.swap(),
            (SlotCommand::Wipe, Some(number)) => view.toggle(Mode::Wipe, With::Slot(number)),
            (SlotCommand::Difference, Some(number)) => view.toggle(Mode::Difference, With::Slot(number)),
            (SlotCommand::OnlyNoise, Some(number)) => self.ask_only_noise(context, number),
            (SlotCommand::TakeSize, Some(number)) => {
                let size = view.slots.get(number).map(|slot| slot.kept.size());
                self.take_size(size);
            }
            (SlotCommand::Open, Some(number)) => {
                if let Some(slot) = view.slots.get(number) {
                    self.slot_actions.reopen(context, &slot.kept);
                }
            }
            (SlotCommand::Delete, Some(number)) => {
                let title = view.slots.title(number);
                view.slots.delete(number);
                self.toasts.good(format!("Deleted {title}; Slots > Bring back the slot returns it"));
            }
            (SlotCommand::BringBack, _) => {
                view.slots.bring_back();
                if let Some(number) = view.slots.chosen() {
                    self.toasts.good(format!("Brought back {}", view.slots.title(number)));
                }
            }
            _ => {}
        }
        // A picture that was not resolved yet comes from another thread.
        context.request_repaint();
    }

    /// Gives the picture this size.
    pub(super) fn take_size(&mut self, size: Option<[u32; 2]>) {
        if let Some(size) = size {
            self.model.document.give_size(size);
        }
    }

    /// The film on the screen.
    pub(super) fn subject(&self) -> Subject<'_> {
        let model = &self.model;
        Subject::new(
            &model.view,
            (&model.document, &self.main),
            self.seconds_before,
            &self.slot_actions.thread,
        )
    }

    /// Has the live picture copied for the slots that wait for it, if it has samples.
    pub(super) fn keep_wanted(&mut self, context: &egui::Context) {
        if !self.main.has_samples(&self.model.document) {
            return;
        }
        for number in self.slot_actions.take_wanted() {
            let settings = &self.model.document.settings;
            let bytes = Film::bytes(settings.width, settings.height, settings.half_count());
            if let Err(reason) = self.model.view.slots.make_room(number, bytes, BYTES_LIMIT) {
                self.toasts.bad(format!("Not kept: {reason}"));
                continue;
            }
            let live = (&self.model.document, &self.main);
            self.slot_actions.copy(context, number, live, self.seconds_before);
        }
    }

    /// Takes the answers about slots.
    pub(super) fn receive_for_slots(&mut self) {
        while let Some(outcome) = self.slot_actions.copied.take() {
            match outcome {
                Ok(copied) => self.put(copied),
                Err(reason) => self.toasts.bad(format!("Not kept: {reason}")),
            }
        }
        while let Some(outcome) = self.slot_actions.reopened.take() {
            match outcome {
                Ok(reopened) => self.go_on_from(reopened),
                Err(reason) => self.toasts.bad(format!("Not opened: {reason}")),
            }
        }
        self.slot_actions.verdict.receive();
    }

    fn put(&mut self, Copied { number, kept }: Copied) {
        let slots = &mut self.model.view.slots;
        let name = format!("{}, {}", kept.document.title(), counted(kept.samples(), "sample"));
        let bytes = words(kept.bytes());
        let replaced = slots.get(number).map(|slot| slot.name.clone());
        slots.put(number, Slot { name: name.clone(), kept: kept.into() });
        let instead = replaced.map_or_else(String::new, |earlier| format!(", in place of {earlier}"));
        self.toasts.good(format!("Kept in slot {number}: {name} ({bytes}){instead}"));
    }

    /// Shows a kept picture as the live one, which goes on with its samples.
    fn go_on_from(&mut self, Reopened { document, film, seconds }: Reopened) {
        let held = self.main.status().samples_per_pixel;
        let is_newer = self.main.is_full(&document) && film.sample_count() <= held;
        let is_same = self.document().has_same_film(&document);
        self.model.view.look(None);
        self.model.view.end_comparison();
        if is_same && is_newer {
            self.toasts.good("The live picture is this one, and it has no fewer samples");
            return;
        }
        let title = document.title();
        self.show_document(document);
        let samples = counted(film.sample_count(), "sample");
        self.pending_film = Some(film);
        self.seconds_before = seconds;
        self.changes.step_to(&self.model.document);
        self.toasts.good(format!("Going on from {title} with {samples} per pixel; Undo returns"));
    }

    /// Asks whether the picture on the screen and a slot differ only by noise. A slot that is shown itself is compared with
    /// the live picture.
    fn ask_only_noise(&mut self, context: &egui::Context, number: SlotNumber) {
        let view = &self.model.view;
        let Some(slot) = view.slots.get(number) else { return };
        let looked = view.slots.looked().filter(|looked| *looked != number);
        let mine = looked.map_or_else(|| "the live picture".to_owned(), |looked| view.slots.title(looked));
        let names = [view.slots.title(number), mine];
        let live = (&self.model.document, &self.main);
        let subject = Subject::new(view, live, self.seconds_before, &self.slot_actions.thread);
        let subject = if looked.is_some() { subject } else { subject.live() };
        self.slot_actions.verdict.ask(context, &slot.kept, &subject, names);
    }

    /// Ends the difference from a slot if it has become impossible, and says why.
    pub(super) fn leave_useless_comparison(&mut self) {
        let view = &self.model.view;
        let compared = view.compared_slot().filter(|_| view.mode() == Some(Mode::Difference));
        if let Some(reason) = compared.and_then(|number| self.facts().slot_of_other_size(number)) {
            self.toasts.good(format!("No difference: {}{}", reason[..1].to_lowercase(), &reason[1..]));
            self.model.view.end_comparison();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::slots::Coming;
    use crate::app::tests::{until, window};

    #[test]
    fn a_picture_that_no_slot_has_room_for_is_not_kept() {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let context = egui::Context::default();
        until(&mut window, &context, "samples", |window| window.main.has_samples(window.document()));
        let [one, two, ..] = SlotNumber::ALL;
        let (name, id, size) = ("large".to_owned(), "1".to_owned(), [20_000, 10_000]);
        window.model.view.slots.expect(one, Coming { name, id, size, samples: 1, has_own_size: true });
        window.perform_on_slots(&context, SlotCommand::KeepIn(two));
        window.keep_wanted(&context);
        let told = window.messages();
        assert!(told.iter().any(|text| text.starts_with("Not kept: the picture takes ")), "{told:?}");
        assert!(!window.slot_actions.is_wanted(two));
    }
}
