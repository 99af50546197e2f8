//! State that the next window takes over: settings, edits and films.

use crate::harness::{control, has_samples, opened, says, send, sized, until};
use crate::questions::Ask as _;
use crate::right::{drop_picture, gradient, until_compared};
use eframe::{App, Storage};
use egui_kittest::Harness;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Duration;
use weekender::app::{Command, Device, Dock, Show, Theme, Window};
use weekender::cli::{self, Request, WindowOptions};
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

/// Makes the film one that was traced for a minute.
fn make_long(harness: &mut Harness<'_, Window>) {
    harness.state_mut().tracing.main.seconds_before = Some(60.0);
}

/// The window ends as if it were killed after its first seconds.
fn kill(mut harness: Harness<'_, Window>, state: &Path) {
    for _ in 0..2 {
        harness.run_steps(2);
        until(&mut harness, "no edits to write", |window| !window.store.edits.is_open());
    }
    drop(harness);
    std::fs::write(state.join("window.lock"), "").unwrap();
}

fn films(state: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(state.join("films")).into_iter().flatten();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "exr")).collect()
}

fn angle(window: &Window) -> f64 {
    window.shown_document().camera.vfov_degrees
}

#[test]
fn the_last_picture_comes_back_with_its_samples() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
    until(&mut first, "the end", has_samples(40));
    make_long(&mut first);
    // Another window at the same time keeps its films, too, but not its edits.
    let mut second = window("--stage metal --size 32x18 --samples 4", state.path(), 3600);
    until(&mut second, "the end", has_samples(4));
    make_long(&mut second);
    second.state_mut().on_exit(None);
    first.state_mut().on_exit(None);
    drop((first, second));
    assert_eq!(films(state.path()).len(), 2);

    let mut next = window("--device cpu", state.path(), 3600);
    until(&mut next, "its samples", |window| held(window) == 40);
    let document = next.state().shown_document();
    assert_eq!((document.stage().unwrap().id, document.camera.vfov_degrees), ("glass-schlick", 31.0));
    assert_eq!((document.stop, document.size()), (Stop::at_samples(40), [32, 18]));
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
    make_long(&mut first);
    let _checked = drop_picture(&mut first, &gradient(false));
    until_compared(&mut first);
    assert_ne!(first.state().shown_document().stage().unwrap().id, "glass-schlick");
    first.state_mut().on_exit(None);
    drop(first);
    let mut next = window("--device cpu", state.path(), 3600);
    until(&mut next, "its samples", |window| held(window) == 40);
    assert_eq!(angle(next.state()), 31.0);
}

/// Whichever was shown last. What took less than ten seconds is not kept.
#[test]
fn the_films_of_several_pictures_are_there_in_the_next_window() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
    for (degrees, samples) in [(31.0, 40), (41.0, 24), (51.0, 16)] {
        let document = first.state_mut().document_mut();
        (document.camera.vfov_degrees, document.stop) = (degrees, Stop::at_samples(samples));
        first.run_steps(30);
        until(&mut first, "the end", |window| {
            has_samples(samples)(window) && window.status().phase.is_over()
        });
        if degrees < 50.0 {
            make_long(&mut first);
        }
    }
    first.state_mut().on_exit(None);
    drop(first);
    assert_eq!(films(state.path()).len(), 2);
    let mut next = window("--device cpu", state.path(), 3600);
    for (degrees, samples) in [(31.0, 40), (41.0, 24)] {
        let document = next.state_mut().document_mut();
        (document.camera.vfov_degrees, document.stop) = (degrees, Stop::at_samples(1));
        until(&mut next, "its samples", |window| angle(window) == degrees && held(window) == samples);
    }
    // A restart throws them away.
    send(&mut next, Command::Restart);
    until(&mut next, "new samples", |window| held(window) == 0 && has_samples(1)(window));
    until(&mut next, "one film less", |_| films(state.path()).len() == 1);
    send(&mut next, Command::DeleteFilms);
    until(&mut next, "no film", |_| films(state.path()).is_empty());
}

