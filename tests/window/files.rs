//! Saving, opening and dropping.

use crate::harness::{SMALL, control, drop_file, has_samples, name_file, open, save, says, send, until};
use crate::questions::Ask as _;
use eframe::egui::{self, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;
use weekender::app::{Command, Window};
use weekender::job::output::{OutputFormat, read_description};
use weekender::job::recipe::file;
use weekender::progressive::{Plan, Progressive, RenderRequest, Stop};
use weekender::stages::Stage;

/// The pixels of a render of a file's recipe, with the number of samples that the file states.
fn rendered_again(path: &Path) -> Vec<u8> {
    let description = read_description(path).unwrap();
    let recipe = file::parse(description.recipe(), "again").unwrap();
    let samples = description.get("Samples").unwrap().parse().unwrap();
    let mut progressive = Progressive::spawn().unwrap();
    let job = recipe.job().unwrap();
    let backend = weekender::backends::BackendChoice::Cpu(weekender::render_cpu::CpuOptions::default());
    progressive.start(RenderRequest::new(job, backend, Plan::samples(samples)));
    progressive.wait_until_over();
    progressive.take_film().unwrap().to_rgb8(recipe.rules.transfer)
}

#[test]
fn saved_files_open_again_and_keep_other_stages() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open("--stage defocus --size 48x27 --samples 40");
    harness.state_mut().document_mut().camera.vfov_degrees = 31.0;
    harness.run_steps(2);
    until(&mut harness, "the end", has_samples(40));
    let shown = harness.state().shown_document().clone();
    for format in [OutputFormat::Png, OutputFormat::Exr] {
        let path = directory.path().join(format!("saved{}", format.ending()));
        save(&mut harness, Command::Save, &path);
        if format != OutputFormat::Exr {
            let pixels = image::open(&path).unwrap().to_rgb8().into_raw();
            assert!(pixels == rendered_again(&path), "{format:?} differs from a render of its recipe");
        }
        // The next stages keep the user's own stop condition, but not that of a file.
        send(&mut harness, Command::Stage(Stage::find("metal").unwrap()));
        let own = Stop { noise: Some(0.05), ..Stop::default() };
        harness.state_mut().document_mut().stop = own;
        harness.run_steps(2);
        drop_file(&mut harness, &path);
        let opened = format!("Opened saved{}", format.ending());
        until(&mut harness, &opened, says(&opened));
        let document = harness.state().shown_document();
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
        send(&mut harness, Command::PreviousStage);
        let document = harness.state().shown_document();
        assert_eq!(document.stop, own, "{format:?}");
        assert!(!document.has_own_size, "{format:?}");
        send(&mut harness, Command::Stage(Stage::find("defocus").unwrap()));
        harness.state_mut().document_mut().clone_from(&shown);
        until(&mut harness, "the end", has_samples(40));
    }
}

#[test]
fn failures_are_reported_and_the_picture_stays() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    for (name, content, told) in [
        ("missing.png", None, "Not opened: "),
        ("notes.txt", Some("nothing of the kind"), "notes.txt is not a picture"),
        ("broken.toml", Some("[camera"), "broken.toml"),
        ("broken.exr", Some("nothing"), "broken.exr"),
    ] {
        let path = directory.path().join(name);
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        drop_file(&mut harness, &path);
        until(&mut harness, told, says(told));
    }
    assert_eq!(harness.state().shown_document().stage().unwrap().id, "glass-schlick");
    name_file(&mut harness, Command::Save, &directory.path().join("notes.txt/place.png"));
    until(&mut harness, "a failure", says("Not saved: "));
    assert!(harness.state_mut().remembered_mut().recent.is_empty(), "the next dialog does not start there");
}

#[test]
fn enter_never_replaces_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mine.png");
    std::fs::write(&path, "mine").unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    send(&mut harness, Command::Save);
    assert!(harness.query_by_label("Replace").is_none());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(&harness, "Name").type_text(path.to_str().unwrap());
    harness.run_steps(3);
    harness.key_press(Key::Enter);
    until(&mut harness, "another file", says("Saved mine 2.png"));
    assert!(std::fs::read(&path).unwrap() == b"mine" && directory.path().join("mine 2.png").exists());
    name_file(&mut harness, Command::Save, &path);
    until(&mut harness, "a third one", says("Saved mine 3.png"));

    send(&mut harness, Command::Save);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(&harness, "Name").type_text(path.to_str().unwrap());
    harness.run_steps(3);
    harness.get_by_label("Replace").click();
    until(&mut harness, "the file", says("Saved mine.png"));
    assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"));
    assert_eq!(harness.state_mut().remembered_mut().recent[0], path);
}

