//! Tests of what a window keeps for the next one.

use super::*;
use crate::app::model::origin::Origin;
use crate::app::tests::sleep_after;
use crate::stages::Stage;
use std::path::Path;

fn metal() -> Document {
    Document::new(Origin::of_stage(Stage::find("metal").unwrap()))
}

#[test]
fn a_note_that_cannot_be_written_is_told_of_once() {
    let mut recovery = Recovery::new(Duration::from_secs(3600));
    let (context, view, document) = (Context::default(), ViewState::default(), metal());
    let mut tell = |outcome: Result<(), &str>| {
        recovery.notes.answer(&context).give(outcome.map_err(str::to_owned));
        recovery.note(&context, (&document, &view, None), false)
    };
    assert_eq!(tell(Ok(())), None);
    assert_eq!(tell(Err("the disk is full")).as_deref(), Some("the disk is full"));
    assert_eq!(
        [tell(Err("the disk is full")), tell(Ok(())), tell(Err("the disk is full"))],
        [None, None, None]
    );
}

#[test]
fn a_note_that_is_never_written_is_not_waited_for() {
    let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
    let (view, document) = (ViewState::default(), metal());
    for is_last in [true, false] {
        recovery.notes.ask("files", &context, || panic!("on purpose"), Err);
        recovery.is_noting = true;
        if is_last {
            recovery.finish_notes();
        } else {
            let outcome = recovery.notes.wait().unwrap();
            recovery.notes.answer(&context).give(outcome);
            let told = recovery.note(&context, (&document, &view, None), false);
            assert_eq!(told.as_deref(), Some("the program failed (on purpose)"));
        }
        assert!(!recovery.is_noting);
    }
}

#[test]
fn each_change_is_noted_once_and_not_too_often() {
    let directory = tempfile::tempdir().unwrap();
    let mut recovery = Recovery::new(Duration::from_secs(3600));
    recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
    let (context, view) = (Context::default(), ViewState::default());
    let later = Instant::now() + Duration::from_secs(3600);
    let mut document = metal();
    // Whether a note was written, if the next one may be written then.
    let is_noted = |recovery: &mut Recovery, document: &Document, next: Instant| {
        recovery.next_note = next;
        assert_eq!(recovery.note(&context, (document, &view, None), true), None);
        let is_noting = recovery.is_noting;
        recovery.finish_notes();
        assert!(!recovery.is_noting);
        is_noting
    };
    let noted = |recovery: &Recovery| recovery.files.as_ref().unwrap().note().unwrap();
    let now = Instant::now();
    assert!(!is_noted(&mut recovery, &document, now) && noted(&recovery).is_none(), "nothing is changed");
    document.camera.vfov_degrees = 33.0;
    assert!(!is_noted(&mut recovery, &document, later), "too soon");
    assert!(is_noted(&mut recovery, &document, now));
    assert!(recovery.next_note > now + NOTES_APART / 2);
    let found = noted(&recovery).unwrap();
    assert!(found.is_changed && !found.has_film && found.restore().unwrap().is_paused);
    assert!(!is_noted(&mut recovery, &document, now), "once");
    recovery.autosave.holds(Some(Saved { document: document.clone(), samples: 1 }));
    assert!(is_noted(&mut recovery, &document, later), "a film needs its note at once");
    assert!(noted(&recovery).unwrap().has_film);
    recovery.note_soon();
    assert!(recovery.next_note <= Instant::now());
}

#[test]
fn a_window_that_keeps_nothing_never_looks() {
    let directory = tempfile::tempdir().unwrap();
    let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
    let now = Instant::now();
    recovery.next_look = now;
    assert!(!recovery.is_time(&context));
    recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
    assert!(recovery.is_time(&context));
    assert!(recovery.next_look >= now + LOOKS_APART, "the next look is later");
    recovery.next_look = now + Duration::from_secs(3600);
    assert!(!recovery.is_time(&context));
}

/// What three windows left in a directory.
fn left_by_three(directory: &Path) -> Recovery {
    for name in ["window-1-1.exr", "window-2-1.exr", "window-3-1.exr"] {
        std::fs::write(directory.join(name), "a film").unwrap();
    }
    let mut recovery = Recovery::new(Duration::from_secs(3600));
    recovery.left = Left::all_in(directory);
    recovery
}

