//! The list of paths of a pixel, and the way through it.

use crate::common::{SMALL, control, has_samples, middle, open, send, until};
use eframe::egui::{self, Key};
use egui_kittest::Harness;
use weekender::app::{Command, Window};

/// A window with the paths of the pixel in the middle of the picture.
fn listed() -> Harness<'static, Window> {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    send(&mut harness, Command::ListPaths);
    until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
    harness.run_steps(30);
    harness
}

fn is_open(harness: &Harness<'_, Window>, sample: usize) -> bool {
    let header = control(harness, &format!("Path of sample {sample}")).rect();
    let next = control(harness, &format!("Path of sample {}", sample + 1)).rect();
    next.top() - header.bottom() > 40.0
}

/// Clicks a control of the list, which may move because the figures above it change.
fn press(harness: &mut Harness<'_, Window>, name: &str) {
    control(harness, name).click_accesskit();
    harness.run_steps(30);
}

#[test]
fn buttons_go_through_the_paths() {
    let mut harness = listed();
    assert!(is_open(&harness, 0));
    press(&mut harness, "Path of the sample after");
    assert!(is_open(&harness, 1) && !is_open(&harness, 0));
    press(&mut harness, "Path of the sample before");
    assert!(is_open(&harness, 0) && !is_open(&harness, 1));
}

#[test]
fn buttons_and_the_list_go_through_the_rays_of_a_path() {
    let mut harness = listed();
    let rays = |harness: &Harness<'_, Window>| harness.state().explained_ray().expect("a path is open");
    let [first, count] = rays(&harness);
    assert!(first == 1 && count > 1, "{first} of {count}");
    for expected in 2..=count {
        press(&mut harness, "Ray after (Right)");
        assert_eq!(rays(&harness)[0], expected);
    }
    for expected in (1..count).rev() {
        press(&mut harness, "Ray before (Left)");
        assert_eq!(rays(&harness)[0], expected);
    }
    press(&mut harness, "Ray 2");
    assert_eq!(rays(&harness)[0], 2);
}

#[test]
fn escape_clears_the_paths_and_t_lists_them_again() {
    let mut harness = listed();
    for _ in 0..2 {
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        assert_eq!(harness.state().listed_paths(), 0);
        assert_eq!(harness.state().performed(), Some(Command::ClearPaths));
        send(&mut harness, Command::ListPaths);
        until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
    }
    send(&mut harness, Command::ClearPaths);
    assert_eq!(harness.state().listed_paths(), 0);
    assert!(harness.state().disabled_reason(Command::ClearPaths).is_some());
}
