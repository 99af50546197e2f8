//! What the window tells while a slot is shown.

use crate::common::{send, until};
use crate::slots::{finished, is_done, keep};
use eframe::egui::vec2;
use weekender::app::{Command, SlotCommand, SlotNumber};

const ONE: SlotNumber = SlotNumber::ALL[0];

#[test]
fn the_pixel_under_the_pointer_is_one_of_the_slot() {
    let mut harness = finished(4);
    keep(&mut harness, Command::Slot(SlotCommand::Keep), ONE);
    harness.state_mut().document_mut().settings.width = 40;
    harness.run_steps(2);
    until(&mut harness, "the wider picture", is_done);
    // The last column of each: the slot has 32.
    for (command, columns) in [(SlotCommand::Look(ONE), 32), (SlotCommand::LookLive, 40)] {
        send(&mut harness, Command::Slot(command));
        let rect = harness.state().picture_rect();
        let last = [columns - 1, 9];
        harness.hover_at(rect.lerp_inside(vec2(1.0 - 0.5 / columns as f32, 9.5 / 18.0)));
        until(&mut harness, "the pixel", |window| window.inspected().is_some_and(|(at, _)| at == last));
    }
}