/// Pictures are left for others, for a moment, and with their window. Each goes on where it was.
#[test]
fn no_film_is_lost_on_a_walk_through_pictures_and_windows() {
    let state = tempfile::tempdir().unwrap();
    let mut harness = window(&format!("{PICTURE} --samples 1"), state.path(), 3600);
    let (mut samples, mut random) = ([0_u64; 4], 7_u32);
    for step in 0..24 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (place, way) = ((random >> 24) as usize % 4, (random >> 16) % 3);
        let degrees = 40.0 + place as f64;
        // What it had is there again, and then it has more.
        for (stop, expected) in [(1, samples[place].max(1)), (samples[place] + 8, samples[place] + 8)] {
            let document = harness.state_mut().document_mut();
            (document.camera.vfov_degrees, document.stop) = (degrees, Stop::at_samples(stop));
            until(&mut harness, &format!("step {step}, {expected} samples"), |window| {
                let count = window.status().samples_per_pixel;
                angle(window) == degrees && count.max(1) == expected && window.status().phase.is_over()
            });
        }
        samples[place] += 8;
        make_long(&mut harness);
        match way {
            0 => {
                harness.state_mut().on_exit(None);
                drop(harness);
                harness = window("--device cpu", state.path(), 3600);
            }
            1 => [Command::NextStage, Command::Undo].into_iter().for_each(|there| send(&mut harness, there)),
            _ => {}
        }
    }
    assert!(samples.iter().all(|count| *count > 8), "{samples:?}");
    assert_eq!(films(state.path()).len(), 4);
}

/// A window of another size shows it scaled.
#[test]
fn a_film_comes_back_into_a_window_of_another_size() {
    let state = tempfile::tempdir().unwrap();
    let options = |words: &str| options(words, Some(state.path()), Duration::from_secs(3600));
    let mut first =
        sized(Window::new(options("--stage metal --samples 4 --device cpu")).unwrap(), [700.0, 500.0]);
    until(&mut first, "the end", |window| has_samples(4)(window) && window.status().phase.is_over());
    make_long(&mut first);
    let size = first.state().shown_document().size();
    first.state_mut().on_exit(None);
    drop(first);
    let mut next = sized(Window::new(options("--device cpu")).unwrap(), [900.0, 700.0]);
    until(&mut next, "its samples", |window| held(window) == 4 && window.shown_document().size() == size);
    send(&mut next, Command::RenderAtSize);
    until(&mut next, "another size", |window| window.shown_document().size() != size);
    until(&mut next, "its picture", has_samples(1));
    assert_eq!(held(next.state()), 0);
}

#[test]
fn window_that_ended_early_resumes_its_film() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 0);
    until(&mut first, "the end", has_samples(40));
    make_long(&mut first);
    until(&mut first, "a film", |_| !films(state.path()).is_empty());
    kill(first, state.path());

    // It waits, whatever other windows do.
    let mut other = window("--stage metal --size 32x18 --samples 4 --device cpu", state.path(), 0);
    until(&mut other, "the end", has_samples(4));
    make_long(&mut other);
    until(&mut other, "a film of its own", |_| films(state.path()).len() == 2);
    send(&mut other, Command::Undo);
    let is_back = |window: &Window| angle(window) == 31.0 && held(window) == 40;
    until(&mut other, "the picture and its samples", is_back);
    kill(other, state.path());
    let mut next = window("--device cpu", state.path(), 3600);
    assert_eq!(angle(next.state()), 31.0);
    assert!(says("ended early")(next.state()), "{:?}", next.state().messages());
    until(&mut next, "its samples", is_back);
}

#[test]
fn a_window_that_ended_at_once_is_not_restored_but_offered() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(PICTURE, state.path(), 3600);
    until(&mut first, "edits", |_| state.path().join("edits.json").exists());
    drop(first);
    let mut next = window("--device cpu", state.path(), 3600);
    assert_ne!(next.state().shown_document().stage().unwrap().id, "glass-schlick");
    assert!(says("ended soon")(next.state()), "{:?}", next.state().messages());
    control(&next, "Undo").click();
    next.run_steps(3);
    assert_eq!((angle(next.state()), next.state().messages().len()), (31.0, 1));
    next.state_mut().on_exit(None);
    drop(next);
    assert_eq!(angle(window("--device cpu", state.path(), 3600).state()), 31.0, "it ended in order");
}

