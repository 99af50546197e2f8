//! What a window does with what others have left: several offers, and what it closes over.

use crate::common::{has_samples, opened, save, send, until};
use crate::session::{ENDLESS, SOON, close, files, kept_in, options, until_film, until_offered, window};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::Path;
use std::time::Duration;
use weekender::app::{Command, Window};
use weekender::film::{checkpoint, key};
use weekender::output::OutputFormat;
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

#[test]
fn who_changes_the_picture_before_its_film_was_read_is_offered_the_film() {
    let state = tempfile::tempdir().unwrap();
    let mut first = window(state.path(), ENDLESS);
    until_film(&mut first, state.path());
    close(first);
    let samples = checkpoint::load(&state.path().join("session.exr")).unwrap().film.sample_count();
    // The reading has not even begun.
    let mut next = Window::new(options("", state.path(), SOON), None).unwrap();
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
    let next = opened(Window::new(options("", state.path(), LONG), None).unwrap());
    assert!(next.state().is_paused());
}
