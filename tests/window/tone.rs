//! Exposure, luminance in false colours, and denoising.

use crate::harness::{SMALL, mean, open, save, send, until, until_seen};
use crate::questions::Ask as _;
use egui_kittest::Harness;
use weekender::app::{Command, Show, Window};
use weekender::film::{key, to_byte};
use weekender::job::output::read_description;
use weekender::numbers::heat::HeatScale;
use weekender::progressive::Phase;

const AT: [u32; 2] = [3, 2];

fn finished() -> Harness<'static, Window> {
    let mut harness = open(&format!("{SMALL} --samples 8"));
    until(&mut harness, "the end", |window| {
        matches!(window.status().phase, Phase::Done(_)) && window.shown().is_some_and(|(count, _)| count == 8)
    });
    harness
}

#[test]
fn exposure_is_seen_but_not_saved() {
    let mut harness = finished();
    let mean = mean(&mut harness, AT);
    let transfer = harness.state().shown_document().rules().transfer;
    let seen = |stops: f64| mean.map(|x| to_byte(x * stops.exp2(), transfer, AT[1] as usize, 18));
    assert_eq!(harness.state().shown_pixel(AT), Some(seen(0.0)));
    for _ in 0..3 {
        send(&mut harness, Command::Darker);
    }
    until(&mut harness, "a darker picture", |window| window.shown_pixel(AT) == Some(seen(-1.5)));
    assert!(seen(-1.5)[2] < seen(0.0)[2]);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("saved.png");
    save(&mut harness, Command::Save, &path);
    let saved = image::open(&path).unwrap().to_rgb8();
    assert_eq!(saved.get_pixel(AT[0], AT[1]).0, seen(0.0), "files are saved without the exposure");
    send(&mut harness, Command::NoExposure);
    until(&mut harness, "the picture", |window| window.shown_pixel(AT) == Some(seen(0.0)));
}

#[test]
fn luminance_has_the_colours_of_its_scale() {
    let mut harness = finished();
    let [red, green, blue] = mean(&mut harness, AT);
    send(&mut harness, Command::Show(Show::Luminance));
    assert!(harness.state().disabled_reason(Command::Brighter).is_some());
    let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let colour = HeatScale::luminance([-8.0, 4.0]).colour(luminance);
    until(&mut harness, "false colours", |window| window.shown_pixel(AT) == Some(colour));
}

#[test]
fn a_denoised_picture_is_shown_measured_and_saved() {
    let mut harness = finished();
    let shown = |window: &Window| -> Vec<_> {
        (0..18).flat_map(|y| (0..32).map(move |x| [x, y])).map(|at| window.shown_pixel(at)).collect()
    };
    let raw = shown(harness.state());
    send(&mut harness, Command::Denoise);
    until(&mut harness, "the denoised picture", |window| shown(window) != raw);
    until_seen(&mut harness, ": error");
    let mean = mean(&mut harness, AT);
    let transfer = harness.state().shown_document().rules().transfer;
    let seen = mean.map(|x| to_byte(x, transfer, AT[1] as usize, 18));
    assert_eq!(harness.state().shown_pixel(AT), Some(seen), "the panel tells the denoised pixel");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("saved.png");
    save(&mut harness, Command::Save, &path);
    assert_eq!(image::open(&path).unwrap().to_rgb8().get_pixel(AT[0], AT[1]).0, seen);
    assert!(read_description(&path).unwrap().get(key::DENOISED).is_some());
    send(&mut harness, Command::Denoise);
    until(&mut harness, "the picture with its noise", |window| shown(window) == raw);
}

#[test]
fn a_saved_denoised_picture_has_all_samples() {
    // With so many pixels, the raw picture stays the worse one.
    let mut harness = open("--stage glass-schlick --size 160x90 --samples 4000000000");
    send(&mut harness, Command::Denoise);
    until_seen(&mut harness, ": error");
    send(&mut harness, Command::Pause);
    until(&mut harness, "the pause", |window| window.status().phase == Phase::Paused);
    let samples = |window: &Window| window.status().samples_per_pixel;
    let before = samples(harness.state());
    send(&mut harness, Command::Pause);
    until(&mut harness, "more samples", |window| samples(window) > before + before / 2);
    let before = samples(harness.state());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("saved.png");
    save(&mut harness, Command::Save, &path);
    let description = read_description(&path).unwrap();
    assert!(description.get(key::DENOISED).is_some());
    assert!(description.get("Samples").unwrap().parse::<u64>().unwrap() >= before);
}
