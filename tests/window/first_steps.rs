//! The card that a new user sees.

use crate::common::{drag_from, hold, middle, open, opened, window};
use eframe::egui::{Key, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};

const CLOSE: &str = "Close first steps";

/// The first window of a new user, with a small picture.
fn first() -> Harness<'static, Window> {
    let mut first = window("");
    first.document_mut().give_size([64, 36]);
    opened(first)
}

fn has_card(harness: &Harness<'_, Window>) -> bool {
    harness.query_by_label(CLOSE).is_some()
}

fn ticks(harness: &Harness<'_, Window>) -> usize {
    harness.query_all_by_label_contains("Done: ").count()
}

#[test]
fn who_asks_for_a_picture_sees_it_without_a_card() {
    for arguments in ["--stage metal", "--scene book", "--size 32x18", "--vfov 30"] {
        assert!(!has_card(&open(arguments)), "{arguments}");
    }
    assert!(has_card(&open("--device cpu --threads 1")), "these say nothing about the picture");
}

#[test]
fn the_card_is_below_the_picture_and_ticks_what_was_done() {
    let mut harness = first();
    harness.run_steps(3);
    assert!(harness.get_by_label(CLOSE).rect().top() > harness.state().picture_rect().bottom());
    let at = middle(&harness);
    hold(&mut harness, at, true);
    hold(&mut harness, at, false);
    harness.run_steps(3);
    assert_eq!(ticks(&harness), 0, "a selected sphere has not changed yet");
    drag_from(&mut harness, at, vec2(20.0, 0.0));
    harness.run_steps(3);
    assert_eq!(ticks(&harness), 1);
    let sky = harness.state().picture_rect().left_top() + vec2(20.0, 10.0);
    drag_from(&mut harness, sky, vec2(40.0, 0.0));
    harness.key_press(Key::PageUp);
    harness.run_steps(3);
    assert_eq!(ticks(&harness), 3);
    assert!(has_card(&harness), "it stays until it is closed");
    harness.get_by_label("Start the book at 2.1").click();
    harness.run_steps(3);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "ppm-tiny");
    harness.get_by_label(CLOSE).click();
    harness.run_steps(3);
    assert!(!has_card(&harness) && harness.state_mut().remembered_mut().first_steps.is_over);
    harness.state_mut().send(Command::FirstSteps);
    harness.run_steps(3);
    assert!(has_card(&harness));
}