#[test]
fn a_panic_saves_the_film() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(&format!("{PICTURE} --samples 40"), state.path(), 3600);
    until(&mut first, "the end", has_samples(40));
    make_long(&mut first);
    let panicked = catch_unwind(AssertUnwindSafe(move || {
        let _window = first;
        panic!("a slip of the window");
    }));
    assert!(panicked.is_err());
    assert!(state.path().join("window.lock").exists(), "it did not end in order");
    let mut next = window("--device cpu", state.path(), 3600);
    send(&mut next, Command::Undo);
    until(&mut next, "its samples", |window| angle(window) == 31.0 && held(window) == 40);
}

#[test]
fn last_edits_come_back_with_their_history() {
    let state = tempfile::tempdir().unwrap();
    let edits = state.path().join("edits.json");
    let mut first = window(PICTURE, state.path(), 3600);
    until(&mut first, "edits", |_| edits.exists());
    kill(first, state.path());

    // Also those from before a picture that was asked for.
    let mut second = window("--stage metal --size 32x18 --device cpu", state.path(), 3600);
    let count = |harness: &Harness<'_, Window>| harness.state().shown_document().scene().spheres.len();
    let before = count(&second);
    send(&mut second, Command::AddSphere);
    second.run_steps(30);
    second.state_mut().document_mut().camera.vfov_degrees = 77.0;
    second.run_steps(30);
    until(&mut second, "the edits", |_| std::fs::read_to_string(&edits).unwrap().contains("77.0"));
    kill(second, state.path());

    let mut third = window("--device cpu", state.path(), 3600);
    assert_eq!(third.state().shown_document().stage().unwrap().id, "metal");
    assert_eq!((count(&third), angle(third.state())), (before + 1, 77.0));
    send(&mut third, Command::Undo);
    assert!(count(&third) == before + 1 && angle(third.state()) != 77.0);
    send(&mut third, Command::Undo);
    assert_eq!(count(&third), before);
    send(&mut third, Command::Undo);
    assert_eq!(third.state().shown_document().stage().unwrap().id, "glass-schlick");
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

/// Rendering continues meanwhile. What is obstructed is the folder of the films, then the file of the edits.
#[test]
fn what_could_not_be_written_is_said_and_tried_again() {
    let state = tempfile::tempdir().unwrap();
    let (folder, edits) = (state.path().join("films"), state.path().join("edits.json"));
    std::fs::write(&folder, "").unwrap();
    let mut harness = window(&format!("{PICTURE} --samples 40"), state.path(), 0);
    make_long(&mut harness);
    until(&mut harness, "the end", |window| {
        window.status().phase.is_over() && says("Film not kept: ")(window)
    });
    std::fs::remove_file(&folder).unwrap();
    until(&mut harness, "the film", |window| {
        films(state.path()).len() == 1 && !says("Film not kept")(window)
    });

    std::fs::remove_file(&edits).unwrap();
    std::fs::create_dir_all(edits.join("full")).unwrap();
    harness.state_mut().document_mut().camera.vfov_degrees = 77.0;
    until(&mut harness, "a failure", says("Edits not kept: "));
    std::fs::remove_dir_all(&edits).unwrap();
    until(&mut harness, "the edits", |window| {
        let text = std::fs::read_to_string(&edits).unwrap_or_default();
        text.contains("77.0") && !says("Edits not kept")(window)
    });
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
    let kept = harness.state_mut().remembered_mut().clone();
    harness.state_mut().save(&mut stored);
    assert_eq!((kept.theme, kept.dock, kept.hides_info), (Theme::Light, Some(Dock::Error), true));
    assert_eq!(kept.device, Device::Reference);
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