fn films(recovery: &Recovery) -> Vec<PathBuf> {
    recovery.left.iter().map(|left| left.path(Part::Film)).collect()
}

#[test]
fn what_is_not_opened_after_all_keeps_its_place() {
    let directory = tempfile::tempdir().unwrap();
    let mut recovery = left_by_three(directory.path());
    let all = films(&recovery);
    assert_eq!(all.len(), 3);
    for (from, to) in [(0, 0), (1, 1), (2, 2), (2, 9)] {
        let left = recovery.left.remove(from);
        recovery.put_back(to, left);
        assert_eq!(films(&recovery), all, "{from} to {to}");
    }
    recovery.discard(3, Part::Film);
    assert_eq!(films(&recovery), all, "there is none");
    recovery.discard(1, Part::Film);
    assert_eq!(films(&recovery), [all[0].clone(), all[2].clone()]);
    assert_eq!([0, 1, 2].map(|index| all[index].exists()), [true, false, true]);
}

#[test]
fn one_thing_is_opened_at_a_time() {
    let directory = tempfile::tempdir().unwrap();
    let mut recovery = left_by_three(directory.path());
    let (all, context) = (films(&recovery), Context::default());
    recovery.open(&context, 3, Part::Film);
    assert!(recovery.opening.is_none(), "there is none");
    for _ in 0..2 {
        recovery.open(&context, 1, Part::Film);
    }
    assert_eq!(films(&recovery), [all[0].clone(), all[2].clone()]);
    assert!(recovery.opening.as_ref().is_some_and(|(left, _)| left.path(Part::Film) == all[1]));
    let arrival = recovery.arrivals.wait().unwrap();
    assert!(arrival.opened.is_some_and(|opened| opened.is_err()) && arrival.restored.is_none());
}

#[test]
fn a_window_that_works_is_woken_for_the_next_look() {
    let directory = tempfile::tempdir().unwrap();
    let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
    let is_woken = |recovery: &mut Recovery| {
        sleep_after(&context, |context| _ = recovery.is_time(context)) <= LOOKS_APART
    };
    recovery.is_working = true;
    assert!(!is_woken(&mut recovery), "it keeps nothing");
    recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
    assert!(is_woken(&mut recovery));
    recovery.is_working = false;
    assert!(!is_woken(&mut recovery));
}

#[test]
fn a_note_that_cannot_be_restored_matters_only_to_its_picture() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("window-1-1.exr"), "a film").unwrap();
    // It names no picture.
    let note = r#"{ "title": "mine", "is_changed": true, "has_film": true }"#;
    std::fs::write(directory.path().join("window-1-1.json"), note).unwrap();
    let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
    recovery.left = Left::all_in(directory.path());
    for (part, has_opened, has_restored) in [(Part::Film, true, false), (Part::Picture, false, true)] {
        recovery.open(&context, 0, part);
        let Arrival { opened, restored } = recovery.arrivals.wait().unwrap();
        assert_eq!((opened.is_some(), restored.is_some()), (has_opened, has_restored), "{part:?}");
        assert!(restored.is_none_or(|restored| restored.is_err()));
        let (left, _) = recovery.opening.take().unwrap();
        recovery.put_back(0, left);
    }
}

#[test]
fn a_note_has_the_view_with_zoom_and_pan() {
    let directory = tempfile::tempdir().unwrap();
    let (mut recovery, context) = (Recovery::new(Duration::from_secs(3600)), Context::default());
    recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
    let (mut document, mut view) = (metal(), ViewState::default());
    document.give_size([16, 9]);
    view.tone.exposure = 1.5;
    let framing = Framing { times: 2.0, middle: [0.25, 0.75], size: [16, 9] };
    recovery.note_soon();
    assert_eq!(recovery.note(&context, (&document, &view, Some(framing)), false), None);
    recovery.finish_notes();
    let restored = recovery.files.as_ref().unwrap().note().unwrap().unwrap().restore().unwrap();
    assert_eq!((restored.framing, restored.is_paused), (Some(framing), false));
    assert_eq!(restored.view.tone.exposure, 1.5);
}
