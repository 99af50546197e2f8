//! What a window keeps for the next one: the film of a long render, and what it shows.

use crate::common::{drag_from, has_samples, middle, opened, save, send, until};
use eframe::App;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use weekender::app::{Command, Show, Window};
use weekender::cli::{self, Request, WindowOptions};
use weekender::film::{Film, checkpoint};
use weekender::output::OutputFormat;

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
fn later_keeps_an_offer_and_discard_asks_once_more() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    drop(first);
    let mut next = kept_in(state.path(), ENDLESS, Duration::from_secs(3600));
    until_offered(&mut next);
    next.get_by_label("Close the recovered pictures").click();
    next.run_steps(3);
    assert!(!next.state().has_offer());
    drop(next);
    let mut next = kept_in(state.path(), ENDLESS, Duration::from_secs(3600));
    until_offered(&mut next);
    next.get_by_label_contains("Discard: 11.4").click();
    next.run_steps(3);
    assert!(next.state().has_offer() && files(state.path(), "exr").len() == 1, "not yet");
    next.get_by_label_contains("Discard for good: 11.4").click();
    next.run_steps(3);
    assert!(!next.state().has_offer());
    assert_eq!(files(state.path(), "exr"), <[PathBuf; 0]>::default());
}

#[test]
fn a_damaged_film_is_named_and_not_opened() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    drop(first);
    let [film] = files(state.path(), "exr").try_into().unwrap();
    let mut bytes = fs::read(&film).unwrap();
    let last = bytes.len() - 100;
    bytes[last] ^= 1;
    fs::write(&film, bytes).unwrap();
    let mut next = kept_in(state.path(), ENDLESS, Duration::from_secs(3600));
    until_offered(&mut next);
    next.get_by_label_contains("Open 11.4").click();
    let name = film.file_name().unwrap().to_str().unwrap();
    until(&mut next, "the fault", |window| {
        window.messages().iter().any(|text| text.starts_with("Not opened") && text.contains(name))
    });
    next.run_steps(3);
    assert!(next.state().has_offer() && film.exists(), "it is not lost silently");
    assert!(next.query_all_by_label_contains("is damaged").next().is_some());
    assert!(next.get_by_label_contains("Open 11.4").accesskit_node().is_disabled(), "it would fail again");
}

#[test]
fn a_short_render_leaves_no_film_and_its_picture_comes_back() {
    let state = tempfile::tempdir().unwrap();
    let long = Duration::from_secs(3600);
    let mut first = kept_in(state.path(), "--stage glass-schlick --size 64x36 --vfov 31 --samples 70", long);
    first.state_mut().document_mut().settings.seed = 5;
    let at = middle(&first);
    until(&mut first, "a picture", has_samples(1));
    drag_from(&mut first, at, eframe::egui::vec2(30.0, 10.0));
    send(&mut first, Command::Show(Show::Luminance));
    send(&mut first, Command::Brighter);
    let mine = first.state().document().clone();
    close(first);
    assert_eq!(files(state.path(), "exr"), <[PathBuf; 0]>::default());

    let mut next = kept_in(state.path(), "", long);
    let found = next.state().document();
    assert_eq!((found.title(), found.stop), (mine.title(), mine.stop));
    assert_eq!((found.camera, found.settings), (mine.camera, mine.settings));
    assert!(found.job(1).unwrap() == mine.job(1).unwrap());
    assert_eq!(next.state().show(), Show::Luminance);
    send(&mut next, Command::Undo);
    assert_eq!(next.state().document().camera, mine.camera, "there is nothing to undo");
    send(&mut next, Command::Fresh);
    assert_eq!(next.state().document().name(), "three-spheres");
    assert_eq!(next.state().show(), Show::Picture);
    close(next);
    // It was shown last.
    assert_eq!(kept_in(state.path(), "", long).state().document().name(), "three-spheres");
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
fn who_asks_for_a_picture_gets_it_and_the_film_of_the_session_is_not_lost() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    close(first);
    for arguments in ["--stage metal --size 32x18", "--scene book --size 32x18", "--fresh"] {
        let other = kept_in(state.path(), arguments, Duration::from_secs(3600));
        assert_ne!(other.state().document().name(), "glass-schlick", "{arguments}");
        assert!(state.path().join("session.exr").exists(), "{arguments}");
    }
    close(kept_in(state.path(), "--stage metal --size 32x18", Duration::from_secs(3600)));
    let mut next = window(state.path(), "");
    assert_eq!(next.state().document().stage().unwrap().id, "metal", "it was closed last");
    until_offered(&mut next);
    assert!(next.query_all_by_label_contains("Open 11.4").next().is_some());
}

