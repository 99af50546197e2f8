//! Choosing the device, and pausing.

use crate::common::{drag, has_samples, open, send, until, until_seen};
use eframe::egui::{Key, Modifiers, PointerButton};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::Duration;
use weekender::app::{Command, Device, Window};

#[test]
fn another_device_goes_on_with_the_same_film() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    let (run, before) = (harness.state().status().run, harness.state().status().samples_per_pixel);
    send(&mut harness, Command::Device(Device::Reference));
    until(&mut harness, "two contributions", |window| window.status().contributions.len() == 2);
    let status = harness.state().status();
    assert_eq!(status.run, run);
    assert!(status.samples_per_pixel > before);
    let parts: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    assert_eq!(parts, status.samples_per_pixel);
    harness.state_mut().remembered_mut().lanes = Some(1);
    send(&mut harness, Command::Device(Device::Cpu));
    until(&mut harness, "three contributions", |window| window.status().contributions.len() == 3);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn a_pause_loses_nothing() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    harness.key_press(Key::Space);
    until(&mut harness, "a pause", |window| window.status().phase == weekender::progressive::Phase::Paused);
    let (run, samples) = (harness.state().status().run, harness.state().status().samples_per_pixel);
    std::thread::sleep(Duration::from_millis(60));
    harness.run_steps(3);
    assert_eq!(harness.state().status().samples_per_pixel, samples);
    harness.key_press(Key::Space);
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > samples);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn a_pause_outlasts_a_move_of_the_camera() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(16));
    harness.key_press(Key::Space);
    until(&mut harness, "a pause", |window| window.status().phase == weekender::progressive::Phase::Paused);
    let run = harness.state().status().run;
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    until(&mut harness, "the moved picture", |window| {
        let is_shown = window.is_up_to_date() && window.shown() == Some((8, 1));
        window.status().run > run && is_shown && window.status().phase.is_over()
    });
    std::thread::sleep(Duration::from_millis(60));
    harness.run_steps(5);
    assert!(harness.state().is_paused());
    assert_eq!(harness.state().status().samples_per_pixel, 8, "it waits");
    let run = harness.state().status().run;
    harness.key_press(Key::Space);
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > 8);
    assert_eq!(harness.state().status().run, run, "the same film continues");
}

#[test]
fn a_new_start_ends_a_pause() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    harness.key_press(Key::Space);
    until(&mut harness, "a pause", |window| window.status().phase == weekender::progressive::Phase::Paused);
    let run = harness.state().status().run;
    send(&mut harness, Command::Restart);
    assert!(!harness.state().is_paused());
    until(&mut harness, "a new film", |window| {
        window.status().run > run && window.status().samples_per_pixel > 8
    });
}

#[test]
fn what_changes_with_the_estimate_moves_no_button() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000 --noise-target 0.0001");
    let places = |harness: &Harness<'_, Window>| {
        Device::ALL.map(|device| harness.get_by_label(&Command::Device(device).name()).rect())
    };
    let before = places(&harness);
    until_seen(&mut harness, "0.0001 in about");
    assert_eq!(places(&harness), before);
}
