//! Every command, by table and key.

use crate::harness::{SMALL, open, send};
use crate::questions::Ask as _;
use eframe::egui::Key;
use egui_kittest::Harness;
use weekender::app::{Command, ROWS, Window};

#[test]
fn every_command_is_carried_out_or_says_why_not() {
    let mut harness = open(SMALL);
    for row in ROWS.iter().filter(|row| row.command != Command::Quit) {
        let before = harness.state().disabled_reason(row.command);
        send(&mut harness, row.command);
        assert_eq!(harness.state().performed(), Some(row.command));
        if let Some(reason) = before.filter(|_| harness.state().disabled_reason(row.command).is_some()) {
            let told = harness.state().messages();
            assert!(told.iter().any(|text| text.ends_with(&reason[1..])), "{:?}: {told:?}", row.command);
        }
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        assert!(!harness.state().has_dialog(), "{:?}", row.command);
    }
}

#[test]
fn every_key_reaches_its_command() {
    let mut harness = open(SMALL);
    for row in ROWS.iter().filter(|row| row.command != Command::Quit) {
        let Some(keys) = row.keys else { continue };
        harness.key_press_modifiers(keys.modifiers, keys.logical_key);
        harness.run_steps(2);
        assert_eq!(harness.state().performed(), Some(row.command), "{keys:?}");
        // A list or dialog takes the first Escape.
        for _ in 0..2 {
            harness.key_press(Key::Escape);
            harness.run_steps(3);
        }
        if harness.state().is_presenting() {
            send(&mut harness, Command::Present);
        }
    }
}

#[test]
fn changes_are_undone_and_redone_one_by_one() {
    let mut harness = open(SMALL);
    let angle = |harness: &Harness<'_, Window>| harness.state().shown_document().camera.vfov_degrees;
    let angles = [angle(&harness), 33.0, 44.0, 55.0];
    for degrees in &angles[1..] {
        harness.run_steps(90);
        harness.state_mut().document_mut().camera.vfov_degrees = *degrees;
        harness.run_steps(2);
    }
    for degrees in angles.iter().rev().skip(1) {
        send(&mut harness, Command::Undo);
        assert_eq!(angle(&harness), *degrees, "undone");
    }
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
    for degrees in &angles[1..] {
        harness.run_steps(90);
        send(&mut harness, Command::Redo);
        assert_eq!(angle(&harness), *degrees, "redone");
    }
    assert!(harness.state().disabled_reason(Command::Redo).is_some());
}
