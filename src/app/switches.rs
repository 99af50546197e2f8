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
