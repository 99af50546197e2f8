//! State that the next window takes over: settings, and the autosaved film.

use crate::harness::{has_samples, opened, says, send, until};
use crate::questions::Ask as _;
use crate::right::{drop_picture, gradient, until_compared};
use eframe::{App, Storage};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Duration;
use weekender::app::{Command, Device, Dock, Show, Theme, Window};
use weekender::cli::{self, Request, WindowOptions};
use weekender::film::{checkpoint, key};
use weekender::progressive::Stop;
use weekender::stages::{Means, Stage};

const PICTURE: &str = "--stage glass-schlick --size 32x18 --device cpu --vfov 31";

fn options(arguments: &str, state: Option<&Path>, every: Duration) -> WindowOptions {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    let Request::Window(options) = cli::parse(words.map(Into::into)).unwrap() else { panic!("no window") };
    WindowOptions { state_directory: state.map(Path::to_owned), autosave_every: every, ..*options }
}

fn window(arguments: &str, state: &Path, every: u64) -> Harness<'static, Window> {
    opened(Window::new(options(arguments, Some(state), Duration::from_secs(every))).unwrap())
}

/// Samples per pixel that the film held when the render began.
pub fn held(window: &Window) -> u64 {
    let added: u64 = window.status().contributions.iter().map(|part| part.samples_per_pixel).sum();
    window.status().samples_per_pixel.saturating_sub(added)
}

fn has_offer(harness: &Harness<'_, Window>) -> bool {
    harness.query_by_label("Resume").is_some()
}

#[test]
fn the_last_picture_comes_back_with_its_samples() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
    until(&mut first, "the end", has_samples(40));
    // Another window at the same time saves nothing.
    let mut second = window("--stage metal --size 32x18 --samples 4", state.path(), 0);
    until(&mut second, "the end", has_samples(4));
    second.run_steps(3);
    second.state_mut().on_exit(None);
    first.state_mut().on_exit(None);
    drop((first, second));

    let mut next = window("--device cpu", state.path(), 3600);
    until(&mut next, "its samples", |window| held(window) == 40);
    let document = next.state().shown_document();
    assert_eq!((document.stage().unwrap().id, document.camera.vfov_degrees), ("glass-schlick", 31.0));
    assert_eq!((document.stop, document.size()), (Stop::at_samples(40), [32, 18]));
    assert!(!has_offer(&next));
    // The stop was this picture's alone.
    send(&mut next, Command::NextStage);
    assert_eq!(next.state().shown_document().stop.samples, None);
    drop(next);
    let fresh = window("--device cpu --fresh", state.path(), 3600);
    assert_ne!(fresh.state().shown_document().stage().unwrap().id, "glass-schlick");
}

#[test]
fn the_picture_before_a_check_comes_back_with_its_samples() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
    until(&mut first, "the end", has_samples(40));
    let _checked = drop_picture(&mut first, &gradient(false));
    until_compared(&mut first);
    assert_ne!(first.state().shown_document().stage().unwrap().id, "glass-schlick");
    first.state_mut().on_exit(None);
    drop(first);
    let mut next = window("--device cpu", state.path(), 3600);
    until(&mut next, "its samples", |window| held(window) == 40);
    assert_eq!(next.state().shown_document().camera.vfov_degrees, 31.0);
}

/// Another picture that is opened next must not replace it.
#[test]
fn a_long_film_is_offered_to_the_next_window() {
    for (seconds, is_offered) in [(59, false), (61, true)] {
        let state = tempfile::tempdir().unwrap();
        let film = state.path().join("autosave.exr");
        let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
        until(&mut first, "the end", has_samples(40));
        first.state_mut().on_exit(None);
        drop(first);
        let saved = checkpoint::load(&film).unwrap();
        let mut description = saved.description;
        description.set(key::SECONDS, seconds);
        checkpoint::save(&film, &saved.film, &description).unwrap();
        let next = window("--stage metal --size 32x18 --device cpu", state.path(), 3600);
        assert_eq!(has_offer(&next), is_offered, "{seconds}");
    }
}

