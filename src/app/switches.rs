//! Which settings are on.

use super::command::{Command, SlotCommand};
use super::facts::Facts;
use super::model::Model;
use super::model::show::Show;
use super::model::view::{Mode, With};

impl Facts {
    /// Whether the command's setting is active now.
    pub fn is_on(&self, command: Command) -> bool {
        let Model { view, remembered, document, .. } = &self.model;
        match command {
            Command::Show(show) => view.show() == show && (show != Show::Picture || view.mode().is_none()),
            Command::Wipe => view.mode() == Some(Mode::Wipe) && view.with() == With::Stage,
            Command::BookArithmetic => view.mode().is_some() && view.with() == With::Book,
            Command::WipeDifference => {
                view.mode() == Some(Mode::Difference) && view.compared_slot().is_none()
            }
            Command::Slot(SlotCommand::Wipe) => {
                view.mode() == Some(Mode::Wipe) && view.compared_slot().is_some()
            }
            Command::Slot(SlotCommand::Difference) => {
                view.mode() == Some(Mode::Difference) && view.compared_slot().is_some()
            }
            Command::Slot(SlotCommand::Look(number)) => view.slots.looked() == Some(number),
            Command::Slot(SlotCommand::LookLive) => view.slots.is_used() && view.slots.looked().is_none(),
            Command::Crop => view.crop.is_some(),
            Command::Panels => remembered.has_panels,
            Command::Controls => remembered.has_controls,
            Command::Info => remembered.has_info,
            Command::Plot => remembered.has_plot,
            Command::Packet => remembered.has_packet,
            Command::Code => remembered.has_code,
            Command::Gizmo => remembered.has_gizmo,
            Command::Flights => remembered.has_flights,
            Command::FirstSteps => self.model.has_first_steps,
            Command::FullScreen => self.model.is_full_screen,
            Command::Present => self.model.presentation.is_some(),
            Command::ShowMe => self.has_sight,
            Command::Theme(theme) => remembered.theme == theme,
            Command::Device(device) => remembered.device == device,
            Command::Size(sizing) => !document.has_own_size && remembered.sizing == sizing,
            Command::Extreme(case) => document.case() == Some(case),
            _ => false,
        }
    }

