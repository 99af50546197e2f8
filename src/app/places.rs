//! The parts of the window that the keyboard goes through.

use super::model::Model;
use eframe::egui::{self, Context, FocusDirection, Id, Rect, Sense, Ui};

/// A part of the window with controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    /// The card with what other windows left.
    Recovered,
    /// The card with the first steps.
    FirstSteps,
    /// The top bar.
    Menu,
    /// The left panel.
    Controls,
    /// The right panel.
    Info,
    /// The error plot.
    Plot,
    /// The code of the stage.
    Code,
    /// The lanes of a packet.
    Packet,
    /// The strip of slots.
    Slots,
}

impl Place {
    const ALL: [Place; 9] = [
        Place::Recovered,
        Place::FirstSteps,
        Place::Menu,
        Place::Controls,
        Place::Info,
        Place::Plot,
        Place::Code,
        Place::Packet,
        Place::Slots,
    ];

    fn is_shown(self, model: &Model) -> bool {
        let remembered = &model.remembered;
        self == Place::Recovered && model.has_recovered
            || self == Place::FirstSteps && model.has_first_steps && !model.has_recovered
            || model.has_panels()
                && match self {
                    Place::Recovered | Place::FirstSteps => false,
                    Place::Menu => true,
                    Place::Controls => remembered.has_controls,
                    Place::Info => remembered.has_info,
                    Place::Plot => remembered.has_plot,
                    Place::Code => remembered.has_code,
                    Place::Packet => remembered.has_packet,
                    Place::Slots => model.view.slots.is_listed(),
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
