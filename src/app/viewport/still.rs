//! A picture whose camera stays, because it was kept.

use super::moving::DOLLY_PER_POINT;
use super::placement::Placement;
use crate::app::command::Command;
use crate::app::facts::Facts;
use crate::app::menu;
use eframe::egui::{CursorIcon, PointerButton, Response, Ui};

/// Handles drags and the wheel, which move and zoom the picture.
pub(super) fn handle(ui: &Ui, response: &Response, placement: &mut Placement) {
    let (scroll, zoom) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let is_primary = response.dragged_by(PointerButton::Primary);
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
    if facts.model.view.kept.looked().is_none() {
        return false;
    }
    for command in [
        Command::LookLive,
        Command::KeptWipe,
        Command::KeptDifference,
        Command::OnlyNoise,
        Command::GoOnFromKept,
        Command::Save,
        Command::DeleteKept,
    ] {
        menu::item(ui, facts, commands, command);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::dressed;
    use eframe::egui::{
        Event, Modifiers, MouseWheelSource, MouseWheelUnit, Rect, Sense, TouchPhase, pos2, vec2,
    };
    use egui_kittest::Harness;

    const ROOM: Rect = Rect { min: pos2(10.0, 10.0), max: pos2(330.0, 190.0) };

    /// A picture of 16x9 pixels that stays. Where its camera would move, the picture does.
    fn picture() -> Harness<'static, Placement> {
        let draw = move |ui: &mut Ui, placement: &mut Placement| {
            let response = ui.allocate_rect(ROOM, Sense::click_and_drag());
            placement.place(ROOM, vec2(16.0, 9.0), 1.0);
            handle(ui, &response, placement);
        };
        dressed([340.0, 200.0]).build_ui_state(draw, Placement::default())
    }

    #[test]
    fn the_wheel_and_a_pinch_zoom_at_the_pointer() {
        let (unit, phase, source) = (MouseWheelUnit::Point, TouchPhase::Move, MouseWheelSource::Wheel);
        let wheel = |down: f32| {
            let (delta, modifiers) = (vec2(0.0, down), Modifiers::NONE);
            Event::MouseWheel { unit, delta, phase, source, modifiers }
        };
        for (event, factor) in
            [(wheel(5.0), f32::exp(0.01)), (wheel(-5.0), f32::exp(-0.01)), (Event::Zoom(2.0), 2.0)]
        {
            let mut harness = picture();
            harness.event(Event::PointerMoved(ROOM.left_top() + vec2(80.0, 45.0)));
            harness.event(event);
            harness.run_steps(2);
            let rect = harness.state().rect();
            assert!((rect.width() / 320.0 - factor).abs() < 1e-4, "{factor}: {rect}");
            // A quarter of the picture is left of the pointer, as before; its corner is at a whole pixel.
            assert!((90.0 - rect.left() - 0.25 * rect.width()).abs() < 1.0, "{factor}: {rect}");
        }
        let mut harness = picture();
        harness.event(Event::Zoom(2.0));
        harness.run_steps(2);
        assert_eq!(harness.state().rect(), ROOM, "the pointer is elsewhere");
    }
}
