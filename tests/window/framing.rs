//! Zoom, pan and crop come back with the picture that they belong to.

use crate::common::{has_samples, opened, send, until};
use eframe::egui::{Rect, pos2, vec2};
use egui_kittest::Harness;
use std::path::Path;
use weekender::app::{Command, Window};
use weekender::cli::{self, Request, WindowOptions};

fn open(state: &Path, arguments: &str) -> Harness<'static, Window> {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    let Request::Window(options) = cli::parse(words.map(Into::into)).unwrap() else { panic!("no window") };
    let options = WindowOptions { state_directory: Some(state.to_owned()), ..*options };
    let mut window = Window::new(options).unwrap();
    window.remembered_mut().first_steps.is_over = true;
    let mut harness = opened(window);
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(5);
    harness
}

fn close(mut harness: Harness<'_, Window>) {
    harness.state_mut().end_in_order();
}

fn rect(harness: &Harness<'_, Window>) -> Rect {
    harness.state().picture_rect()
}

const PICTURE: &str = "--stage metal --size 64x36 --samples 4";

#[test]
fn zoom_and_pan_come_back() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(directory.path(), PICTURE);
    let fitting = rect(&harness);
    for _ in 0..3 {
        send(&mut harness, Command::ZoomIn);
    }
    // A place that is not the middle.
    let at = rect(&harness).lerp_inside(vec2(0.3, 0.7));
    harness.hover_at(at);
    harness.step();
    harness.event_modifiers(
        eframe::egui::Event::MouseWheel {
            unit: eframe::egui::MouseWheelUnit::Line,
            delta: vec2(0.0, 3.0),
            phase: eframe::egui::TouchPhase::Move,
            source: eframe::egui::MouseWheelSource::Wheel,
            modifiers: eframe::egui::Modifiers::COMMAND,
        },
        eframe::egui::Modifiers::COMMAND,
    );
    harness.run_steps(60);
    let before = rect(&harness);
    assert!(before.width() > 1.9 * fitting.width() && (before.center() - fitting.center()).length() > 10.0);
    close(harness);
    let mut harness = open(directory.path(), "");
    let found = rect(&harness);
    assert!(
        (found.min - before.min).length() < 1.5 && (found.size() - before.size()).length() < 1.0,
        "{found} {before}"
    );
    send(&mut harness, Command::Fit);
    assert!((rect(&harness).size() - fitting.size()).length() < 1.0);
    close(harness);
    let harness = open(directory.path(), "");
    assert!((rect(&harness).size() - fitting.size()).length() < 1.0, "a picture that fits stays so");
}

/// The next window shows another picture, to which the zoom does not belong.
#[test]
fn another_picture_is_shown_whole() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(directory.path(), PICTURE);
    for _ in 0..5 {
        send(&mut harness, Command::ZoomIn);
    }
    let before = rect(&harness);
    close(harness);
    let harness = open(directory.path(), "--stage metal --size 32x18 --samples 4");
    assert!(rect(&harness).width() < 0.7 * before.width(), "{} {before}", rect(&harness));
}

#[test]
fn a_crop_comes_back() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(directory.path(), PICTURE);
    send(&mut harness, Command::Crop);
    let picture = rect(&harness);
    let from = picture.lerp_inside(vec2(0.25, 0.25));
    crate::common::drag_from(&mut harness, from, 0.25 * picture.size());
    harness.run_steps(3);
    let crop = harness.state().crop().unwrap();
    assert!(crop[1][0] > 10 && crop[1][1] > 5, "{crop:?}");
    close(harness);
    let harness = open(directory.path(), "");
    assert_eq!(harness.state().crop(), Some(crop));
    assert!(rect(&harness).contains(pos2(from.x, from.y)));
}
