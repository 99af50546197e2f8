//! The card that a new user sees.

use crate::harness::{open, opened, window};
use crate::questions::Ask as _;
use eframe::egui::Key;
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

#[test]
fn requested_picture_is_shown_without_a_card() {
    for arguments in ["--stage metal", "--scene book", "--size 32x18", "--vfov 30"] {
        assert!(!has_card(&open(arguments)), "{arguments}");
    }
    assert!(has_card(&open("--device cpu --threads 1")), "these say nothing about the picture");
}

#[test]
fn the_card_is_below_the_picture_and_stays_until_it_is_closed() {
    let mut harness = first();
    harness.run_steps(3);
    assert!(harness.get_by_label(CLOSE).rect().top() > harness.state().picture_rect().bottom());
    harness.key_press(Key::PageUp);
    harness.run_steps(3);
    assert!(has_card(&harness));
    assert!(harness.query_by_label("3, done").is_some() && harness.query_by_label("2, done").is_none());
    harness.get_by_label("Start the book at 2.1").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Start the book at 2.1").is_none(), "it is open");
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "ppm-tiny");
    harness.get_by_label(CLOSE).click();
    harness.run_steps(3);
    assert!(!has_card(&harness) && harness.state_mut().remembered_mut().is_greeted);
    harness.state_mut().send(Command::FirstSteps);
    harness.run_steps(3);
    assert!(has_card(&harness));
}

#[test]
fn a_new_scene_turns_no_page() {
    let mut harness = first();
    harness.state_mut().send(Command::NewScene);
    harness.run_steps(3);
    assert!(has_card(&harness) && harness.query_by_label("3, done").is_none());
}
