//! Snapshots of the whole window.

use crate::common::{has_samples, send, until, window};
use eframe::egui;
use egui_kittest::Harness;
use weekender::app::{Command, Theme, Window};

/// A picture of the whole window. Numbers that change from run to run are covered.
fn snapshot(name: &str, theme: Theme, size: [f32; 2], scale: f32) {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(scale)
        .with_step_dt(1.0 / 60.0)
        .wgpu()
        .build_ui_state(
            |ui, window: &mut Window| window.ui_in(ui),
            window("--stage glass-schlick --size 240x135 --samples 64"),
        );
    send(&mut harness, Command::Theme(theme));
    until(&mut harness, "the end", has_samples(64));
    until(&mut harness, "the stop", |window| {
        matches!(window.status().phase, weekender::progressive::Phase::Done(_))
    });
    harness.run_steps(10);
    let status_height = if size[0] < 900.0 { 74.0 } else { 33.0 };
    let status =
        egui::Rect::from_min_max(egui::pos2(0.0, size[1] - status_height), egui::pos2(size[0], size[1]));
    harness.mask(status);
    // Fonts and edges differ slightly between adapters.
    let options = egui_kittest::SnapshotOptions::new().threshold(2.0).max_failed_pixels(400_usize);
    harness.snapshot_options(name, &options);
}

#[test]
fn the_dark_window_looks_as_it_did() {
    snapshot("window_dark", Theme::Dark, [1280.0, 800.0], 1.0);
}

#[test]
fn the_light_window_looks_as_it_did() {
    snapshot("window_light", Theme::Light, [1280.0, 800.0], 1.0);
}

#[test]
fn at_twice_the_font_size_it_looks_as_it_did() {
    snapshot("window_twice_the_font", Theme::Dark, [640.0, 400.0], 2.0);
}
