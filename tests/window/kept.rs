//! What the window says about kept pictures, and what can be done with each.

use crate::common::{SMALL, control, has_samples, open, painted, send, until};
use eframe::egui::{self, Key, Modifiers, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::output::OutputFormat;
use weekender::progressive::Stop;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];
const THREE: SlotNumber = SlotNumber::ALL[2];

/// A window with a finished picture of four samples.
fn finished() -> Harness<'static, Window> {
    let mut harness = open(&format!("{SMALL} --samples 4"));
    until(&mut harness, "the end", |window| has_samples(4)(window) && window.status().phase.is_over());
    harness
}

fn keep_in(harness: &mut Harness<'_, Window>, number: SlotNumber, samples: u64) {
    send(harness, Command::Slot(SlotCommand::KeepIn(number)));
    until(harness, "a kept picture", |window| window.slot(number).is_some_and(|(_, has)| has == samples));
}

fn is_told(harness: &Harness<'_, Window>, is_it: impl Fn(&str) -> bool) -> bool {
    harness.state().messages().iter().any(|text| is_it(text))
}

#[test]
fn each_of_several_at_once_gets_a_slot() {
    let mut harness = finished();
    for _ in 0..3 {
        harness.state_mut().send(Command::Slot(SlotCommand::Keep));
    }
    harness.step();
    until(&mut harness, "three slots", |window| {
        [ONE, TWO, THREE].iter().all(|at| window.slot(*at).is_some())
    });
    assert!(harness.state().slot(SlotNumber::ALL[3]).is_none());
}

#[test]
fn what_is_replaced_is_named() {
    let mut harness = finished();
    keep_in(&mut harness, TWO, 4);
    let first = harness.state().slot(TWO).unwrap().0.to_owned();
    assert!(first.ends_with(", 4 samples"), "{first}");
    let kept = format!("Kept in slot 2: {first} (");
    assert!(is_told(&harness, |text| text.starts_with(&kept) && !text.contains("in place of")));
    harness.state_mut().document_mut().stop = Stop::at_samples(8);
    until(&mut harness, "more samples", has_samples(8));
    keep_in(&mut harness, TWO, 8);
    let instead = format!(", in place of {first}");
    assert!(
        is_told(&harness, |text| text.contains(", 8 samples (") && text.ends_with(&instead)),
        "{:?}",
        harness.state().messages()
    );
}

#[test]
fn the_live_picture_is_not_replaced_by_itself() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    let run = harness.state().status().run;
    send(&mut harness, Command::Slot(SlotCommand::Open));
    until(&mut harness, "the answer", |window| {
        window.messages().iter().any(|text| text.starts_with("The live picture is this one"))
    });
    harness.run_steps(3);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn the_menu_of_a_slot_saves_the_picture_of_that_slot() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    let name = harness.state().slot(ONE).unwrap().0.to_owned();
    harness.run_steps(3);
    harness.get_by_label("More about slot 1").click();
    harness.run_steps(5);
    harness.get_by_label_contains(&Command::Save(OutputFormat::Png).name()).click();
    harness.run_steps(5);
    assert_eq!(harness.state().looked(), Some(ONE));
    let about = format!("slot 1: {name}: 32x18");
    assert!(
        harness.query_all_by_label_contains(&about).next().is_some(),
        "the box says what is saved: {about}"
    );
}

/// The buttons of the slot that is compared are pressed, and those of no other slot.
#[test]
fn only_the_compared_slot_is_pressed() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    keep_in(&mut harness, TWO, 4);
    let name = |number: SlotNumber| format!("{} {number}", Command::Slot(SlotCommand::Wipe).name());
    let pressed = |harness: &Harness<'_, Window>| {
        [ONE, TWO].map(|number| {
            let toggled = control(harness, &name(number)).accesskit_node().toggled();
            toggled == Some(egui::accesskit::Toggled::True)
        })
    };
    assert_eq!(pressed(&harness), [false, false]);
    control(&harness, &name(ONE)).click();
    harness.run_steps(3);
    assert!(harness.state().is_comparing());
    assert_eq!(pressed(&harness), [true, false]);
}

#[test]
fn a_kept_picture_is_at_the_left_of_a_wipe() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    send(&mut harness, Command::Slot(SlotCommand::Wipe));
    until(&mut harness, "a wipe", |window| window.has_other_picture());
    harness.run_steps(3);
    assert!(painted(&harness, "live: "));
    let left = |title: &str| {
        let mut texts = harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
            Shape::Text(text) if text.galley.text().starts_with(title) => Some(text.pos.x),
            _ => None,
        });
        texts.next().unwrap_or_else(|| panic!("no {title}"))
    };
    assert!(left("slot 1: ") < left("live: "));
}

#[test]
fn one_key_flips_to_a_slot_that_is_still_there() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    keep_in(&mut harness, TWO, 4);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    send(&mut harness, Command::Slot(SlotCommand::LookLive));
    send(&mut harness, Command::Slot(SlotCommand::Delete));
    assert!(harness.state().slot(ONE).is_none());
    harness.key_press(Key::J);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), Some(TWO));
}

#[test]
fn ctrl_and_the_wheel_zoom_into_a_kept_picture() {
    let mut harness = finished();
    keep_in(&mut harness, ONE, 4);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    let camera = harness.state().document().camera;
    let before = harness.state().picture_rect();
    harness.event(egui::Event::PointerMoved(before.lerp_inside(vec2(0.3, 0.3))));
    harness.step();
    for modifiers in [Modifiers::COMMAND, Modifiers::NONE] {
        let rect = harness.state().picture_rect();
        let event = egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, 2.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers,
        };
        harness.event_modifiers(event, modifiers);
        harness.run_steps(20);
        let zoomed = harness.state().picture_rect();
        assert!(zoomed.width() > 1.05 * rect.width(), "{modifiers:?}: {rect} {zoomed}");
    }
    assert_eq!((harness.state().document().camera, harness.state().looked()), (camera, Some(ONE)));
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().looked(), None);
}