    /// Whether the command's setting is on, if the command turns a setting on and off.
    pub fn switch(&self, command: Command) -> Option<bool> {
        let is_switch = matches!(
            command,
            Command::Wipe
                | Command::WipeDifference
                | Command::BookArithmetic
                | Command::Slot(SlotCommand::Wipe | SlotCommand::Difference)
                | Command::Crop
                | Command::Panels
                | Command::Controls
                | Command::Info
                | Command::Plot
                | Command::Packet
                | Command::Code
                | Command::Gizmo
                | Command::Flights
                | Command::FirstSteps
                | Command::FullScreen
                | Command::Present
                | Command::ShowMe
        );
        is_switch.then(|| self.is_on(command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::device::Device;
    use crate::app::model::document::Document;
    use crate::app::model::kept::Kept;
    use crate::app::model::origin::Origin;
    use crate::app::model::presentation::Presentation;
    use crate::app::model::remembered::Theme;
    use crate::app::model::sizing::Sizing;
    use crate::app::model::slots::{Slot, SlotNumber};
    use crate::app::tests::{Case, Drawings, facts_of};
    use crate::film::Film;
    use crate::measure::stress::shown_cases;
    use std::sync::Arc;

    #[test]
    fn a_switch_is_on_while_what_it_shows_is_shown() {
        let mut facts = facts_of("--stage glass-schlick --size 32x18");
        let is_on = |facts: &Facts| -> Vec<String> {
            let all = Command::all().into_iter();
            all.filter(|command| facts.is_on(*command)).map(|command| format!("{command:?}")).collect()
        };
        let mut drawings = Drawings::default();
        let changes: [Case<Facts>; 9] = [
            ("at first", |_| {}),
            ("a wipe", |facts| facts.model.view.toggle(Mode::Wipe, With::Stage)),
            ("a wipe against the book", |facts| facts.model.view.toggle(Mode::Wipe, With::Book)),
            ("a difference", |facts| facts.model.view.toggle(Mode::Difference, With::Stage)),
            ("a wipe against a slot", |facts| {
                facts.model.view.toggle(Mode::Wipe, With::Slot(SlotNumber::ALL[1]));
            }),
            ("a difference from a slot", |facts| {
                facts.model.view.toggle(Mode::Difference, With::Slot(SlotNumber::ALL[1]));
            }),
            ("another view", |facts| facts.model.view.choose(Show::Error)),
            ("a crop, all panels and a sight", |facts| {
                facts.model.view.crop = Some(None);
                let remembered = &mut facts.model.remembered;
                (remembered.has_plot, remembered.has_packet, remembered.has_code) = (true, true, true);
                (facts.has_sight, facts.model.has_first_steps) = (true, true);
                facts.model.is_full_screen = true;
                facts.model.presentation =
                    Some(Presentation { was_full_screen: false, has_captions: true, is_blank: false });
            }),
            ("hardly anything", |facts| {
                let remembered = &mut facts.model.remembered;
                (remembered.has_panels, remembered.has_controls, remembered.has_info) = (false, false, false);
                (remembered.has_gizmo, remembered.has_flights) = (false, false);
                (remembered.theme, remembered.sizing) = (Theme::Light, Sizing::Book);
                facts.model.document.has_own_size = false;
            }),
        ];
        for (name, change) in changes {
            change(&mut facts);
            drawings.tell(&format!("{name}: {}", is_on(&facts).join(", ")));
        }
        drawings.keep("switches");
    }

    #[test]
    fn slots_that_are_shown_are_on() {
        let mut facts = facts_of("--stage glass-schlick --size 32x18");
        let looks = |facts: &Facts| -> Vec<Option<SlotNumber>> {
            let numbers = SlotNumber::ALL.map(SlotCommand::Look).into_iter();
            let is_on = |command: &SlotCommand| facts.is_on(Command::Slot(*command));
            let looks = numbers.chain([SlotCommand::LookLive]).filter(is_on);
            looks
                .map(|command| match command {
                    SlotCommand::Look(number) => Some(number),
                    _ => None,
                })
                .collect()
        };
        assert!(looks(&facts).is_empty(), "there is nothing to choose from");
        for number in [SlotNumber::ALL[0], SlotNumber::ALL[4]] {
            let document = facts.model.document.clone();
            let mut film = Film::new(32, 18, 2);
            film.record(0..2, 0).unwrap();
            let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
            facts.model.view.slots.put(number, Slot { name: String::new(), kept });
        }
        for at in [None, Some(SlotNumber::ALL[4]), Some(SlotNumber::ALL[0]), None] {
            facts.model.view.look(at);
            assert_eq!(looks(&facts), [at]);
        }
    }

    #[test]
    fn devices_sizes_and_extreme_scenes_are_on_while_they_are_chosen() {
        let mut facts = facts_of("--stage glass-schlick");
        for device in Device::ALL {
            facts.model.remembered.device = device;
            let are_on = Device::ALL.map(|other| facts.is_on(Command::Device(other)));
            assert_eq!(are_on, Device::ALL.map(|other| other == device));
        }
        let sizes = |facts: &Facts| Sizing::ALL.map(|sizing| facts.is_on(Command::Size(sizing)));
        assert_eq!(sizes(&facts), [true, false]);
        facts.model.remembered.sizing = Sizing::Book;
        assert_eq!(sizes(&facts), [false, true]);
        facts.model.document.give_size([32, 18]);
        assert_eq!(sizes(&facts), [false, false]);
        let [first, second] = [0, 1].map(|place| &shown_cases()[place]);
        let extremes = |facts: &Facts| [first, second].map(|case| facts.is_on(Command::Extreme(case)));
        assert_eq!(extremes(&facts), [false, false]);
        facts.model.document = Document::new(Origin::of_case(second));
        assert_eq!(extremes(&facts), [false, true]);
    }
}
