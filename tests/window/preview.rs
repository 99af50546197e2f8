//! While something moves, coarse previews are shown; they are never saved or reported.

use crate::common::{has_samples, hold, open, send, until};
use eframe::egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::{Duration, Instant};
use weekender::app::{Command, Window};
use weekender::job::output::{OutputFormat, read_description};
use weekender::job::recipe::file;

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
