//! The files that were opened or saved last, and the picture on the clipboard.

use crate::common::{SMALL, control, copied, has_samples, open, save, send, until};
use eframe::egui::{self};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::PathBuf;
use std::time::Duration;
use weekender::app::{Command, Window};
use weekender::job::output::OutputFormat;
use weekender::stages::Stage;

/// A window whose picture was saved under these names, one after the other, and that then shows another stage.
fn saved(directory: &tempfile::TempDir, names: &[&str]) -> (Harness<'static, Window>, Vec<PathBuf>) {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let paths: Vec<PathBuf> = names.iter().map(|name| directory.path().join(name)).collect();
    for path in &paths {
        save(&mut harness, Command::Save(OutputFormat::from_path(path).unwrap()), path);
    }
    send(&mut harness, Command::Stage(&Stage::ALL[0]));
    (harness, paths)
}

fn opens(harness: &mut Harness<'_, Window>, path: &std::path::Path) {
    let told = format!("Opened {}", path.display());
    until(harness, &told, |window| window.messages().contains(&told));
    assert_eq!(harness.state().document().stage().unwrap().id, "glass-schlick");
}

#[test]
fn files_are_opened_again_from_the_menu() {
    let directory = tempfile::tempdir().unwrap();
    let (mut harness, paths) = saved(&directory, &["one.png", "two.exr"]);
    let recent = |harness: &mut Harness<'_, Window>| harness.state_mut().remembered_mut().recent.clone();
    assert_eq!(recent(&mut harness), [paths[1].clone(), paths[0].clone()]);
    control(&harness, "File").click();
    harness.run_steps(3);
    harness.get_by_label("Open recent").click();
    harness.run_steps(3);
    harness.get_by_label("Open one.png").click();
    harness.run_steps(2);
    opens(&mut harness, &paths[0]);
    assert_eq!(recent(&mut harness), paths, "it is the newest now");
}

#[test]
fn the_picture_is_copied_as_it_is_saved() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("same.png");
    let mut harness = open(&format!("{SMALL} --samples 16"));
    until(&mut harness, "the end", has_samples(16));
    save(&mut harness, Command::Save(OutputFormat::Png), &path);
    // Neither the view nor the exposure is copied.
    send(&mut harness, Command::Brighter);
    harness.event(egui::Event::Copy);
    harness.step();
    let image = copied(&mut harness, Duration::from_secs(60)).expect("nothing was copied");
    let told = "Copied the picture: 32x18, 16 samples per pixel";
    assert!(harness.state().messages().iter().any(|text| text == told), "{:?}", harness.state().messages());
    let mine: Vec<u8> = image.pixels.iter().flat_map(|pixel| [pixel.r(), pixel.g(), pixel.b()]).collect();
    assert_eq!(image.size, [32, 18]);
    assert!(mine == image::open(&path).unwrap().to_rgb8().into_raw(), "not what is saved");
}
