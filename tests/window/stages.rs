//! Every stage of the book.

use crate::common::{has_samples, open, send, until};
use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use weekender::app::Command;
use weekender::stages::Stage;

#[test]
fn every_stage_is_shown_with_its_text() {
    let mut harness = open("--stage ppm-tiny");
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        until(&mut harness, stage.id, |window| {
            window.document().stage() == Some(stage) && has_samples(1)(window)
        });
        assert!(harness.query_by_label(stage.what_is_new).is_some(), "{}", stage.id);
        assert!(harness.query_by_label(stage.look_for).is_some(), "{}", stage.id);
    }
    harness.key_press(Key::PageUp);
    harness.run_steps(2);
    assert_eq!(harness.state().document().stage(), Stage::ALL.iter().rev().nth(1));
}

#[test]
fn every_stage_is_compared_with_another() {
    let mut harness = open("--stage sky --size 32x18");
    harness.key_press(Key::C);
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        harness.state_mut().document_mut().give_size([32, 18]);
        until(&mut harness, stage.id, |window| window.has_other_picture());
        assert!(harness.state().is_comparing());
    }
    harness.key_press(Key::X);
    harness.run_steps(5);
    harness.key_press(Key::X);
    harness.run_steps(2);
    assert!(!harness.state().is_comparing());
}
