//! The parts of the window that the keyboard goes through.

use super::model::Model;
use eframe::egui::{self, Context, FocusDirection, Id, Rect, Sense, Ui};

/// A part of the window with controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    FirstSteps,
    Bar,
    Controls,
    /// The right panel.
    Info,
    Dock,
}

impl Place {
    const ALL: [Place; 5] = [Place::FirstSteps, Place::Bar, Place::Controls, Place::Info, Place::Dock];

    fn is_shown(self, model: &Model) -> bool {
        let remembered = &model.remembered;
        model.has_panels()
            && match self {
                Place::FirstSteps => model.has_first_steps,
                Place::Bar => true,
                Place::Controls => remembered.has_controls,
                Place::Info => remembered.has_info,
                Place::Dock => remembered.dock.is_some(),
            }
    }

    fn id(self) -> Id {
        Id::unique(("place", self))
    }

    /// Marks where this part begins: what is drawn next is its first control.
    pub fn begin(self, ui: &Ui) {
        let corner = Rect::from_min_size(ui.max_rect().min, egui::Vec2::ZERO);
        let _ = ui.interact(corner, self.id(), Sense::focusable_noninteractive());
    }
}

/// Gives the keyboard focus to the first control of the part after `last`; after the last one, to the picture. Returns
/// that part.
pub fn next(context: &Context, last: Option<Place>, model: &Model) -> Option<Place> {
    // Escape leaves the panels.
    let last = last.filter(|_| context.memory(|memory| memory.focused().is_some()));
    let after =
        last.map_or(0, |last| Place::ALL.iter().position(|place| *place == last).map_or(0, |at| at + 1));
    let place = Place::ALL.into_iter().skip(after).find(|place| place.is_shown(model));
    context.memory_mut(|memory| match place {
        Some(place) => {
            memory.request_focus(place.id());
            memory.move_focus(FocusDirection::Next);
        }
        None => {
            if let Some(focused) = memory.focused() {
                memory.surrender_focus(focused);
            }
        }
    });
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::tests::{facts_of, part};

    /// The places that the keyboard goes through, from the first one to the picture.
    fn all(model: &Model) -> Vec<Place> {
        let mut seen = Vec::new();
        let mut last = None;
        let _ = part([200.0, 100.0], |ui| {
            if !seen.is_empty() {
                return;
            }
            loop {
                // What has the focus now is within that place.
                ui.memory_mut(|memory| memory.request_focus(Id::unique("a control")));
                last = next(ui.ctx(), last, model);
                match last {
                    Some(place) => seen.push(place),
                    None => break,
                }
            }
            assert!(ui.memory(|memory| memory.focused().is_none()), "the picture has no focus");
        });
        seen
    }

    #[test]
    fn the_keyboard_goes_through_what_is_shown() {
        let mut model = facts_of("--stage metal --size 32x18").model;
        let usual = [Place::Menu, Place::Controls, Place::Info];
        assert_eq!(all(&model), usual);
        let remembered = &mut model.remembered;
        (remembered.has_plot, remembered.has_code, remembered.has_packet) = (true, true, true);
        let with_more = [Place::Menu, Place::Controls, Place::Info, Place::Plot, Place::Code, Place::Packet];
        assert_eq!(all(&model), with_more);
        model.has_first_steps = true;
        assert_eq!(all(&model)[..2], [Place::FirstSteps, Place::Menu]);
        model.has_recovered = true;
        assert_eq!(all(&model)[..2], [Place::Recovered, Place::Menu]);
        (model.has_first_steps, model.has_recovered) = (false, false);
        model.remembered.has_controls = false;
        model.remembered.has_info = false;
        assert_eq!(all(&model), [Place::Menu, Place::Plot, Place::Code, Place::Packet]);
        model.remembered.has_panels = false;
        model.has_recovered = true;
        assert_eq!(all(&model), [Place::Recovered]);
    }
}
