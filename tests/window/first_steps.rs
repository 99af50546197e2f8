//! The card that a new user sees.

use crate::common::{drag_from, hold, middle, open, opened, until, until_seen, window};
use eframe::egui::{Key, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};

const ABOUT: &str = "Every picture of Ray Tracing in One Weekend, rendered while you watch.";
const STEPS: [&str; 3] = [
    "Drag the picture to look from elsewhere",
    "Click a sphere, then drag it or change its material",
    "Press Page Up for the previous stage, Page Down for the next",
];

/// A control of each group that is folded for a new user.
const FOLDED: [&str; 3] = ["Seed", "Time", "Save PNG"];

/// The first window of a new user, with a small picture.
fn first() -> Harness<'static, Window> {
    let mut first = window("");
    first.document_mut().give_size([64, 36]);
    opened(first)
}

fn has_card(harness: &Harness<'_, Window>) -> bool {
    harness.query_by_label(ABOUT).is_some()
}

/// Which steps are ticked off.
fn ticks(harness: &Harness<'_, Window>) -> [bool; 3] {
    STEPS.map(|step| {
        let has = |text: &str| harness.query_by_label(text).is_some();
        let is_done = has(&format!("Done: {step}"));
        assert!(is_done != has(step), "{step}");
        is_done
    })
}

#[test]
fn who_asks_for_a_picture_sees_it_without_a_card() {
    for arguments in ["--stage metal", "--scene book", "--size 32x18", "--vfov 30"] {
        let harness = open(arguments);
        assert!(!has_card(&harness), "{arguments}");
        for name in FOLDED {
            assert!(harness.query_all_by_label(name).next().is_some(), "{arguments}: {name} is folded");
        }
    }
    assert_eq!(open("--size 32x18").state().document().name(), "three-spheres");
    assert!(has_card(&open("--device cpu --threads 1")), "these say nothing about the picture");
}

#[test]
fn each_step_is_ticked_off_once_it_is_done() {
    let mut harness = first();
    let at = middle(&harness);
    harness.key_press(Key::W);
    harness.run_steps(3);
    assert_eq!(ticks(&harness), [false; 3], "flying is none of the steps");
    hold(&mut harness, at, true);
    hold(&mut harness, at, false);
    harness.run_steps(3);
    assert!(harness.state().selected().is_some());
    assert_eq!(ticks(&harness), [false; 3], "a selected sphere has not changed yet");
    drag_from(&mut harness, at, vec2(20.0, 0.0));
    harness.run_steps(3);
    assert!(harness.state().document().has_changed_scene());
    assert_eq!(ticks(&harness), [false, true, false]);
    let sky = harness.state().picture_rect().left_top() + vec2(20.0, 10.0);
    drag_from(&mut harness, sky, vec2(40.0, 0.0));
    harness.run_steps(3);
    assert_eq!(ticks(&harness), [true, true, false]);
    assert!(!harness.state_mut().remembered_mut().first_steps.is_over);
    harness.key_press(Key::PageUp);
    // It stays for some seconds, which a slow machine may need for a few frames.
    until_seen(&mut harness, "That is all. Help > First steps shows this again.");
    assert!(harness.state_mut().remembered_mut().first_steps.is_over);
    until(&mut harness, "the card goes", |window| window.disabled_reason(Command::FirstSteps).is_none());
    let begin = std::time::Instant::now();
    while has_card(&harness) {
        assert!(begin.elapsed().as_secs() < 60, "the card stays");
        std::thread::sleep(std::time::Duration::from_millis(20));
        harness.step();
    }
}
