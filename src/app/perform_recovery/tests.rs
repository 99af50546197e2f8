//! Tests of what a window leaves and goes on with.

use super::*;
use crate::app::model::kept::Kept;
use crate::app::model::slots::{Slot, SlotNumber};
use crate::app::tests::{until, window};
use crate::film::Film;
use crate::progressive::ReferenceMeans;
use std::time::Duration;

fn film(samples: u64) -> SavedFilm {
    let mut film = Film::new(16, 9, 2);
    film.record(0..samples, 0).unwrap();
    SavedFilm { film, seconds: Some(7.0), backend: None }
}

/// A window that keeps its files in this directory and writes every film.
fn keeping(directory: &Path) -> Window {
    let mut window = window("weekender --stage glass-schlick --size 16x9 --samples 4 --device cpu");
    window.recovery = Recovery::new(Duration::ZERO);
    window.recovery.files = Some(RecoveryFiles::claim(directory).unwrap());
    window
}

#[test]
fn a_film_that_was_read_goes_on_with_its_picture_alone() {
    let directory = tempfile::tempdir().unwrap();
    let mut window = keeping(directory.path());
    let saved = |window: &Window| window.recovery.autosave.saved().cloned();
    let mine = window.document().clone();
    window.recovery.resuming = Some(mine.clone());
    window.take_resumed(Ok(film(3)));
    assert_eq!(window.pending_film.take().unwrap().sample_count(), 3);
    assert!(saved(&window).is_some_and(|saved| saved.samples == 3 && saved.document == mine));

    // The picture was changed meanwhile, and Undo brings the other one back.
    let other = Document::new(Origin::usual());
    window.recovery.resuming = Some(other.clone());
    window.take_resumed(Ok(film(5)));
    assert!(window.pending_film.is_none());
    assert!(saved(&window).is_some_and(|saved| saved.samples == 5 && saved.document == other));

    std::fs::write(window.recovery.files.as_ref().unwrap().film(), "damaged").unwrap();
    window.recovery.resuming = Some(mine);
    window.take_resumed(Err("it is damaged".to_owned()));
    assert!(window.pending_film.is_none() && saved(&window).is_none(), "nothing is left to come back to");
    let told = window.messages().pop().unwrap();
    let begin = "The film of this picture is not continued: it is damaged; it is kept as ";
    let aside = told.strip_prefix(begin).unwrap_or_else(|| panic!("{told}"));
    assert_eq!(std::fs::read_to_string(aside).unwrap(), "damaged");
}

#[test]
fn a_film_that_cannot_be_written_at_the_end_does_not_replace_an_earlier_one() {
    let directory = tempfile::tempdir().unwrap();
    for is_earlier in [true, false] {
        let mut window = keeping(directory.path());
        let files = window.recovery.files.take().unwrap();
        let is_done = |window: &Window| window.main.newest_status().samples_per_pixel == 4;
        until(&mut window, &Context::default(), "the samples", is_done);
        let document = window.document().clone();
        let earlier = Saved { document: document.clone(), samples: 1 };
        window.recovery.autosave.holds(Some(earlier).filter(|_| is_earlier));
        // Nothing can be written where a folder is.
        std::fs::create_dir_all(files.film().join("full")).unwrap();
        assert_eq!(window.leave_film(&files, &document), is_earlier);
    }
}

/// A window with a finished picture, which has written nothing, and its files.
fn finished(directory: &Path) -> (Window, RecoveryFiles) {
    let mut window = keeping(directory);
    let files = window.recovery.files.take().unwrap();
    let is_over =
        |window: &Window| window.main.has_samples(window.document()) && window.status().phase.is_over();
    until(&mut window, &Context::default(), "the end", is_over);
    (window, files)
}

/// The picture of a window with another seed.
fn with_another_seed(window: &Window) -> Document {
    let mut document = window.document().clone();
    document.settings.seed += 1;
    document
}

#[test]
fn what_is_left_is_the_film_of_the_picture_on_the_screen() {
    let directory = tempfile::tempdir().unwrap();
    let (mut window, files) = finished(directory.path());
    let document = window.document().clone();
    std::fs::write(files.film(), "the film of another picture").unwrap();
    let other = Saved { document: with_another_seed(&window), samples: 100 };
    window.recovery.autosave.holds(Some(other));
    // Earlier windows have traced longer than a test takes.
    window.seconds_before = Some(1e6);
    assert!(window.leave_film(&files, &document));
    let left = crate::saved::resume(files.film(), &document.job(1).unwrap());
    let left = left.map_err(|error| error.to_string()).unwrap();
    assert_eq!(left.film.sample_count(), 4);
    let seconds = left.seconds.unwrap();
    assert!((1e6..1.5e6).contains(&seconds), "all samples count, each once: {seconds}");
}

#[test]
fn a_film_that_is_soon_traced_again_is_not_left() {
    let directory = tempfile::tempdir().unwrap();
    let (mut window, files) = finished(directory.path());
    window.recovery = Recovery::new(Duration::from_secs(3600));
    std::fs::write(files.film(), "the film of another picture").unwrap();
    let document = window.document().clone();
    window.recovery.autosave.holds(Some(Saved { document: document.clone(), samples: 4 }));
    assert!(!window.leave_film(&files, &document) && !files.has_film());
}