/// The window's answer to a request to close it.
fn close(harness: &mut Harness<'_, Window>) -> Vec<egui::ViewportCommand> {
    let root = harness.input_mut().viewports.get_mut(&egui::ViewportId::ROOT).unwrap();
    root.events.push(egui::ViewportEvent::Close);
    harness.step();
    let commands = harness.output().viewport_output[&egui::ViewportId::ROOT].commands.clone();
    let root = harness.input_mut().viewports.get_mut(&egui::ViewportId::ROOT).unwrap();
    root.events.clear();
    commands
}

#[test]
fn a_window_that_is_closed_ends_its_saves_first() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("large.png");
    let mut harness = open("--stage defocus --size 48x27 --samples 64 --device cpu");
    until(&mut harness, "the end", has_samples(64));
    assert!(!close(&mut harness).contains(&egui::ViewportCommand::CancelClose), "nothing is lost");
    send(&mut harness, Command::Save);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(&harness, "Name").type_text(path.to_str().unwrap());
    control(&harness, "As in the book").click_accesskit();
    harness.run_steps(3);
    control(&harness, "Save").click();
    harness.run_steps(2);
    assert!(!path.exists(), "it was ready before it could be asked about");
    assert!(close(&mut harness).contains(&egui::ViewportCommand::CancelClose));
    let begin = std::time::Instant::now();
    loop {
        harness.step();
        let commands = &harness.output().viewport_output[&egui::ViewportId::ROOT].commands;
        if commands.contains(&egui::ViewportCommand::Close) {
            break;
        }
        assert!(begin.elapsed().as_secs() < 180, "{:?}", harness.state().messages());
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    assert!(image::open(&path).is_ok());
}

/// A button in a message does what it offers.
#[test]
fn undo_offer_ends_with_the_next_change() {
    let mut harness = open("--stage metal --size 32x18 --device cpu");
    harness.state_mut().document_mut().camera.vfov_degrees = 31.0;
    harness.run_steps(3);
    harness.key_press(Key::PageDown);
    harness.run_steps(3);
    assert!(says("kept in Undo")(harness.state()), "{:?}", harness.state().messages());
    assert_ne!(harness.state().shown_document().stage().unwrap().id, "metal");
    send(&mut harness, Command::Undo);
    let document = harness.state().shown_document();
    assert_eq!((document.stage().unwrap().id, document.camera.vfov_degrees), ("metal", 31.0));
    harness.run_steps(2);
    let document = harness.state().shown_document();
    assert_eq!((document.stage().unwrap().id, document.camera.vfov_degrees), ("metal", 31.0));
    assert!(!says("kept in Undo")(harness.state()), "{:?}", harness.state().messages());
    assert!(says("Undone: ")(harness.state()));
    harness.state_mut().document_mut().camera.vfov_degrees = 51.0;
    harness.run_steps(3);
    assert!(!says("Undone: ")(harness.state()), "{:?}", harness.state().messages());
}

#[test]
fn saving_at_another_size_renders_in_the_background() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("large.png");
    let mut harness = open("--stage defocus --size 48x27 --samples 6");
    until(&mut harness, "the end", has_samples(6));
    let run = harness.state().status().run;
    send(&mut harness, Command::Save);
    control(&harness, "Twice as large").click_accesskit();
    harness.run_steps(3);
    control(&harness, "Name").focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(&harness, "Name").type_text(path.to_str().unwrap());
    harness.run_steps(2);
    control(&harness, "Save").click();
    until(&mut harness, "the file", |_| path.exists());
    let read = image::open(&path).unwrap();
    assert_eq!([read.width(), read.height()], [96, 54]);
    assert_eq!(read_description(&path).unwrap().get("Samples"), Some("6"));
    assert_eq!(harness.state().status().run, run, "the picture on the screen continues");
}
