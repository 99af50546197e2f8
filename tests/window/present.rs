//! A presentation.

use crate::harness::{has_samples, open_sized, send, until};
use crate::questions::Ask as _;
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
fn presentations_render_at_screen_size_and_end_with_escape() {
    let mut harness = open_sized("--stage glass-schlick --device cpu", [1280.0, 720.0]);
    until(&mut harness, "a picture", has_samples(1));
    let small = harness.state().shown_document().size();
    send(&mut harness, Command::ActualSize);
    send(&mut harness, Command::Wipe);
    for ends in [Key::Escape, Key::F5] {
        harness.key_press(Key::F5);
        harness.run_steps(3);
        assert!(harness.state().is_presenting());
        assert!(harness.query_all_by_label("Field of view").next().is_none(), "no panels");
        until(&mut harness, "its own size", |window| {
            let (rect, size) = (window.picture_rect(), window.shown_document().size());
            (rect.width() - size[0] as f32).abs() < 2.0 && size[1] > small[1] && has_samples(1)(window)
        });
        let rect = harness.state().picture_rect();
        assert!((rect.center().x - 640.0).abs() < 1.0 && rect.height() > 300.0, "{rect:?}");
        harness.key_press(ends);
        harness.run_steps(3);
        assert!(!harness.state().is_presenting(), "{ends:?}");
        assert!(harness.state().is_comparing(), "{ends:?} leaves the wipe");
    }
}

#[test]
fn one_key_goes_to_the_next_stage() {
    let mut harness = present("--stage metal --size 32x18", [1280.0, 720.0]);
    let id = |harness: &Harness<'_, Window>| harness.state().shown_document().stage().unwrap().id;
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
        assert!(has(&harness, harness.state().shown_document().stage().unwrap().title));
    }
    assert!(harness.state().messages().is_empty(), "{:?}", harness.state().messages());
}
