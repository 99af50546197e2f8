//! The palette: an empty box does nothing, and what is found is carried out.

use crate::harness::{SMALL, control, open};
use crate::questions::Ask as _;
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Theme, Window};

fn enter(harness: &mut Harness<'_, Window>, text: &str, downs: usize) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(3);
    harness.get_by_label("Command").type_text(text);
    harness.run_steps(3);
    for _ in 0..downs {
        harness.key_press(Key::ArrowDown);
        harness.run_steps(2);
    }
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
}

#[test]
fn typed_commands_are_carried_out() {
    let mut harness = open(SMALL);
    enter(&mut harness, "", 0);
    assert_eq!(harness.state().performed(), Some(Command::Palette), "Enter in an empty box does nothing");
    enter(&mut harness, "", 1);
    assert_eq!(harness.state().performed(), Some(Command::ShowMe));
    enter(&mut harness, "dark", 0);
    assert_eq!(harness.state().performed(), Some(Command::Theme(Theme::Dark)));
    enter(&mut harness, "11.2 ", 0);
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "glass-refract");
}

#[test]
fn no_tip_stays_above_a_dialog() {
    let mut harness = open(SMALL);
    let at = control(&harness, "Save…").rect().center();
    harness.event(Event::PointerMoved(at));
    harness.run_steps(60);
    let has_tip = |harness: &Harness<'_, Window>| {
        harness.query_all_by_label_contains(Command::Save.help()).next().is_some()
    };
    assert!(has_tip(&harness));
    harness.key_press(Key::F1);
    harness.run_steps(5);
    assert!(harness.state().has_dialog() && !has_tip(&harness));
}
