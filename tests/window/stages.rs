//! The walk through the book.

use crate::harness::{middle, open, send};
use crate::questions::Ask as _;
use eframe::egui::{Event, Key};
use weekender::app::Command;
use weekender::progressive::Stop;
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

/// Also nothing is known about a pixel of another picture.
#[test]
fn the_samples_of_a_picture_are_there_when_one_comes_back() {
    let mut harness = open("--stage metal --size 32x18 --device cpu");
    let usual = harness.state().shown_document().stop;
    let at = middle(&harness);
    harness.hover_at(at);
    harness.run_steps(2);
    assert!(harness.state().disabled_reason(Command::ListPaths).is_none());
    harness.event(Event::PointerGone);
    harness.state_mut().document_mut().stop = Stop::at_samples(77);
    harness.run_steps(2);
    send(&mut harness, Command::NextStage);
    assert_eq!(harness.state().shown_document().stop, usual);
    assert!(harness.state().disabled_reason(Command::ListPaths).is_some());
    send(&mut harness, Command::PreviousStage);
    assert_eq!(harness.state().shown_document().stop, Stop::at_samples(77));
}
