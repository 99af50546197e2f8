//! A picture whose camera stays: one that was kept, or one of which a part is being marked.

use super::moving::DOLLY_PER_POINT;
use super::placement::Placement;
use crate::app::command::{Command, SlotCommand};
use crate::app::facts::Facts;
use crate::app::menu;
use eframe::egui::{CursorIcon, PointerButton, Response, Ui};

/// Handles drags and the wheel, which move and zoom the picture. `is_primary_free` says that the primary button has no
/// other use.
pub(super) fn handle(ui: &Ui, response: &Response, placement: &mut Placement, is_primary_free: bool) {
    let (modifiers, scroll, zoom) =
        ui.input(|input| (input.modifiers, input.smooth_scroll_delta().y, input.zoom_delta()));
    let is_primary = response.dragged_by(PointerButton::Primary) && (is_primary_free || modifiers.shift);
    if is_primary || response.dragged_by(PointerButton::Middle) {
        placement.pan_by(response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    }
    if let Some(pointer) = response.hover_pos() {
        let factor = zoom * (scroll * DOLLY_PER_POINT as f32).exp();
        if factor != 1.0 {
            placement.zoom_at(pointer, factor);
        }
    }
}

/// The entries of the menu of a right click. Returns false if the picture is the live one, which has others.
pub(super) fn menu(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) -> bool {
    let view = &facts.model.view;
    let listed: &[Command] = match (view.crop, view.slots.looked()) {
        (Some(_), _) => &[Command::CopyCrop, Command::SaveCrop, Command::Crop],
        (None, Some(_)) => &[
            Command::Slot(SlotCommand::LookLive),
            Command::Slot(SlotCommand::Swap),
            Command::Slot(SlotCommand::Open),
            Command::Slot(SlotCommand::Delete),
            Command::CopyPicture,
            Command::Crop,
            Command::CopyCommand,
        ],
        (None, None) => return false,
    };
    for command in listed {
        menu::item(ui, facts, commands, *command);
    }
    true
}
