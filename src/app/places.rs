//! The parts of the window that the keyboard goes through.

use super::model::Model;
use eframe::egui::{self, Context, FocusDirection, Id, Rect, Sense, Ui};

/// A part of the window with controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    Bar,
    Controls,
    /// The right panel.
    Info,
    Dock,
    FirstSteps,
}

impl Place {
    const ALL: [Place; 5] = [Place::Bar, Place::Controls, Place::Info, Place::Dock, Place::FirstSteps];

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
    use crate::app::model::Dock;
    use crate::app::tests::facts_of;

    #[test]
    fn the_keyboard_goes_through_what_is_shown() {
        let mut model = facts_of("--stage metal --size 32x18").model;
        let shown =
            |model: &Model| Place::ALL.into_iter().filter(|place| place.is_shown(model)).collect::<Vec<_>>();
        assert_eq!(shown(&model), [Place::Bar, Place::Controls, Place::Info]);
        (model.remembered.dock, model.has_first_steps) = (Some(Dock::Error), true);
        assert_eq!(shown(&model), Place::ALL);
        model.remembered.has_panels = false;
        assert_eq!(shown(&model), []);
    }
}
