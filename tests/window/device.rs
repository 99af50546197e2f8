//! Choosing the device, and pausing.

use crate::harness::{has_samples, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::Key;
use weekender::app::{Command, Device};

#[test]
fn another_device_continues_the_film() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    let (run, before) = (harness.state().status().run, harness.state().status().samples_per_pixel);
    send(&mut harness, Command::Reference);
    until(&mut harness, "two contributions", |window| window.status().contributions.len() == 2);
    let status = harness.state().status();
    assert_eq!(status.run, run);
    assert!(status.samples_per_pixel > before);
    let parts: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    assert_eq!(parts, status.samples_per_pixel);
    send(&mut harness, Command::Device(Device::Cpu));
    until(&mut harness, "the CPU", |window| {
        window.status().backend.as_ref().is_some_and(|backend| backend.name == "cpu")
    });
    assert_eq!(harness.state().status().run, run);
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
