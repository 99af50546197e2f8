//! What a window does with what others have left: several offers, and what it closes over.

use crate::common::{has_samples, opened, save, send, until};
use crate::session::{
    ENDLESS, SOON, close, files, held, kept_in, options, until_film, until_offered, window,
};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use weekender::app::{Command, Window};
use weekender::film::{checkpoint, key};
use weekender::output::OutputFormat;
use weekender::recipe::file;
use weekender::stages::Stage;

const LONG: Duration = Duration::from_secs(3600);

/// Leaves a film as a window does that is killed.
fn leave_film(state: &Path, arguments: &str) {
    let mut harness = window(state, arguments);
    let before = files(state, "exr").len();
    if before == 0 {
        until_film(&mut harness, state);
    } else {
        until(&mut harness, "another film", |_| files(state, "exr").len() == before + 1);
    }
}

fn has(harness: &Harness<'_, Window>, label: &str) -> bool {
    harness.query_all_by_label_contains(label).next().is_some()
}

#[test]
fn each_of_several_offers_is_asked_about_by_itself() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), ENDLESS);
    leave_film(state.path(), &ENDLESS.replace("glass-schlick", "metal"));
    let [glass, metal] = ["glass-schlick", "metal"].map(|id| Stage::find(id).unwrap().section);
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    let top = |section: &str| next.get_by_label_contains(&format!("Discard: {section}")).rect().top();
    assert!(top(metal) < top(glass), "the newest is the first");
    for (section, left) in [(glass, 2), (metal, 2), (glass, 2), (glass, 1), (metal, 1), (metal, 0)] {
        next.get_by_label_contains(&format!(": {section}")).click();
        next.run_steps(3);
        assert_eq!(files(state.path(), "exr").len(), left, "{section}");
    }
    assert!(!next.state().has_offer());
}

#[test]
fn a_changed_picture_is_offered_once_with_its_film() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), &format!("{ENDLESS} --vfov 31"));
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    assert!(!has(&next, "changed camera"));
    next.get_by_label_contains("Open 11.4").click();
    until(&mut next, "the picture", |window| window.document().camera.vfov_degrees == 31.0);
    until(&mut next, "its samples", has_samples(1));
    next.run_steps(3);
    assert!(!next.state().has_offer(), "its note is not a second offer");
}

/// The only film that was left, and its samples per pixel.
fn left_film(state: &Path) -> (PathBuf, u64) {
    let [film] = files(state, "exr").try_into().unwrap();
    let samples = checkpoint::load(&film).unwrap().film.sample_count();
    (film, samples)
}

#[test]
fn a_film_is_opened_without_a_note_of_another_picture() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), ENDLESS);
    let (film, samples) = left_film(state.path());
    let note = film.with_extension("json");
    let text = fs::read_to_string(&note).unwrap().replace("glass-schlick", "metal");
    fs::write(&note, text.replace("\"is_changed\": false", "\"is_changed\": true")).unwrap();
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    assert!(!has(&next, "changed camera"));
    next.get_by_label_contains("Open 11.4").click();
    until(&mut next, "the picture", |window| window.document().stage().unwrap().id == "glass-schlick");
    until(&mut next, "its film", |window| held(window) == samples);
    next.run_steps(3);
    assert!(
        next.state().has_offer() && has(&next, "changed camera"),
        "the noted picture can still be opened"
    );
}

#[test]
fn a_film_that_cannot_be_moved_goes_on_and_stays_where_it_is() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), ENDLESS);
    let (film, samples) = left_film(state.path());
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    let locks = files(state.path(), "lock");
    let own = locks.iter().find(|lock| **lock != film.with_extension("lock")).unwrap();
    fs::create_dir_all(own.with_extension("exr").join("full")).unwrap();
    next.get_by_label_contains("Open 11.4").click();
    let told = format!("{} stays where it is: ", film.display());
    until(&mut next, &told, |window| window.messages().iter().any(|text| text.starts_with(&told)));
    until(&mut next, "its film", |window| held(window) == samples);
    assert!(film.exists());
}

#[test]
fn a_picture_under_the_name_of_a_film_is_not_opened() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), ENDLESS);
    let (film, _) = left_film(state.path());
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    until(&mut next, "a picture", has_samples(1));
    let picture = state.path().join("mine.png");
    save(&mut next, Command::Save(OutputFormat::Png), &picture);
    fs::copy(&picture, &film).unwrap();
    next.get_by_label_contains("Open 11.4").click();
    let told = format!("Not opened: {} holds no picture", film.display());
    until(&mut next, &told, |window| window.messages().contains(&told));
    assert_eq!(next.state().document().stage().unwrap().id, "sky");
}

