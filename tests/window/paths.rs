//! The paths of a pixel, and the way through them.

use crate::harness::{SMALL, control, has_samples, middle, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::{self, Key};
use egui_kittest::Harness;
use weekender::app::{Command, Window};

/// A window with the paths of the pixel in the middle of the picture.
fn listed() -> Harness<'static, Window> {
    let mut harness = open(&format!("{SMALL} --samples 16"));
    until(&mut harness, "a picture", has_samples(1));
    list(&mut harness);
    harness
}

fn list(harness: &mut Harness<'_, Window>) {
    let at = middle(harness);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    harness.key_press(Key::T);
    until(harness, "a path for each sample", |window| window.listed_paths() == 16);
    harness.run_steps(3);
}

#[test]
fn keys_and_buttons_go_through_paths_and_points() {
    let mut harness = listed();
    let at = |harness: &Harness<'_, Window>| harness.state().explained_point().expect("a path is shown");
    let [path, point, count] = at(&harness);
    assert!((path, point) == (1, 2) && count > 2);
    for expected in 3..=count {
        harness.key_press(Key::ArrowRight);
        harness.run_steps(2);
        assert_eq!(at(&harness)[1], expected);
    }
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
    assert_eq!(at(&harness)[1], count - 1);
    for (name, expected) in [("Next path", 2), ("Previous path", 1)] {
        control(&harness, name).click();
        harness.run_steps(3);
        assert_eq!(at(&harness)[..2], [expected, 2]);
    }
}

#[test]
fn escape_closes_the_paths_and_t_lists_them_again() {
    let mut harness = listed();
    for _ in 0..2 {
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        assert_eq!((harness.state().listed_paths(), harness.state_mut().remembered_mut().dock), (0, None));
        list(&mut harness);
    }
    send(&mut harness, Command::ClearPaths);
    assert_eq!(harness.state().listed_paths(), 0);
}
