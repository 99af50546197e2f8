//! Bookmarks as an animation: played, saved, stopped and continued.

use crate::harness::{control, has_samples, open, send, until};
use crate::questions::Ask as _;
use eframe::egui::{Key, Modifiers};
use egui_kittest::Harness;
use std::path::{Path, PathBuf};
use weekender::app::{Command, Window};
use weekender::cli::{self, Request};
use weekender::job::output::read_description;
use weekender::job::recipe::file;
use weekender::system::interrupt::Interrupt;

/// A window with this number of bookmarks.
fn bookmarked(count: usize) -> Harness<'static, Window> {
    let mut harness = open("--stage metal --size 32x18 --samples 2 --device cpu");
    for _ in 0..count {
        send(&mut harness, Command::AddBookmark);
        harness.state_mut().document_mut().camera.look_from.x += 0.5;
        harness.run_steps(90);
    }
    until(&mut harness, "a picture", has_samples(2));
    harness
}

#[test]
fn an_animation_is_played_and_leaves_no_trace() {
    for count in [0, 3] {
        let mut harness = bookmarked(count);
        let before = harness.state().shown_document().clone();
        let undone = harness.state().disabled_reason(Command::Undo).is_none();
        send(&mut harness, Command::Play);
        harness.run_steps(90);
        let during = harness.state().shown_document().camera;
        let path = before.path(before.frame_count());
        let is_on_path = |frame| path.camera(frame) == during;
        assert!(during != before.camera && (30..60).any(is_on_path), "{count}: {during:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(30);
        assert!(*harness.state().shown_document() == before, "{count}: stopped");
        send(&mut harness, Command::Play);
        harness.run_steps(300);
        assert!(*harness.state().shown_document() == before, "{count}: at its end");
        assert_eq!(harness.state().disabled_reason(Command::Undo).is_none(), undone);
        // Any command ends it first.
        send(&mut harness, Command::Play);
        harness.run_steps(30);
        send(&mut harness, Command::Fit);
        assert!(*harness.state().shown_document() == before, "{count}: ended by a command");
        assert_eq!(harness.state().disabled_reason(Command::Undo).is_none(), undone);
        // Who moves the camera has it.
        send(&mut harness, Command::Play);
        harness.run_steps(30);
        harness.state_mut().document_mut().camera.vfov_degrees = 33.0;
        harness.run_steps(30);
        assert_eq!(harness.state().shown_document().camera.vfov_degrees, 33.0);
    }
}

/// Saves an animation of so many frames in this folder.
fn save(harness: &mut Harness<'_, Window>, folder: &Path, frames: u32) {
    send(harness, Command::SaveAnimation);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    control(harness, "Name").type_text(folder.to_str().unwrap());
    harness.run_steps(2);
    control(harness, "Frames").set_value_accesskit(f64::from(frames));
    harness.run_steps(2);
    control(harness, "Save").click();
    harness.run_steps(2);
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn written(path: &Path) -> std::time::SystemTime {
    std::fs::metadata(path).unwrap().modified().unwrap()
}

#[test]
fn window_and_command_line_continue_frames() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, scene) = (directory.path().join("film"), directory.path().join("own.toml"));
    let mut harness = bookmarked(3);
    save(&mut harness, &folder, 5);
    let is_saved =
        |window: &Window| window.messages().contains(&format!("Saved 5 frames in {}", folder.display()));
    until(&mut harness, "the frames", is_saved);
    let names: Vec<_> =
        files(&folder).iter().map(|path| path.file_name().unwrap().display().to_string()).collect();
    assert_eq!(names, [0, 1, 2, 3, 4].map(|frame| format!("frame-000{frame}.png")));
    let document = harness.state().shown_document().clone();
    let frames: Vec<_> = document.keyframes.iter().map(|keyframe| keyframe.frame).collect();
    assert_eq!(frames, [0, 2, 4]);
    for (frame, path) in files(&folder).iter().enumerate() {
        let recipe = file::parse(read_description(path).unwrap().recipe(), "again").unwrap();
        assert_eq!(recipe.camera, document.path(5).camera(frame as u32), "{frame}");
    }
    // The same command of a saved scene finds all of them; what lacks is rendered.
    let before: Vec<_> = files(&folder).iter().map(|path| written(path)).collect();
    std::fs::write(&scene, file::to_toml(&document.recipe())).unwrap();
    std::fs::remove_file(folder.join("frame-0002.png")).unwrap();
    let words = format!(
        "weekender --batch --scene {} --frames 0..5 --samples 2 --out {} --device cpu",
        scene.display(),
        folder.display()
    );
    match cli::parse(words.split_whitespace().map(Into::into)).unwrap() {
        Request::Frames(options) => {
            let (interrupt, mut done) = (Interrupt::unheard(), Vec::new());
            weekender::batch::write_frames(&options, &interrupt, |count| done.push(count)).unwrap();
            assert_eq!(done, [0, 1, 2, 3, 4]);
        }
        other => panic!("{other:?}"),
    }
    let is_same = |(place, path): (usize, &PathBuf)| written(path) == before[place];
    let same: Vec<_> = files(&folder).iter().enumerate().map(is_same).collect();
    assert_eq!(same, [true, true, false, true, true]);
}

#[test]
fn stopped_animation_continues_when_saved_again() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path().join("turn");
    let mut harness = bookmarked(0);
    save(&mut harness, &folder, 400);
    until(&mut harness, "a frame", |_| folder.join("frame-0001.png").exists());
    send(&mut harness, Command::StopSaving);
    harness.run_steps(5);
    assert!(!harness.state().messages().iter().any(|text| text.contains("frames")));
    std::thread::sleep(std::time::Duration::from_millis(500));
    let done = files(&folder).len();
    assert!(done < 400, "{done}");
    let first = written(&folder.join("frame-0000.png"));
    save(&mut harness, &folder, 400);
    until(&mut harness, "more frames", |_| folder.join(format!("frame-{:04}.png", done + 1)).exists());
    assert_eq!(written(&folder.join("frame-0000.png")), first);
    // A second one has to wait.
    save(&mut harness, &directory.path().join("other"), 3);
    let told = harness.state().messages();
    assert!(told.iter().any(|text| text.starts_with("Not saved: ")), "{told:?}");
    send(&mut harness, Command::StopSaving);
}

#[test]
fn keyframes_of_a_scene_file_are_bookmarks() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("own.toml");
    let document = bookmarked(3).state().shown_document().clone();
    std::fs::write(&path, file::to_toml(&document.recipe())).unwrap();
    let mut harness = open(&format!("{} --device cpu", path.display()));
    assert_eq!(harness.state().shown_document().keyframes, document.keyframes);
    send(&mut harness, Command::Bookmark(1));
    assert_eq!(harness.state().shown_document().camera, document.keyframes[1].camera);
}