#[test]
fn window_that_ended_early_resumes_its_film() {
    let state = tempfile::tempdir().unwrap();
    let film = state.path().join("autosave.exr");
    let mut first = window(&format!("{PICTURE} --samples 4000000000"), state.path(), 0);
    until(&mut first, "a film", |_| film.exists());
    // Not in order.
    drop(first);
    let samples = checkpoint::load(&film).unwrap().film.sample_count();

    let mut next = window("--device cpu", state.path(), 3600);
    assert_eq!(next.state().shown_document().camera.vfov_degrees, 31.0);
    assert!(says("ended early")(next.state()) && !has_offer(&next), "{:?}", next.state().messages());
    until(&mut next, "its samples", |window| held(window) == samples);
    drop(next);

    // It waits for an answer, whatever other windows do.
    for _ in 0..2 {
        let mut other = window("--stage metal --size 32x18 --device cpu", state.path(), 0);
        assert!(has_offer(&other));
        until(&mut other, "a film of its own", |_| film.exists());
        other.state_mut().on_exit(None);
    }
    let mut last = window("--device cpu", state.path(), 3600);
    last.get_by_label("Resume").click();
    // The other picture may have as many samples.
    let is_back = |window: &Window| window.shown_document().camera.vfov_degrees == 31.0;
    until(&mut last, "the picture and its samples", |window| is_back(window) && held(window) == samples);
    last.state_mut().on_exit(None);
    drop(last);
    assert!(!has_offer(&window("--device cpu", state.path(), 3600)), "the user has answered");
}

#[test]
fn a_panic_saves_the_film() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 4000000000"), state.path(), 3600);
    until(&mut first, "samples", has_samples(16));
    let samples = first.state().status().samples_per_pixel;
    let panicked = catch_unwind(AssertUnwindSafe(move || {
        let _window = first;
        panic!("a slip of the window");
    }));
    assert!(panicked.is_err());
    let mut next = window("--device cpu", state.path(), 3600);
    assert!(says("ended early")(next.state()), "{:?}", next.state().messages());
    until(&mut next, "its samples", |window| held(window) >= samples);
}

