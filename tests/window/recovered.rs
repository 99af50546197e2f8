//! What a window does with what others have left: several offers, and what it closes over.

use crate::common::{has_samples, opened, until};
use crate::session::{ENDLESS, SOON, files, kept_in, options, until_film, until_offered, window};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::fs;
use std::path::Path;
use std::time::Duration;
use weekender::app::Window;

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
