//! Tests of the files in a folder of kept pictures.

use super::*;
use crate::app::model::origin::Origin;
use crate::film::Film;
use crate::progressive::{Status, Stop};
use crate::stages::Stage;
use std::fs::File;
use std::time::Duration;

/// A kept picture whose samples took 5 seconds in an earlier window and 2 in this one.
fn kept() -> Kept {
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    (document.has_own_size, document.stop) = (false, Stop::at_samples(77));
    let mut film = Film::new(4, 2, 2);
    film.record(0..3, 0).unwrap();
    let status = Status { trace: Duration::from_secs(2), ..Status::default() };
    Kept::new(document, film, status.into(), Some(5.0))
}

#[test]
fn the_kept_pictures_of_all_windows_count_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let folders = ["window-1-1", "window-2-1"].map(|name| Folder::of(directory.path(), name));
    assert_eq!(folders.each_ref().map(Folder::bytes_of_all), [0; 2]);
    let other = directory.path().join("window-1-1.films");
    fs::create_dir(&other).unwrap();
    fs::write(other.join("a.exr"), [0_u8; 50]).unwrap();
    fs::write(directory.path().join("window-1-1.exr"), [0_u8; 90]).unwrap();
    for (folder, bytes) in folders.iter().zip([300, 7000]) {
        fs::create_dir(folder.path()).unwrap();
        fs::write(folder.film("a"), vec![0_u8; bytes]).unwrap();
    }
    assert_eq!(folders.each_ref().map(Folder::bytes_of_all), [7300; 2]);
}

#[test]
fn a_film_that_is_in_no_list_tells_what_it_is() {
    let directory = tempfile::tempdir().unwrap();
    let folder = Folder::of(directory.path(), "window-1-1");
    let kept = kept();
    folder.write(&kept, u64::MAX).unwrap();
    fs::write(folder.film("damaged"), "not a film").unwrap();
    let unlisted = |id: &str, name: &str, size, samples| {
        let (id, name) = (id.to_owned(), name.to_owned());
        Entry { number: None, id, name, size, samples, has_own_size: true }
    };
    let entries =
        vec![unlisted(&kept.id, "metal", [4, 2], 3), unlisted("damaged", "a kept picture", [0, 0], 0)];
    assert_eq!(folder.listing(), Ok(Listing { entries, faults: vec![] }));
}

#[test]
fn without_its_note_a_picture_is_as_its_film_describes_it() {
    let directory = tempfile::tempdir().unwrap();
    let folder = Folder::of(directory.path(), "window-1-1");
    let kept = kept();
    folder.write(&kept, u64::MAX).unwrap();
    let usual = kept.document.origin.usual_stop();
    for (has_note, before, trace, stop) in [(true, 5.0, 2, Stop::at_samples(77)), (false, 7.0, 0, usual)] {
        if !has_note {
            fs::remove_file(folder.note(&kept.id)).unwrap();
        }
        let found = folder.read(&kept.id, &[]).unwrap();
        assert!(found.film == kept.film && found.id == kept.id);
        let seconds = (found.seconds_before, found.status.trace);
        assert_eq!(seconds, (Some(before), Duration::from_secs(trace)));
        assert_eq!(found.document.stage().map(|stage| stage.id), Some("metal"));
        assert_eq!((found.document.stop, found.document.has_own_size), (stop, !has_note));
    }
}

#[test]
fn a_film_is_moved_away_without_its_note() {
    let directory = tempfile::tempdir().unwrap();
    let (folder, kept) = (Folder::of(directory.path(), "window-1-1"), kept());
    folder.write(&kept, u64::MAX).unwrap();
    let (film, to) = (fs::read(folder.film(&kept.id)).unwrap(), directory.path().join("other.exr"));
    folder.move_film(&kept.id, &to).unwrap();
    assert!(fs::read(&to).unwrap() == film);
    assert!(!folder.film(&kept.id).exists() && !folder.note(&kept.id).exists());
    assert!(folder.move_film(&kept.id, &to).is_err(), "it is gone");
}

#[test]
fn a_folder_is_as_old_as_its_list() {
    let directory = tempfile::tempdir().unwrap();
    let folder = Folder::of(directory.path(), "window-1-1");
    assert_eq!(folder.changed(), None);
    fs::create_dir(folder.path()).unwrap();
    let of_folder = fs::metadata(folder.path()).unwrap().modified().unwrap();
    assert_eq!(folder.changed(), Some(of_folder), "a film may be in no list");
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_secs(7000);
    File::create(folder.list()).unwrap().set_modified(long_ago).unwrap();
    assert_eq!(folder.changed(), Some(long_ago));
}
