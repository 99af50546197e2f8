//! Snapshots of the whole window. `UPDATE_SNAPSHOTS=1` takes them anew; look at them before you commit them.

use crate::common::gpu::has_adapter;
use crate::harness::{has_samples, middle, send, until, window};
use crate::objects::{click, middle_sphere, on_screen, spheres};
use crate::questions::Ask as _;
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use weekender::app::{Command, Theme, Window};
use weekender::progressive::Phase;

type Act = fn(&mut Harness<'static, Window>);

/// A picture of the whole window after `act`. Numbers that change from run to run are covered.
fn snapshot(name: &str, theme: Theme, size: [f32; 2], scale: f32, act: Act) {
    if !has_adapter() {
        return;
    }
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
    until(&mut harness, "the stop", |window| matches!(window.status().phase, Phase::Done(_)));
    act(&mut harness);
    harness.run_steps(60);
    let status_height = if size[0] < 1100.0 { 74.0 } else { 33.0 };
    harness.mask(egui::Rect::from_min_max(egui::pos2(0.0, size[1] - status_height), size.into()));
    // Fonts and edges differ slightly between adapters.
    let options = egui_kittest::SnapshotOptions::new().threshold(2.0).max_failed_pixels(400_usize);
    harness.snapshot_options(name, &options);
}

const LARGE: [f32; 2] = [1280.0, 800.0];
const SMALL: [f32; 2] = [1000.0, 640.0];

fn press(harness: &mut Harness<'_, Window>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(5);
}

#[test]
fn the_dark_window_looks_as_it_did() {
    snapshot("window_dark", Theme::Dark, LARGE, 1.0, |_| {});
}

#[test]
fn the_light_window_looks_as_it_did() {
    snapshot("window_light", Theme::Light, LARGE, 1.0, |_| {});
}

#[test]
fn at_twice_the_font_size_it_looks_as_it_did() {
    snapshot("window_twice_the_font", Theme::Dark, [640.0, 400.0], 2.0, |_| {});
}

#[test]
fn paths_look_as_they_did() {
    snapshot("window_paths", Theme::Light, SMALL, 1.0, |harness| {
        let at = middle(harness);
        harness.event(egui::Event::PointerMoved(at));
        harness.run_steps(2);
        send(harness, Command::ListPaths);
        until(harness, "the paths", |window| window.listed_paths() > 0);
    });
}

#[test]
fn a_selected_sphere_looks_as_it_did() {
    snapshot("window_sphere", Theme::Dark, SMALL, 1.0, |harness| {
        let sphere = middle_sphere(harness);
        let at = on_screen(harness, spheres(harness)[sphere].center);
        click(harness, at, Modifiers::NONE);
    });
}

#[test]
fn the_palette_looks_as_it_did() {
    snapshot("window_palette", Theme::Light, SMALL, 1.0, |harness| {
        press(harness, Modifiers::COMMAND, Key::P);
        harness.event(egui::Event::Text("film".to_owned()));
    });
}

#[test]
fn a_presentation_looks_as_it_did() {
    snapshot("window_present", Theme::Dark, SMALL, 1.0, |harness| press(harness, Modifiers::NONE, Key::F5));
}
