//! Saving, opening, dropping and copying.

use crate::common::{SMALL, copied_command, has_samples, open, save, send, until};
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use weekender::app::Command;
use weekender::job::output::{OutputFormat, read_description};
use weekender::job::recipe::file;
use weekender::progressive::{Plan, Progressive, RenderRequest};
use weekender::stages::Stage;

/// The pixels that the recipe in a file gives with the number of samples that the file states.
fn rendered_again(path: &Path) -> Vec<u8> {
    let description = read_description(path).unwrap();
    let recipe = file::parse(description.recipe(), "again").unwrap();
    let samples = description.get("Samples").unwrap().parse().unwrap();
    let mut progressive = Progressive::spawn().unwrap();
    let job = recipe.job().unwrap();
    let backend = weekender::backends::BackendChoice::Cpu(weekender::render_cpu::CpuOptions::default());
    progressive.start(RenderRequest::new(job, backend, Plan::samples(samples)));
    progressive.wait_until_over();
    progressive.finish().unwrap().to_rgb8(recipe.rules.transfer)
}

#[test]
fn what_is_saved_is_the_film_and_can_be_opened_again() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open("--stage defocus --size 48x27 --samples 40");
    harness.state_mut().document_mut().camera.vfov_degrees = 31.0;
    harness.run_steps(2);
    until(&mut harness, "the end", has_samples(40));
    let shown = harness.state().document().clone();
    for format in OutputFormat::ALL {
        let path = directory.path().join(format!("saved{}", format.ending()));
        save(&mut harness, Command::Save(format), &path);
        if format != OutputFormat::Exr {
            let pixels = image::open(&path).unwrap().to_rgb8().into_raw();
            assert!(pixels == rendered_again(&path), "{format:?} differs from a render of its recipe");
        }
        send(&mut harness, Command::Stage(&Stage::ALL[0]));
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
        let opened = format!("Opened {}", path.display());
        until(&mut harness, &opened, |window| window.messages().contains(&opened));
        let document = harness.state().document();
        assert_eq!(document.stage(), shown.stage());
        assert_eq!((document.camera, document.settings), (shown.camera, shown.settings));
        until(&mut harness, "forty samples", |window| {
            has_samples(40)(window) && window.status().samples_per_pixel >= 40
        });
        // A film continues with its samples; those of a picture are traced again.
        let held = if format == OutputFormat::Exr { 40 } else { 0 };
        let status = harness.state().status();
        let traced: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
        assert_eq!(status.samples_per_pixel - traced, held, "{format:?}");
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn failures_are_told_in_words() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    for (name, content, told) in [
        ("missing.png", None, "cannot read"),
        ("broken.png", Some("nothing of the kind"), "Not checked: "),
        ("broken.toml", Some("[camera"), "broken.toml"),
        ("broken.exr", Some("nothing"), "broken.exr"),
    ] {
        let path = directory.path().join(name);
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
        until(&mut harness, told, |window| window.messages().iter().any(|text| text.contains(told)));
    }
    let document = harness.state().document();
    assert_eq!(document.stage().unwrap().id, "glass-schlick", "what was shown stays");

    send(&mut harness, Command::Save(OutputFormat::Png));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_label("File name").type_text(directory.path().join("no/such/place.png").to_str().unwrap());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(harness.state().has_dialog(), "the name can be corrected");
    assert!(harness.query_by_label_contains("such does not exist: create it").is_some());
    assert_eq!(harness.state_mut().remembered_mut().directory, None, "the next dialog does not start there");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
}

/// A file that would be lost is a warning, and the button says so.
#[test]
fn a_file_is_replaced_only_with_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.png");
    std::fs::write(&path, "mine").unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    send(&mut harness, Command::Save(OutputFormat::Png));
    harness.run_steps(2);
    assert!(harness.query_by_label("Replace").is_none());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_label("File name").type_text(path.to_str().unwrap());
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("exists and will be replaced").is_some());
    harness.get_by_label("Replace").click();
    let saved = format!("Saved {}", path.display());
    until(&mut harness, &saved, |window| window.messages().contains(&saved));
    assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(harness.state_mut().remembered_mut().directory.as_deref(), Some(directory.path()));
}

/// A picture that says nothing about how it was made is checked as a reader's own.
#[test]
fn a_picture_of_another_program_is_checked() {
    let directory = tempfile::tempdir().unwrap();
    let mut recipe = Stage::find("normals").unwrap().recipe();
    (recipe.settings.width, recipe.settings.height) = (160, 90);
    let mut progressive = Progressive::spawn().unwrap();
    let backend = weekender::backends::BackendChoice::Cpu(weekender::render_cpu::CpuOptions::default());
    progressive.start(RenderRequest::new(recipe.job().unwrap(), backend, Plan::samples(1)));
    progressive.wait_until_over();
    let mut rgb8 = progressive.finish().unwrap().to_rgb8(recipe.rules.transfer);
    for pixel in rgb8.chunks_exact_mut(3) {
        pixel.swap(0, 2);
    }
    let mut picture = b"P6\n160 90\n255\n".to_vec();
    picture.extend(rgb8);
    let path = directory.path().join("mine.ppm");
    std::fs::write(&path, picture).unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    until(&mut harness, "the finding", |window| window.finding().is_some());
    let words = harness.state().finding().unwrap().to_owned();
    assert!(words.contains("normals, section 6.1") && words.contains("a mistake: "), "{words}");
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("difference").is_some());
    harness.get_by_label("Close window").click();
    harness.run_steps(3);
    assert!(harness.state().finding().is_none());
}

#[test]
fn the_command_is_copied() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let copied = copied_command(&mut harness);
    assert!(
        copied.starts_with("weekender --batch --stage=glass-schlick --size=32x18 --samples="),
        "{copied}"
    );
}