/// A film of another picture that was saved earlier does not come in its place.
#[test]
fn last_edits_come_back_with_their_history() {
    let state = tempfile::tempdir().unwrap();
    let film = state.path().join("autosave.exr");
    let mut first = window(&format!("{PICTURE} --samples 4000000000"), state.path(), 0);
    until(&mut first, "a film", |_| film.exists());
    drop(first);

    let mut second = window("--device cpu", state.path(), 3600);
    let count = |harness: &Harness<'_, Window>| harness.state().shown_document().scene().spheres.len();
    send(&mut second, Command::Stage(Stage::find("metal").unwrap()));
    let before = count(&second);
    send(&mut second, Command::AddSphere);
    second.run_steps(30);
    second.state_mut().document_mut().camera.vfov_degrees = 77.0;
    second.run_steps(30);
    let edits = state.path().join("edits.json");
    until(&mut second, "the edits", |_| std::fs::read_to_string(&edits).unwrap().contains("77.0"));
    drop(second);

    let mut third = window("--device cpu", state.path(), 3600);
    let angle = |harness: &Harness<'_, Window>| harness.state().shown_document().camera.vfov_degrees;
    assert_eq!(third.state().shown_document().stage().unwrap().id, "metal");
    assert_eq!((count(&third), angle(&third)), (before + 1, 77.0));
    assert!(has_offer(&third), "the film, which is another picture's");
    send(&mut third, Command::Undo);
    assert!(count(&third) == before + 1 && angle(&third) != 77.0);
    send(&mut third, Command::Undo);
    assert_eq!(count(&third), before);
    send(&mut third, Command::Undo);
    assert_eq!(third.state().shown_document().stage().unwrap().id, "glass-schlick");
    third.get_by_label("Delete it").click();
    third.run_steps(3);
    third.state_mut().on_exit(None);
    drop(third);
    let left = std::fs::read_dir(state.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let left: Vec<_> = left.filter(|name| name.to_str().unwrap().starts_with("recovered")).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// In order or not, and whatever was on the screen: the next window has a title bar.
#[test]
fn no_window_begins_in_full_screen() {
    let mut stored = Stored::default();
    stored.set_string("window", "(fullscreen:true,maximized:false)".to_owned());
    remembering("--stage metal --size 16x9", &stored).state_mut().save(&mut stored);
    assert_eq!(stored.get_string("window").unwrap(), "(fullscreen:false,maximized:false)");
}

#[test]
fn what_show_me_shows_is_not_remembered() {
    let mut stored = Stored::default();
    let sky = Stage::ALL.iter().find(|stage| matches!(stage.sight.means, Means::Luminance(_))).unwrap();
    let mut harness = remembering(&format!("--stage {}", sky.id), &stored);
    send(&mut harness, Command::ShowMe);
    assert_eq!(harness.state().show(), Show::Luminance);
    harness.state_mut().save(&mut stored);
    assert_eq!(remembering("--device cpu", &stored).state().show(), Show::Picture);
}

#[test]
fn failed_autosave_is_reported_and_rendering_continues() {
    let state = tempfile::tempdir().unwrap();
    // Nothing can be written where a folder is.
    std::fs::create_dir_all(state.path().join("autosave.exr/full")).unwrap();
    let mut harness = window(&format!("{PICTURE} --samples 4000000000"), state.path(), 0);
    let told = "Autosave failed: ";
    until(&mut harness, told, says(told));
    let samples = harness.state().status().samples_per_pixel;
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > samples);
}

/// The message says so. The program does not do it yet: it forgets that the last save failed.
#[test]
#[should_panic(expected = "was not tried again")]
fn a_failed_autosave_of_a_finished_film_is_tried_again() {
    let state = tempfile::tempdir().unwrap();
    let film = state.path().join("autosave.exr");
    std::fs::create_dir_all(film.join("full")).unwrap();
    let mut harness = window(&format!("{PICTURE} --samples 40"), state.path(), 0);
    let has_ended = |window: &Window| window.status().phase.is_over() && says("Autosave failed")(window);
    until(&mut harness, "the end", has_ended);
    let mut wait = || {
        for _ in 0..100 {
            std::thread::sleep(Duration::from_millis(5));
            harness.step();
        }
    };
    wait();
    std::fs::remove_dir_all(&film).unwrap();
    wait();
    assert!(film.is_file(), "it was not tried again");
}

#[derive(Default)]
struct Stored(HashMap<String, String>);

impl Storage for Stored {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

fn remembering(arguments: &str, stored: &Stored) -> Harness<'static, Window> {
    opened(Window::with(options(arguments, None, Duration::MAX), Some(stored)).unwrap())
}

#[test]
fn settings_of_the_same_version_are_remembered() {
    let mut stored = Stored::default();
    let mut harness = remembering("--stage metal --size 16x9", &stored);
    for command in [Command::Theme(Theme::Light), Command::ErrorDock, Command::Info, Command::Reference] {
        send(&mut harness, command);
    }
    send(&mut harness, Command::Show(Show::Luminance));
    harness.state_mut().remembered_mut().threads = Some(1);
    let kept = harness.state_mut().remembered_mut().clone();
    harness.state_mut().save(&mut stored);
    assert_eq!((kept.theme, kept.dock, kept.has_info), (Theme::Light, Some(Dock::Error), false));
    assert_eq!((kept.device, kept.threads), (Device::Reference, Some(1)));
    assert_eq!(remembering("--device cpu", &stored).state().show(), Show::Luminance);
    let mut again = remembering("--stage metal", &stored);
    assert_eq!(again.state().show(), Show::Picture, "a picture that was asked for is shown");
    assert_eq!(*again.state_mut().remembered_mut(), kept);
    let mut told = remembering("--stage metal --device cpu", &stored);
    assert_eq!(told.state_mut().remembered_mut().device, Device::Cpu, "flags override settings");

    for (from, to) in [("version:", "version:9"), ("version:", "damaged")] {
        let changed = stored.0.iter().map(|(key, value)| (key.clone(), value.replace(from, to)));
        let mut other = remembering("--stage metal", &Stored(changed.collect()));
        assert_eq!(other.state_mut().remembered_mut().theme, Theme::System, "{to}");
        assert!(other.state().messages().is_empty());
    }
}
