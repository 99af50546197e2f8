//! The list of stages with small pictures.

use crate::harness::open_sized;
use crate::questions::Ask as _;
use eframe::egui::{Event, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Window};
use weekender::stages::Stage;

fn rows(harness: &Harness<'_, Window>) -> usize {
    let is_row = |stage: &'static Stage| {
        let name = Command::Stage(stage).name();
        let mut named = harness.query_all_by_label(&name);
        named.any(|node| node.accesskit_node().toggled().is_some())
    };
    Stage::ALL.iter().filter(|stage| is_row(stage)).count()
}

fn shown(harness: &Harness<'_, Window>) -> &'static str {
    harness.state().shown_document().stage().map_or("", |stage| stage.id)
}

fn press(harness: &mut Harness<'_, Window>, keys: &[Key]) {
    for key in keys {
        harness.key_press(*key);
        harness.run_steps(5);
    }
}

#[test]
fn a_stage_is_chosen_with_arrows_or_by_typing() {
    let mut harness = open_sized("--stage metal --size 32x18", [1280.0, 800.0]);
    harness.run_steps(2);
    press(&mut harness, &[Key::O, Key::ArrowDown, Key::ArrowDown, Key::ArrowDown, Key::ArrowUp]);
    assert!(rows(&harness) > 8);
    assert_eq!(shown(&harness), "metal", "not chosen yet");
    press(&mut harness, &[Key::Enter]);
    assert_eq!((shown(&harness), rows(&harness)), ("glass-refract", 0), "the list has closed");
    press(&mut harness, &[Key::O]);
    // None of the letters is a shortcut.
    for (key, letter) in [(Key::S, "s"), (Key::C, "c"), (Key::H, "h"), (Key::L, "l")] {
        harness.key_down(key);
        harness.event(Event::Text(letter.to_owned()));
        harness.key_up(key);
        harness.run_steps(2);
    }
    assert_eq!(rows(&harness), 1);
    press(&mut harness, &[Key::Escape]);
    assert!(rows(&harness) > 8, "the first Escape forgets what was typed");
    press(&mut harness, &[Key::Escape]);
    assert_eq!((shown(&harness), rows(&harness)), ("glass-refract", 0));
    assert!(!harness.state_mut().remembered_mut().hides_controls && !harness.state().is_comparing());
}
