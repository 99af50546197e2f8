//! The size of the picture: that of the viewport, the book's, or its own.

use crate::harness::{has_samples, scaled, send, sized, until, window_of_new_user};
use crate::questions::Ask as _;
use eframe::egui::{self, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};
use weekender::app::{Command, Window};

/// A cheap picture that follows the viewport.
const FOLLOWING: &str = "--stage normals --samples 2";

/// A window of this size, in points, whose picture follows the viewport.
fn following(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    sized(window_of_new_user(arguments), size)
}

fn size(harness: &Harness<'_, Window>) -> [u32; 2] {
    harness.state().shown_document().size()
}

/// Draws frames for longer than the picture takes to follow a new size.
fn settle(harness: &mut Harness<'_, Window>) {
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(600) {
        std::thread::sleep(Duration::from_millis(10));
        harness.step();
    }
}

/// Whether the picture fills the viewport in one direction, and each of its pixels is one of the screen.
fn fills_the_viewport(harness: &Harness<'_, Window>, scale: f32) {
    let (picture, room) = (harness.state().picture_rect(), harness.get_by_label("Picture").rect());
    let pixels = size(harness).map(|pixels| pixels as f32);
    let drawn = picture.size() * scale;
    assert!((drawn - egui::vec2(pixels[0], pixels[1])).length() < 0.1, "{drawn} for {pixels:?}");
    let free = (room.size() - picture.size()).min_elem();
    // The picture has a margin of 8 points.
    assert!((15.0..19.0).contains(&free), "{free} points are free");
    let aspect = pixels[0] / pixels[1];
    assert!((aspect - 16.0 / 9.0).abs() < 0.01, "the book's picture shows something else: {aspect}");
}

#[test]
fn the_picture_fills_the_viewport_at_its_own_resolution() {
    for (points, scale) in [([1000.0, 500.0], 1.0), ([1000.0, 900.0], 1.0), ([1000.0, 600.0], 2.0)] {
        let mut harness = scaled(window_of_new_user(FOLLOWING), points, scale);
        settle(&mut harness);
        until(&mut harness, "the end", has_samples(2));
        fills_the_viewport(&harness, scale);
        assert!(harness.state().disabled_reason(Command::Undo).is_some(), "nothing was changed");
    }
}

#[test]
fn panels_only_show_the_picture_smaller() {
    let mut harness = following(FOLLOWING, [1280.0, 800.0]);
    settle(&mut harness);
    until(&mut harness, "the end", has_samples(2));
    let (whole, run) = (size(&harness), harness.state().status().run);
    let mut heights = Vec::new();
    for command in [Command::ErrorDock, Command::Code] {
        send(&mut harness, command);
        settle(&mut harness);
        heights.push(harness.get_by_label("Picture").rect().height());
        assert_eq!((size(&harness), harness.state().status().run), (whole, run), "{command:?}");
        assert!(harness.query_by_label("This picture is scaled.").is_none());
        assert!(harness.state().picture_rect().width() < whole[0] as f32);
    }
    heights.dedup();
    assert_eq!(heights.len(), 1, "all tabs of the dock are as high: {heights:?}");
    // A larger room is filled.
    harness.key_press(Key::Tab);
    settle(&mut harness);
    assert!(size(&harness)[0] > whole[0]);
}
