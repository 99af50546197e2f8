//! The right panel: its tabs, the code of a stage, and the check of a picture.

use crate::common::{SMALL, control, has_samples, open, open_sized, send, until, until_seen};
use crate::questions::Ask as _;
use eframe::egui;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use weekender::app::{Command, Window};
use weekender::stages::Stage;

/// The picture of stage 2.1 at 160 × 90, as the book's first program writes it; `upside_down`, if it counts rows from
/// the wrong end.
fn gradient(upside_down: bool) -> Vec<u8> {
    let share = |at: u32, count: u32| (255.999 * f64::from(at) / f64::from(count - 1)) as u8;
    let row = |y: u32| if upside_down { 89 - y } else { y };
    let pixels = (0..90).flat_map(|y| (0..160).map(move |x| [x, y]));
    let rgb8 = pixels.flat_map(|[x, y]| [share(x, 160), share(row(y), 90), 0]);
    b"P6\n160 90\n255\n".iter().copied().chain(rgb8).collect()
}

#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops a file on the window.
fn drop_file(harness: &mut Harness<'_, Window>, content: &[u8]) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.ppm");
    std::fs::write(&path, content).unwrap();
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    directory
}

#[test]
fn a_picture_of_another_program_is_checked() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let _kept = drop_file(&mut harness, &gradient(false));
    until_seen(&mut harness, "It is right");
    harness.run_steps(2);
    assert!(harness.query_by_label("Your picture and ours").is_some());
    send(&mut harness, Command::CompareMine);
    until(&mut harness, "my picture", |window| window.has_other_picture() && has_samples(1)(window));
    let document = harness.state().shown_document();
    assert!(document.stage().unwrap().section.starts_with("2.") && document.size() == [160, 90]);
    for at in [[0, 0], [80, 40], [159, 89]] {
        assert_eq!(harness.state().other_pixel(at), harness.state().shown_pixel(at), "{at:?}");
    }
    let _kept = drop_file(&mut harness, &gradient(true));
    until(&mut harness, "the answer", |window| window.checked().is_some_and(|title| title != "It is right"));
    harness.run_steps(2);
    control(&harness, "Go to 2.2").click();
    harness.run_steps(3);
    assert_eq!(harness.state().shown_document().stage().unwrap().section, "2.2");
    assert!(harness.query_by_label("Picture").is_some(), "the stage that was chosen is shown");
    control(&harness, "Check").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Picture").is_none());
    control(&harness, "Close").click();
    harness.run_steps(3);
    assert!(harness.state().checked().is_none() && harness.query_by_label("Picture").is_some());
    let _kept = drop_file(&mut harness, b"P6\nnothing");
    until_seen(&mut harness, "cannot be checked");
}

#[test]
fn the_code_of_a_stage_is_shown_and_copied() {
    let mut harness = open(SMALL);
    send(&mut harness, Command::Code);
    for (language, code) in [
        ("C", "static double reflectance("),
        ("WGSL", "fn reflectance(cosine: f32"),
        ("Rust", "fn reflectance<"),
    ] {
        control(&harness, language).click();
        harness.run_steps(2);
        assert!(harness.query_by_label_contains(code).is_some(), "{language}");
    }
    harness.get_all_by_label("Copy").next().unwrap().click();
    harness.step();
    let is_code = |command: &egui::OutputCommand| matches!(command, egui::OutputCommand::CopyText(text) if text.contains("fn reflectance"));
    assert!(harness.output().platform_output.commands.iter().any(is_code));
    send(&mut harness, Command::Code);
    harness.run_steps(2);
    assert!(harness.query_by_label("Why").is_some());
}

#[test]
fn view_and_pixel_stay_where_they_are() {
    let mut harness = open_sized("--stage ppm-tiny", [1280.0, 800.0]);
    let mut places = Vec::new();
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        harness.run_steps(2);
        let place = |name| harness.get_by_label(name).rect().top();
        places.push([place("View, folded"), place("Pixel")]);
    }
    places.dedup();
    assert_eq!(places.len(), 1, "{places:?}");
}