#[test]
fn what_cannot_be_shown_again_is_said_and_the_usual_picture_opens() {
    let state = tempfile::tempdir().unwrap();
    let usual = crate::common::window("").document().name();
    for note in ["{", r#"{"software": "Weekender 9", "origin": {"Stage": "radiosity"}, "is_changed": true}"#]
    {
        fs::write(state.path().join("session.json"), note).unwrap();
        let next = window(state.path(), "");
        assert_eq!(next.state().document().name(), usual, "{note}");
        let said = next.state().messages();
        assert!(said.iter().any(|text| text.starts_with("What was shown last cannot")), "{note}: {said:?}");
        drop(next);
        // It is left as it is, and not tried at each start.
        let again = window(state.path(), "");
        assert!(again.state().messages().is_empty(), "{note}: {:?}", again.state().messages());
        drop(again);
        let [left] = files(state.path(), "json").try_into().unwrap();
        assert_eq!(fs::read_to_string(&left).unwrap(), note);
        fs::remove_file(left).unwrap();
    }
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

#[test]
fn a_film_is_not_written_before_its_time_and_a_place_that_cannot_be_is_said() {
    let state = tempfile::tempdir().unwrap();
    let mut short = kept_in(state.path(), ENDLESS, Duration::from_secs(3600));
    until(&mut short, "samples", has_samples(64));
    let begin = Instant::now();
    while begin.elapsed() < 2 * SOON {
        short.step();
    }
    assert_eq!(files(state.path(), "exr"), <[PathBuf; 0]>::default());
    close(short);
    assert_eq!(files(state.path(), "exr"), <[PathBuf; 0]>::default());
    let file = state.path().join("file");
    fs::write(&file, "").unwrap();
    let mut without = window(&file.join("deeper"), ENDLESS);
    let said = without.state().messages();
    assert!(said.iter().any(|text| text.starts_with("Nothing is autosaved")), "{said:?}");
    until(&mut without, "samples", has_samples(64));
    close(without);
}

#[test]
fn undo_brings_a_film_back_from_another_picture_but_not_after_a_new_start() {
    let state = tempfile::tempdir().unwrap();
    let mut harness = window(state.path(), ENDLESS);
    until_film(&mut harness, state.path());
    let [film] = files(state.path(), "exr").try_into().unwrap();
    // So many that no new film has more of them when the window looks.
    until(&mut harness, "samples", |_| film_of(&film).sample_count() > 20_000);
    // The window shows another picture for less than the film took.
    send(&mut harness, Command::NextStage);
    let samples = film_of(&film).sample_count();
    send(&mut harness, Command::Undo);
    let is_told = |window: &Window| window.messages().iter().any(|text| text.starts_with("Continuing with"));
    until(&mut harness, "the film", is_told);
    assert_uninterrupted(&mut harness, samples);
    send(&mut harness, Command::Restart);
    until(&mut harness, "a new film", |window| window.status().samples_per_pixel > 0);
    let begin = Instant::now();
    while begin.elapsed() < SOON / 2 {
        harness.step();
    }
    assert_eq!(held(harness.state()), 0, "it began without samples");
}

#[test]
fn what_is_opened_does_not_replace_the_film_of_the_picture_that_was_shown() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    drop(first);
    let mut next = window(state.path(), &ENDLESS.replace("glass-schlick", "metal"));
    until(&mut next, "its own film", |_| files(state.path(), "exr").len() == 2);
    until_offered(&mut next);
    next.run_steps(20);
    next.get_by_label_contains("Open 11.4").click();
    until(&mut next, "the picture", |window| window.document().stage().unwrap().id == "glass-schlick");
    next.run_steps(3);
    assert_eq!(files(state.path(), "exr").len(), 2);
    close(next);
    let mut last = window(state.path(), "--fresh");
    until_offered(&mut last);
    let metal = weekender::stages::Stage::find("metal").unwrap();
    let name = format!("Open {} {}", metal.section, metal.title);
    assert!(last.query_all_by_label_contains(&name).next().is_some(), "{name}");
}
