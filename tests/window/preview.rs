//! While something moves, coarse previews are shown; they are never saved or reported.

use crate::common::{copied_command, has_samples, hold, open, send, until};
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};
use weekender::app::{Command, Window};
use weekender::film::to_byte;
use weekender::output::{OutputFormat, read_description};
use weekender::progressive::Stop;
use weekender::recipe::file;
use weekender::stages::Transfer;

/// Large enough for previews to be coarser.
const LARGE: &str = "--size 1600x900 --device cpu --samples 4";

/// Draws frames, each with a change of the picture, until a preview is on screen.
fn move_until_preview(harness: &mut Harness<'_, Window>, change: impl Fn(&mut Window)) {
    let begin = Instant::now();
    while harness.state().shown().is_none_or(|(_, divisor)| divisor == 1) {
        assert!(begin.elapsed() < Duration::from_secs(60), "no preview");
        std::thread::sleep(Duration::from_millis(2));
        change(harness.state_mut());
        harness.step();
    }
}

#[test]
fn what_is_saved_while_the_camera_moves_has_the_full_size() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("moving.png");
    let mut harness = open(&format!("--stage sky {LARGE}"));
    until(&mut harness, "a picture", has_samples(1));
    let at = harness.state().picture_rect().center();
    hold(&mut harness, at, true);
    let change = |window: &mut Window| window.document_mut().camera.vfov_degrees -= 0.01;
    send(&mut harness, Command::Save(OutputFormat::Png));
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_label("File name").type_text(path.to_str().unwrap());
    harness.run_steps(2);
    move_until_preview(&mut harness, change);
    harness.key_press(Key::Enter);
    for _ in 0..10 {
        change(harness.state_mut());
        harness.step();
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(!harness.state().has_dialog(), "the name was taken while the camera moved");
    assert!(harness.state().shown().unwrap().1 > 1, "a preview is on the screen");
    hold(&mut harness, at, false);
    let saved = format!("Saved {}", path.display());
    until(&mut harness, &saved, |window| window.messages().contains(&saved));
    assert_eq!(image::image_dimensions(&path).unwrap(), (1600, 900));
    let recipe = file::parse(read_description(&path).unwrap().recipe(), "saved").unwrap();
    assert_eq!(recipe.camera.vfov_degrees, harness.state().document().camera.vfov_degrees);
}

#[test]
fn the_pixel_under_the_pointer_is_never_that_of_a_preview() {
    // The sky gets bluer from bottom to top, so a pixel of a coarser picture has a different colour. This pixel is
    // also inside that picture.
    let mut harness = open(&format!("--stage sky {LARGE}"));
    let at = harness.state().picture_rect().lerp_inside(egui::vec2(0.05, 0.08));
    harness.event(egui::Event::PointerMoved(at));
    until(&mut harness, "the end", has_samples(4));
    until(&mut harness, "the pixel", |window| window.inspected().is_some());
    let (pixel, expected) = harness.state().inspected().unwrap();
    // Another number of samples is a new picture, and is requested.
    harness.state_mut().document_mut().stop = Stop::at_samples(2);
    hold(&mut harness, at, true);
    // Another seed gives another film with the same colours.
    let change = |window: &mut Window| window.document_mut().settings.seed += 1;
    let mut previews = 0;
    for _ in 0..60 {
        move_until_preview(&mut harness, change);
        previews += u32::from(!harness.state().is_up_to_date() || harness.state().shown().unwrap().1 > 1);
        for _ in 0..3 {
            std::thread::sleep(Duration::from_millis(2));
            harness.step();
        }
        change(harness.state_mut());
        harness.step();
        let (found, mean) = harness.state().inspected().unwrap();
        assert_eq!(found, pixel);
        let off = (0..3).map(|i| (mean[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(off < 0.002, "{mean:?} where the picture has {expected:?}");
    }
    assert!(previews > 10, "{previews}");
}

#[test]
fn a_command_copied_during_a_move_renders_the_picture_and_not_the_preview() {
    let mut harness = open("--stage sky --size 1600x900 --device cpu --samples 4000");
    until(&mut harness, "a picture", has_samples(1));
    let at = harness.state().picture_rect().center();
    hold(&mut harness, at, true);
    let change = |window: &mut Window| window.document_mut().camera.vfov_degrees -= 0.01;
    move_until_preview(&mut harness, change);
    let has_some = |window: &Window| (1..4000).contains(&window.status().samples_per_pixel);
    let begin = Instant::now();
    while !has_some(harness.state()) {
        assert!(begin.elapsed() < Duration::from_secs(60), "no preview has samples");
        change(harness.state_mut());
        // A change in each frame would begin a new preview before the last one has samples.
        for _ in 0..20 {
            harness.step();
            if has_some(harness.state()) {
                break;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }
    change(harness.state_mut());
    let copied = copied_command(&mut harness);
    assert!(copied.contains(" --samples=4000 "), "{copied}");
    hold(&mut harness, at, false);
}

/// The upper half of this stage's picture is linear, the lower half is not.
#[test]
fn the_bytes_of_a_pixel_are_those_of_its_row() {
    let mut harness = open("--stage gamut --size 64x36 --samples 4");
    until(&mut harness, "the end", has_samples(4));
    for (share, is_upper) in [([0.9_f32, 0.1], true), ([0.1, 0.9], false)] {
        let at = harness.state().picture_rect().lerp_inside(share);
        harness.event(egui::Event::PointerMoved(at));
        harness.step();
        let is_there = |window: &Window| window.inspected().is_some_and(|([_, y], _)| (y < 18) == is_upper);
        until(&mut harness, "the pixel", is_there);
        harness.step();
        let ([_, y], mean) = harness.state().inspected().unwrap();
        for linear in mean {
            let byte = to_byte(linear, Transfer::LinearAboveGamma2, y as usize, 36).to_string();
            let is_seen = harness.query_all_by_label(&byte).next().is_some();
            assert!(is_seen, "{linear} in row {y}: {byte} is not in the panel");
        }
    }
}

#[test]
fn a_picture_that_takes_long_is_looked_at_first() {
    let mut harness = open("--stage book --size 3200x1800 --device cpu --samples 2");
    until(&mut harness, "a picture", |window| window.shown().is_some());
    let (samples, divisor) = harness.state().shown().unwrap();
    assert!(divisor > 1 && samples >= 1, "{samples} samples, 1/{divisor}");
    until(&mut harness, "the picture itself", has_samples(2));
}
