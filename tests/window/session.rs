//! What a window keeps for the next one: the film of a long render, and what it shows.

use crate::common::{has_samples, opened, save, send, until};
use eframe::App;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use weekender::app::{Command, Window};
use weekender::cli::{self, Request, WindowOptions};
use weekender::film::{Film, checkpoint};
use weekender::job::output::OutputFormat;

/// A picture that never ends by itself.
pub const ENDLESS: &str = "--stage glass-schlick --size 32x18 --samples 4000000000 --device cpu";

/// What is traced for longer than this is kept.
pub const SOON: Duration = Duration::from_millis(200);

pub fn options(arguments: &str, state: &Path, autosave_every: Duration) -> WindowOptions {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    let Request::Window(options) = cli::parse(words.map(Into::into)).unwrap() else { panic!("no window") };
    WindowOptions { state_directory: Some(state.to_owned()), autosave_every, ..*options }
}

/// A window of a user who knows the first steps.
pub fn kept_in(state: &Path, arguments: &str, every: Duration) -> Harness<'static, Window> {
    let mut window = Window::new(options(arguments, state, every)).unwrap();
    window.remembered_mut().first_steps.is_over = true;
    opened(window)
}

pub fn window(state: &Path, arguments: &str) -> Harness<'static, Window> {
    kept_in(state, arguments, SOON)
}

/// Closes the window as eframe does.
pub fn close(mut harness: Harness<'_, Window>) {
    harness.state_mut().on_exit(None);
}

/// The files of this ending, by name.
pub fn files(state: &Path, ending: &str) -> Vec<PathBuf> {
    // A folder of kept pictures comes and goes.
    let entries = fs::read_dir(state).into_iter().flatten().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|own| own == ending)).collect();
    files.sort();
    files
}

/// Draws frames until there is a film with its note.
pub fn until_film(harness: &mut Harness<'_, Window>, state: &Path) {
    until(harness, "a film", |_| {
        let notes = files(state, "json").into_iter().map(|path| fs::read_to_string(path).unwrap());
        files(state, "exr").len() == 1
            && notes.filter(|note| note.contains("\"has_film\": true")).count() == 1
    });
}

/// Draws frames until the card offers something.
pub fn until_offered(harness: &mut Harness<'_, Window>) {
    until(harness, "an offer", Window::has_offer);
    harness.run_steps(3);
}

fn film_of(path: &Path) -> Film {
    checkpoint::load(path).unwrap().film
}

/// Samples per pixel that the film held when the render began.
pub fn held(window: &Window) -> u64 {
    let added: u64 = window.status().contributions.iter().map(|part| part.samples_per_pixel).sum();
    window.status().samples_per_pixel.saturating_sub(added)
}

/// The film that this window saves, which must have the bits of an uninterrupted render.
fn assert_uninterrupted(harness: &mut Harness<'_, Window>, more_than: u64) {
    let directory = tempfile::tempdir().unwrap();
    let [mine, whole] = ["mine.exr", "whole.exr"].map(|name| directory.path().join(name));
    until(harness, "more samples", |window| window.status().samples_per_pixel > more_than);
    until(harness, "a film that goes on", |window| held(window) >= more_than);
    send(harness, Command::Pause);
    save(harness, Command::Save(OutputFormat::Exr), &mine);
    let mine = film_of(&mine);
    assert!(mine.sample_count() > more_than && mine.samples().iter().count() == 1);
    let mut other = crate::common::window(&ENDLESS.replace("4000000000", &mine.sample_count().to_string()));
    other.document_mut().clone_from(harness.state().document());
    other.document_mut().stop = weekender::progressive::Stop::at_samples(mine.sample_count());
    let mut other = opened(other);
    until(&mut other, "the end", has_samples(mine.sample_count()));
    save(&mut other, Command::Save(OutputFormat::Exr), &whole);
    assert!(mine == film_of(&whole));
}

#[test]
fn the_film_of_a_window_that_is_gone_is_offered_and_goes_on() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    // While it runs, nobody else touches its film.
    let mut beside = window(state.path(), ENDLESS);
    beside.run_steps(30);
    assert!(!beside.state().has_offer());
    close(beside);
    // The window does not end in order.
    drop(first);
    let [film] = files(state.path(), "exr")
        .into_iter()
        .filter(|path| !path.ends_with("session.exr"))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    let samples = film_of(&film).sample_count();

    let mut next = window(state.path(), "--stage metal --size 32x18");
    until_offered(&mut next);
    assert_eq!(next.state().document().stage().unwrap().id, "metal", "nothing is opened unasked");
    let about = format!("{samples} samples per pixel, 32x18, just now");
    assert!(next.query_by_label(&about).is_some(), "{about}");
    next.get_by_label_contains("Open 11.4").click();
    next.run_steps(2);
    until(&mut next, "the picture", |window| window.document().stage().unwrap().id == "glass-schlick");
    assert!(!next.state().has_offer());
    until(&mut next, "its samples", has_samples(samples));
    assert!(!film.exists(), "it is the next window's now");
    assert_uninterrupted(&mut next, samples);
}

#[test]
fn the_film_of_a_long_render_goes_on_in_the_next_window() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    let shown = first.state().status().samples_per_pixel;
    until(&mut first, "more samples", |window| window.status().samples_per_pixel > shown);
    close(first);
    let kept = state.path().join("session.exr");
    let samples = film_of(&kept).sample_count();
    assert!(samples > shown, "it is written once more at the end");
    let mut next = window(state.path(), "");
    assert!(!next.state().has_offer());
    let told = format!("Continuing with {samples} samples per pixel");
    until(&mut next, &told, |window| window.messages().contains(&told));
    assert_uninterrupted(&mut next, samples);
    assert!(next.state().messages().iter().all(|text| !text.contains("not")));
}

#[test]
fn changes_that_were_traced_for_seconds_are_offered_after_a_crash() {
    let state = tempfile::tempdir().unwrap();
    let long = Duration::from_secs(3600);
    let mut first = kept_in(state.path(), "--stage glass-schlick --size 64x36", long);
    until(&mut first, "a picture", has_samples(1));
    send(&mut first, Command::NextSphere);
    send(&mut first, Command::DeleteSphere);
    let mine = first.state().document().clone();
    assert!(mine.has_changed_scene());
    until(&mut first, "a note", |_| files(state.path(), "json").len() == 1);
    drop(first);
    let mut next = kept_in(state.path(), "--stage metal", long);
    until_offered(&mut next);
    assert!(next.query_by_label("changed camera, settings or spheres, just now").is_some());
    next.get_by_label_contains("Open 11.4").click();
    until(&mut next, "the picture", |window| window.document().has_changed_scene());
    assert!(next.state().document().job(1).unwrap() == mine.job(1).unwrap());
    assert_eq!(next.state().document().title(), mine.title());
    next.run_steps(3);
    assert!(!next.state().has_offer());
}
