//! The walk through the book.

use crate::harness::{open, send};
use crate::questions::Ask as _;
use eframe::egui::Key;
use weekender::app::Command;
use weekender::stages::Stage;

#[test]
fn page_down_walks_through_the_book() {
    let first = &Stage::ALL[0];
    let mut harness = open(&format!("--stage {} --size 32x18", first.id));
    let mut seen = vec![first.id];
    while harness.state().disabled_reason(Command::NextStage).is_none() {
        harness.key_press(Key::PageDown);
        harness.run_steps(2);
        seen.push(harness.state().shown_document().stage().unwrap().id);
        assert!(seen.len() < 40, "{seen:?}");
    }
    assert_eq!(seen, Stage::walk().map(|stage| stage.id).collect::<Vec<_>>());
    // The scene for measuring is not one of them, but its neighbours are.
    send(&mut harness, Command::Stage(Stage::find("three-spheres").unwrap()));
    harness.key_press(Key::PageUp);
    harness.run_steps(2);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "hollow-glass");
}
