//! Carries out the commands for slots.

use super::command::SlotCommand;
use super::kept::Subject;
use super::model::slots::{BYTES_LIMIT, Slot, SlotNumber};
use super::model::view::{Mode, With};
use super::slots::{Copied, Reopened};
use super::window::Window;
use super::wording::lower_first;
use crate::film::Film;
use crate::progressive::describe::counted;
use crate::system::memory::words;
use eframe::egui;

impl Window {
    /// Carries out a command for slots, which is enabled.
    pub(super) fn perform_on_slots(&mut self, context: &egui::Context, command: SlotCommand) {
        let view = &mut self.model.view;
        let chosen = view.slots.chosen();
        match (command, chosen) {
            (SlotCommand::Keep, _) => {
                let number = view.slots.free().find(|number| !self.slot_actions.is_wanted(*number));
                if let Some(number) = number {
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
            self.toasts.good(format!("No difference: {}", lower_first(&reason)));
            self.model.view.end_comparison();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::kept::Kept;

    use crate::app::tests::{until, window};
    use crate::film::PixelSum;
    use std::sync::Arc;

    /// A window with a finished picture of 4 samples per pixel.
    fn finished(context: &egui::Context) -> Window {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let is_over =
            |window: &Window| window.main.has_samples(window.document()) && window.status().phase.is_over();
        until(&mut window, context, "the end", is_over);
        assert_eq!(window.status().samples_per_pixel, 4);
        window
    }

    /// A film of 16x9 pixels with so many samples.
    fn film(samples: u64) -> Film {
        let mut film = Film::new(16, 9, 2);
        for (half, value) in film.halves_mut().iter_mut().zip([3, 4]) {
            half.iter_mut().for_each(|sum| *sum = PixelSum([(samples * (samples + value)) << 20; 3]));
        }
        film.record(0..samples, 0).unwrap();
        film
    }

    #[test]
    fn the_picture_on_the_screen_is_compared_and_the_live_one_if_its_slot_is_shown() {
        let context = egui::Context::default();
        let mut window = finished(&context);
        let [one, two, ..] = SlotNumber::ALL;
        for (number, name, samples) in [(one, "first", 5), (two, "second", 6)] {
            let kept = Kept::new(window.document().clone(), film(samples), Arc::default(), None);
            window.model.view.slots.put(number, Slot { name: name.to_owned(), kept: Arc::new(kept) });
        }
        let live = ("the live picture: ", ", 16x9, 4 samples,");
        let first = ("slot 1: first: ", ", 16x9, 5 samples,");
        let second = ("slot 2: second: ", ", 16x9, 6 samples,");
        for (looked, chosen, expected) in [
            (None, one, [first, live]),
            (Some(one), one, [first, live]),
            (Some(two), two, [second, live]),
            (Some(one), two, [second, first]),
            (Some(two), one, [first, second]),
        ] {
            window.model.view.look(looked);
            window.model.view.slots.choose(chosen);
            window.perform_on_slots(&context, SlotCommand::OnlyNoise);
            until(&mut window, &context, "a finding", |window| window.only_noise().is_some());
            let (headline, text) = window.only_noise().unwrap().unwrap();
            assert_ne!(headline, "Identical to the bit", "{looked:?} {chosen}");
            for (line, (name, samples)) in text.lines().zip(expected) {
                assert!(line.contains(name) && line.contains(samples), "{looked:?} {chosen}: {line}");
            }
        }
    }

    #[test]
    fn a_slot_goes_on_unless_the_live_picture_has_all_of_it() {
        let context = egui::Context::default();
        let mut window = finished(&context);
        let kept = Kept::new(window.document().clone(), film(5), Arc::default(), None);
        let one = SlotNumber::ALL[0];
        window.model.view.slots.put(one, Slot { name: String::new(), kept: Arc::new(kept) });
        let same = window.document().clone();
        let mut other = same.clone();
        other.settings.seed += 1;
        for (document, samples, goes_on) in [(&same, 4, false), (&same, 5, true), (&other, 1, true)] {
            window.model.view.look(Some(one));
            let (document, film) = (document.clone(), film(samples));
            window.go_on_from(Reopened { document: document.clone(), film, seconds: Some(7.0) });
            assert_eq!(window.looked(), None);
            let taken = window.pending_film.take().map(|film| film.sample_count());
            assert_eq!(taken, goes_on.then_some(samples));
            assert_eq!(window.seconds_before == Some(7.0), goes_on, "{samples}");
            assert!(*window.document() == document);
            window.seconds_before = Some(0.0);
        }
    }
}
