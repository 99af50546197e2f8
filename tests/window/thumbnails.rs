//! The list of stages with small pictures.

use crate::common::open_sized;
use eframe::egui::{Event, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::Window;
use weekender::stages::Stage;

fn rows(harness: &Harness<'_, Window>) -> usize {
    let is_there = |stage: &&Stage| harness.query_by_label(&name(stage)).is_some();
    Stage::ALL.iter().filter(is_there).count()
}

fn name(stage: &Stage) -> String {
    format!("{} {}", stage.section, stage.title)
}

#[test]
fn the_list_is_used_from_the_keyboard() {
    let mut harness = open_sized("--stage metal --size 32x18", [1280.0, 800.0]);
    harness.run_steps(2);
    harness.key_press(Key::O);
    harness.run_steps(10);
    assert!(rows(&harness) > 8);
    let metal = name(Stage::find("metal").unwrap());
    let metal = harness.get_by_label(&metal);
    assert!(metal.is_focused(), "the current stage has the focus");
    assert_eq!(metal.accesskit_node().toggled(), Some(eframe::egui::accesskit::Toggled::True));
    for key in [Key::ArrowDown, Key::ArrowDown, Key::ArrowDown, Key::ArrowUp] {
        harness.key_press(key);
        harness.run_steps(4);
    }
    assert_eq!(harness.state().document().stage().unwrap().id, "metal", "not chosen yet");
    harness.key_press(Key::Enter);
    harness.run_steps(5);
    assert_eq!(harness.state().document().stage().unwrap().id, "glass-refract");
    assert_eq!(rows(&harness), 0, "the list has closed");
    // Escape closes it without a choice.
    harness.key_press(Key::O);
    harness.run_steps(10);
    harness.key_press(Key::ArrowUp);
    harness.run_steps(4);
    harness.key_press(Key::Escape);
    harness.run_steps(10);
    assert_eq!((harness.state().document().stage().unwrap().id, rows(&harness)), ("glass-refract", 0));
}

/// The letters find a stage, and none of them is a shortcut.
#[test]
fn a_stage_is_found_by_typing() {
    let mut harness = open_sized("--stage metal --size 32x18", [1280.0, 800.0]);
    harness.run_steps(2);
    harness.key_press(Key::O);
    harness.run_steps(10);
    for (key, letter) in [(Key::S, "s"), (Key::C, "c"), (Key::H, "h"), (Key::L, "l")] {
        harness.key_down(key);
        harness.event(Event::Text(letter.to_owned()));
        harness.key_up(key);
        harness.run_steps(2);
    }
    assert_eq!(rows(&harness), 1);
    assert!(harness.state_mut().remembered_mut().has_controls);
    assert!(!harness.state().is_comparing() && !harness.state().has_sight());
    harness.key_press(Key::Enter);
    harness.run_steps(5);
    assert_eq!(harness.state().document().stage().unwrap().id, "glass-schlick");
    assert_eq!(rows(&harness), 0, "the list has closed");
}