#[test]
fn a_scene_whose_file_is_gone_is_shown_as_it_was() {
    let state = tempfile::tempdir().unwrap();
    let scene = state.path().join("mine.toml");
    fs::write(&scene, file::to_toml(&Stage::find("metal").unwrap().recipe())).unwrap();
    let arguments = format!("--scene {} --size 32x18 --samples 4 --device cpu", scene.display());
    let first = kept_in(&state.path().join("kept"), &arguments, LONG);
    let mine = first.state().document().job(1).unwrap();
    close(first);
    fs::remove_file(&scene).unwrap();
    let next = kept_in(&state.path().join("kept"), "", LONG);
    assert!(next.state().document().job(1).unwrap() == mine);
    let told = next.state().messages();
    assert!(told.iter().any(|text| text.ends_with("; this is the scene as it was")), "{told:?}");
}

#[test]
fn what_cannot_be_written_is_told_and_rendering_goes_on() {
    for (ending, told) in [("exr", "Not autosaved: "), ("json", "What this window shows is not kept: ")] {
        let state = tempfile::tempdir().unwrap();
        let window = Window::new(options(ENDLESS, state.path(), SOON)).unwrap();
        let [lock] = files(state.path(), "lock").try_into().unwrap();
        // Nothing can be written where a folder is.
        fs::create_dir_all(lock.with_extension(ending).join("full")).unwrap();
        let mut harness = opened(window);
        until(&mut harness, told, |window| window.messages().iter().any(|text| text.starts_with(told)));
        let samples = harness.state().status().samples_per_pixel;
        until(&mut harness, "more samples", |window| window.status().samples_per_pixel > samples);
    }
}

#[test]
fn a_window_that_is_closed_before_its_film_was_read_leaves_it_with_its_picture() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    close(first);
    Window::new(options("", state.path(), SOON)).unwrap().end_in_order();
    assert!(state.path().join("session.exr").exists());
    let note = fs::read_to_string(state.path().join("session.json")).unwrap();
    assert!(note.contains("\"has_film\": true"), "{note}");
}

#[test]
fn who_changes_the_picture_before_its_film_was_read_is_offered_the_film() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    close(first);
    let samples = checkpoint::load(&state.path().join("session.exr")).unwrap().film.sample_count();
    // The reading has not even begun.
    let mut next = Window::new(options("", state.path(), SOON)).unwrap();
    next.document_mut().camera.vfov_degrees = 33.0;
    next.end_in_order();
    drop(next);
    let mut last = kept_in(state.path(), "", LONG);
    assert_eq!(last.state().document().camera.vfov_degrees, 33.0);
    until_offered(&mut last);
    assert!(has(&last, &format!("{samples} samples per pixel, 32x18")));
    let told = last.state().messages();
    assert!(told.iter().all(|text| !text.contains("not continued")), "{told:?}");
}

#[test]
fn a_film_whose_seconds_nobody_knows_is_kept() {
    let state = tempfile::tempdir().unwrap();
    let path = state.path().join("mine.exr");
    let arguments = "--stage glass-schlick --size 32x18 --device cpu --samples 4";
    let mut first = kept_in(&state.path().join("first"), arguments, LONG);
    until(&mut first, "the end", has_samples(4));
    save(&mut first, Command::Save(OutputFormat::Exr), &path);
    let mut file = checkpoint::load(&path).unwrap();
    file.description.set(key::SECONDS, "unknown");
    checkpoint::save(&path, &file.film, &file.description).unwrap();
    let state = state.path().join("second");
    let mut next = kept_in(&state, &format!("--resume {} --samples 4", path.display()), LONG);
    until(&mut next, "its samples", has_samples(4));
    close(next);
    assert!(state.join("session.exr").exists(), "it may have taken days");
}

#[test]
fn a_paused_render_is_paused_in_the_next_window() {
    let state = tempfile::tempdir().unwrap();
    let mut first = kept_in(state.path(), ENDLESS, LONG);
    until(&mut first, "samples", has_samples(1));
    send(&mut first, Command::Pause);
    assert!(first.state().is_paused());
    close(first);
    let next = opened(Window::new(options("", state.path(), LONG)).unwrap());
    assert!(next.state().is_paused());
}

#[test]
fn escape_closes_the_card_and_deletes_nothing() {
    let state = tempfile::tempdir().unwrap();
    leave_film(state.path(), ENDLESS);
    let mut next = kept_in(state.path(), "--stage sky --size 32x18", LONG);
    until_offered(&mut next);
    next.key_press(Key::Escape);
    next.run_steps(3);
    assert!(!next.state().has_offer());
    assert_eq!(files(state.path(), "exr").len(), 1);
}
