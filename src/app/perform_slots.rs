//! Carries out the commands for slots.

use super::command::SlotCommand;
use super::kept::Subject;
use super::model::slots::{BYTES_LIMIT, Slot, SlotNumber};
use super::model::view::{Mode, With};
use super::slots::{Copied, Reopened};
use super::window::Window;
use super::wording::lower_first;
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
    use crate::app::model::slots::Coming;
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
    fn what_is_kept_goes_to_a_slot_that_awaits_no_picture() {
        let context = egui::Context::default();
        let mut window = finished(&context);
        let [one, two, three, ..] = SlotNumber::ALL;
        let coming = Coming {
            name: "earlier".to_owned(),
            id: "a".to_owned(),
            size: [16, 9],
            samples: 7,
            has_own_size: true,
        };
        window.model.view.slots.expect(one, coming);
        for number in [two, three] {
            window.perform_on_slots(&context, SlotCommand::Keep);
            assert!(window.slot_actions.is_wanted(number) && !window.slot_actions.is_wanted(one), "{number}");
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

    #[test]
    fn commands_for_a_slot_are_for_the_one_that_is_meant_not_the_one_that_is_shown() {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let context = egui::Context::default();
        let [one, two, three, four, ..] = SlotNumber::ALL;
        for (number, name, size) in [(one, "first", [16, 9]), (two, "second", [8, 6])] {
            let (mut document, mut film) = (window.document().clone(), Film::new(size[0], size[1], 2));
            document.give_size(size);
            film.record(0..4, 0).unwrap();
            let kept = Kept::new(document, film, Arc::default(), None);
            window.model.view.slots.put(number, Slot { name: name.to_owned(), kept: Arc::new(kept) });
        }
        window.model.view.look(Some(one));
        window.model.view.slots.choose(two);
        let told = |window: &mut Window, command| {
            window.perform_on_slots(&context, command);
            window.messages().pop().unwrap_or_default()
        };
        let deleted = "Deleted slot 2: second; Slots > Bring back the slot returns it";
        assert_eq!(told(&mut window, SlotCommand::Delete), deleted);
        assert!(window.slot(one).is_some() && window.slot(two).is_none());
        assert_eq!(told(&mut window, SlotCommand::BringBack), "Brought back slot 2: second");
        assert!(window.slot(one).is_some() && window.slot(two).is_some());
        window.perform_on_slots(&context, SlotCommand::Open);
        assert_eq!(window.slot_actions.reopened.wait().unwrap().unwrap().document.size(), [8, 6]);
        window.perform_on_slots(&context, SlotCommand::TakeSize);
        assert_eq!(window.document().size(), [8, 6]);
        window.perform_on_slots(&context, SlotCommand::Wipe);
        assert_eq!((window.model.view.compared_slot(), window.looked()), (Some(two), Some(one)));
        for command in [SlotCommand::Keep, SlotCommand::Keep, SlotCommand::KeepIn(two)] {
            window.perform_on_slots(&context, command);
        }
        assert_eq!(window.slot_actions.take_wanted(), [three, four, two]);
    }

    #[test]
    fn a_picture_that_takes_the_place_of_another_is_told_with_both_names() {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let number = SlotNumber::ALL[1];
        let mut told = |samples| {
            let kept = Kept::new(window.document().clone(), film(samples), Arc::default(), None);
            window.put(Copied { number, kept });
            window.messages().pop().unwrap()
        };
        let (first, second) = (told(5), told(6));
        assert!(first.starts_with("Kept in slot 2: 11.4 ") && first.contains(", 5 samples ("), "{first}");
        assert!(first.ends_with(')'), "it was free: {first}");
        assert!(second.starts_with("Kept in slot 2: 11.4 ") && second.contains(", 6 samples ("), "{second}");
        assert!(second.contains("), in place of 11.4 ") && second.ends_with(", 5 samples"), "{second}");
        assert_eq!(window.slot(number).map(|(_, samples)| samples), Some(6));
    }

    #[test]
    fn what_failed_is_told_in_words() {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --device cpu");
        let context = egui::Context::default();
        window.slot_actions.copied.answer(&context).give(Err("there is no room".to_owned()));
        window.slot_actions.reopened.answer(&context).give(Err("it is too large".to_owned()));
        window.receive_for_slots();
        assert_eq!(window.messages(), ["Not kept: there is no room", "Not opened: it is too large"]);
    }

    #[test]
    fn a_picture_without_samples_is_kept_once_it_has_some() {
        let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
        let (context, one) = (egui::Context::default(), SlotNumber::ALL[0]);
        window.perform_on_slots(&context, SlotCommand::KeepIn(one));
        window.keep_wanted(&context);
        assert!(window.slot_actions.is_wanted(one) && !window.slot_actions.is_copying());
        until(&mut window, &context, "the slot", |window| window.slot(one).is_some());
    }

    #[test]
    fn going_on_from_a_slot_ends_a_comparison_and_is_told() {
        let mut window = finished(&egui::Context::default());
        let [one, two, ..] = SlotNumber::ALL;
        for number in [one, two] {
            let kept = Kept::new(window.document().clone(), film(5), Arc::default(), None);
            window.model.view.slots.put(number, Slot { name: String::new(), kept: Arc::new(kept) });
        }
        window.model.view.look(Some(one));
        window.model.view.toggle(Mode::Wipe, With::Slot(two));
        assert!(window.is_comparing() && window.looked() == Some(one));
        let document = window.document().clone();
        window.go_on_from(Reopened { document, film: film(5), seconds: None });
        assert!(!window.is_comparing() && window.looked().is_none());
        let told = "Going on from 11.4 Windows at a slant with 5 samples per pixel; Undo returns";
        assert_eq!(window.messages().pop().as_deref(), Some(told));
        assert_eq!(window.seconds_before, None, "nobody knows how long they took");
    }
}
