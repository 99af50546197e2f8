//! Tests of what a window keeps for the next one.

use super::*;
use crate::app::model::origin::Origin;
use crate::stages::Stage;

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
