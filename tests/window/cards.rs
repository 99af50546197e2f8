//! Cards: those in a corner of the picture, and those of the slots.

use crate::common::{drag_from, has_samples, open, open_sized, send, until};
use eframe::egui::{Rect, Role, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};

/// The lower edge of a text that is drawn over the picture, and the right one.
fn corner_of(harness: &Harness<'_, Window>, begin: &str) -> [f32; 2] {
    let mut texts = harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Text(text) if text.galley.text().starts_with(begin) => {
            Some([text.pos.y + text.galley.size().y, text.pos.x + text.galley.size().x])
        }
        _ => None,
    });
    texts.next().unwrap_or_else(|| panic!("no {begin}"))
}

/// The heading of the card with the first steps.
fn heading(harness: &Harness<'_, Window>) -> Rect {
    let mut named = harness.get_all_by_label("First steps");
    named.find(|node| node.accesskit_node().role() == Role::Label).unwrap().rect()
}

#[test]
fn the_first_steps_cover_no_title_of_a_wipe() {
    let mut harness = open_sized("", [1280.0, 800.0]);
    harness.state_mut().document_mut().give_size([64, 36]);
    harness.run_steps(3);
    until(&mut harness, "a picture", has_samples(1));
    let before = heading(&harness);
    send(&mut harness, Command::Wipe);
    until(&mut harness, "two pictures", Window::has_other_picture);
    // The noise decides where it is placed, and when.
    until(&mut harness, "the divider in its place", |window| window.divider() != 0.5);
    let rect = harness.state().picture_rect();
    let [from, to] = [harness.state().divider(), 0.5].map(|share| rect.lerp_inside(vec2(share, 0.9)));
    drag_from(&mut harness, from, to - from);
    harness.run_steps(3);
    let title = harness.state().document().title();
    let [bottom, right] = corner_of(&harness, &title);
    let card = heading(&harness);
    assert!(right > card.left() - 16.0, "the title reaches under the place of the card: {right} {card}");
    assert!(bottom < card.top() - 12.0, "{bottom} {card}");
    send(&mut harness, Command::Wipe);
    harness.run_steps(3);
    assert_eq!(heading(&harness), before);
}

/// Assistive technology names the control that it saw, which must be the same one in the next frame.
#[test]
fn a_click_reaches_its_slot_although_another_one_goes() {
    let mut harness = open("--stage glass-schlick --size 32x18 --samples 4");
    until(&mut harness, "the end", |window| has_samples(4)(window) && window.status().phase.is_over());
    for number in &SlotNumber::ALL[..3] {
        send(&mut harness, Command::Slot(SlotCommand::KeepIn(*number)));
        until(&mut harness, "a kept picture", |window| window.slot(*number).is_some());
    }
    send(&mut harness, Command::Slot(SlotCommand::Look(SlotNumber::ALL[0])));
    harness.run_steps(3);
    harness.get_by_label("More about slot 3").click_accesskit();
    harness.state_mut().send(Command::Slot(SlotCommand::Delete));
    harness.run_steps(5);
    assert!(harness.state().slot(SlotNumber::ALL[0]).is_none());
    assert!(harness.query_by_label_contains("Go on from the slot").is_some());
}

#[test]
fn a_button_of_a_slot_gives_the_picture_the_slots_size() {
    let mut harness = open("--stage glass-schlick --size 32x18 --samples 4");
    until(&mut harness, "the end", |window| has_samples(4)(window) && window.status().phase.is_over());
    let one = SlotNumber::ALL[0];
    send(&mut harness, Command::Slot(SlotCommand::KeepIn(one)));
    until(&mut harness, "a kept picture", |window| window.slot(one).is_some());
    harness.state_mut().document_mut().give_size([40, 18]);
    harness.run_steps(3);
    harness.get_by_label("Set the picture to the size of slot 1").click_accesskit();
    harness.run_steps(3);
    assert_eq!(harness.state().document().size(), [32, 18]);
}