#[test]
fn only_a_film_of_the_same_picture_that_is_ahead_goes_on() {
    for (is_same, samples, goes_on) in [(true, 5, true), (true, 4, false), (false, 100, false)] {
        let directory = tempfile::tempdir().unwrap();
        let (mut window, files) = finished(directory.path());
        window.recovery = Recovery::new(Duration::from_secs(3600));
        window.recovery.files = Some(files);
        let document = if is_same { window.document().clone() } else { with_another_seed(&window) };
        window.recovery.autosave.holds(Some(Saved { document, samples }));
        window.write_recovery(&Context::default());
        assert_eq!(window.recovery.resuming.is_some(), goes_on, "{is_same} {samples}");
    }
}

#[test]
fn a_fresh_start_shows_the_usual_picture_and_keeps_what_was_loaded_and_kept() {
    let mut window = window("weekender --stage metal --size 16x9 --device cpu");
    let reference = ReferenceMeans { width: 1, height: 1, means: vec![[0.0; 3]], identity: None };
    let one = SlotNumber::ALL[0];
    let kept = Arc::new(Kept::new(window.document().clone(), film(3).film, Arc::default(), None));
    window.model.view.reference = Some(Arc::new(reference));
    window.model.view.slots.put(one, Slot { name: String::new(), kept });
    window.model.view.look(Some(one));
    window.model.view.tone.exposure = 2.0;
    window.model.is_paused = true;
    let fitting = window.viewport.placement.zoom();
    window.viewport.placement.zoom_by(2.0);
    assert_ne!(window.viewport.placement.zoom(), fitting);
    window.start_fresh();
    assert_eq!(window.viewport.placement.zoom(), fitting);
    assert!(window.slot(one).is_some() && window.model.view.reference.is_some());
    assert_eq!((window.looked(), window.model.view.tone.exposure, window.is_paused()), (None, 0.0, false));
    assert_eq!(window.document().title(), Document::new(Origin::usual()).title());
}

#[test]
fn a_stop_that_is_asked_for_replaces_that_of_the_last_window() {
    for (asked, samples) in [(None, 4), (Some(Stop::at_samples(7)), 7)] {
        let directory = tempfile::tempdir().unwrap();
        keeping(directory.path()).end_in_order();
        let mut next = window("weekender --stage metal --size 16x9 --device cpu");
        next.begin_recovery(directory.path(), true, (asked, u64::MAX));
        assert_eq!(next.document().stage().map(|stage| stage.id), Some("glass-schlick"));
        assert_eq!(next.document().stop, Stop::at_samples(samples));
    }
}

#[test]
fn a_picture_that_cannot_be_shown_again_stays_on_the_card_with_its_fault() {
    let directory = tempfile::tempdir().unwrap();
    let note = r#"{ "title": "mine", "is_changed": true }"#;
    std::fs::write(directory.path().join("window-1-1.json"), note).unwrap();
    let [left] = Left::all_in(directory.path()).try_into().ok().unwrap();
    let mut window = keeping(directory.path());
    let document = window.document().clone();
    let arrival = Arrival { opened: None, restored: Some(Err("its stage is unknown".to_owned())) };
    window.take_arrival(arrival, left, Part::Picture);
    assert_eq!(window.messages(), ["Not opened: its stage is unknown"]);
    assert!(*window.document() == document);
    let [row] = window.recovery.left[0].rows().collect::<Vec<_>>().try_into().ok().unwrap();
    assert_eq!((row.part, row.fault.as_deref()), (Part::Picture, Some("its stage is unknown")));
}

#[test]
fn a_picture_that_cannot_be_rendered_does_not_replace_the_last_that_could() {
    let directory = tempfile::tempdir().unwrap();
    let mut window = keeping(directory.path());
    let session = Session::of(window.document(), &ViewState::default(), false);
    window.recovery.files.as_ref().unwrap().write_note(&session).unwrap();
    window.model.document.camera.vfov_degrees = 0.0;
    assert!(window.document().job(1).is_err());
    window.end_in_order();
    let left = std::fs::read(directory.path().join("session.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Session>(&left).unwrap(), session);
}

#[test]
fn zoom_and_pan_are_noted_of_the_live_picture_alone() {
    let directory = tempfile::tempdir().unwrap();
    let (mut window, _files) = finished(directory.path());
    assert_eq!(window.framing(), None, "it fits");
    window.viewport.placement.zoom_by(1.5);
    assert_eq!(window.framing().map(|framing| framing.size), Some([16, 9]));
    let one = SlotNumber::ALL[0];
    let kept = Arc::new(Kept::new(window.document().clone(), film(3).film, Arc::default(), None));
    window.model.view.slots.put(one, Slot { name: String::new(), kept });
    window.model.view.look(Some(one));
    assert_eq!(window.framing(), None);
}

#[test]
fn a_film_that_is_still_being_read_is_not_written_over() {
    for is_read in [true, false] {
        let directory = tempfile::tempdir().unwrap();
        let (mut window, files) = finished(directory.path());
        window.recovery = Recovery::new(Duration::ZERO);
        std::fs::write(files.film(), "the film of the last window").unwrap();
        let path = files.film().to_owned();
        window.recovery.files = Some(files);
        window.recovery.resuming = is_read.then(|| window.document().clone());
        window.write_recovery(&Context::default());
        window.recovery.autosave.finish();
        assert_eq!(std::fs::read(path).unwrap() == b"the film of the last window", is_read);
    }
}
