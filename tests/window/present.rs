//! A presentation.

use crate::common::{SMALL, has_samples, open, open_sized, send, until};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};

fn has(harness: &Harness<'_, Window>, label: &str) -> bool {
    harness.query_all_by_label(label).next().is_some()
}

fn present(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    let mut harness = open_sized(arguments, size);
    harness.run_steps(2);
    harness.key_press(Key::F5);
    harness.run_steps(4);
    assert!(harness.state().is_presenting());
    harness
}

#[test]
fn f5_begins_and_escape_ends() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    assert!(has(&harness, "Choose a stage"));
    for ends in [Key::Escape, Key::F5] {
        harness.key_press(Key::F5);
        harness.run_steps(3);
        assert!(harness.state().is_presenting() && harness.state().is_full_screen());
        assert!(!has(&harness, "Choose a stage") && !has(&harness, "Field of view"), "no menus and panels");
        harness.key_press(ends);
        harness.run_steps(3);
        assert!(!harness.state().is_presenting() && !harness.state().is_full_screen(), "{ends:?}");
        assert!(has(&harness, "Choose a stage"));
    }
    // A window that was in full-screen mode before stays in it.
    send(&mut harness, Command::FullScreen);
    send(&mut harness, Command::Present);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(!harness.state().is_presenting() && harness.state().is_full_screen());
}

#[test]
fn one_key_goes_to_the_next_stage() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let id = |harness: &Harness<'_, Window>| harness.state().document().stage().unwrap().id;
    for (key, expected) in [
        (Key::PageDown, "metal-fuzzy"),
        (Key::ArrowRight, "glass-refract"),
        (Key::ArrowDown, "glass-tir"),
        (Key::ArrowLeft, "glass-refract"),
        (Key::ArrowUp, "metal-fuzzy"),
        (Key::PageUp, "metal"),
    ] {
        harness.key_press(key);
        harness.run_steps(3);
        assert_eq!(id(&harness), expected, "{key:?}");
        assert!(has(&harness, harness.state().document().stage().unwrap().title));
    }
    assert!(harness.state().messages().is_empty(), "{:?}", harness.state().messages());
}
