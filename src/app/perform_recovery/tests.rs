//! Tests of what a window leaves and goes on with.

use super::*;
use crate::app::tests::{until, window};
use crate::film::Film;
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
