//! Tests of the files that a window keeps.

use super::*;
#[cfg(unix)]
use crate::app::tests::unreadable;

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn write(files: &RecoveryFiles, title: &str, film: Option<&str>) {
    files.write_note(&serde_json::from_value(serde_json::json!({ "title": title })).unwrap()).unwrap();
    if let Some(film) = film {
        fs::write(files.film(), film).unwrap();
    }
}

fn title(files: &RecoveryFiles) -> String {
    files.note().unwrap().unwrap().title
}

#[test]
fn only_files_of_windows_that_are_gone_are_left() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let [first, second] = [(); 2].map(|()| RecoveryFiles::claim(at).unwrap());
    assert_ne!(first.film(), second.film());
    write(&first, "first", Some("film"));
    write(&second, "second", None);
    assert!(RecoveryFiles::left_in(at).is_empty(), "both windows run");
    drop(first);
    let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
    assert_eq!((title(&left).as_str(), left.has_film()), ("first", true));
    assert!(RecoveryFiles::left_in(at).is_empty(), "who offers it has it");
    drop(left);
    assert_eq!(RecoveryFiles::left_in(at).len(), 1, "and gives it back");
    let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
    left.delete_film();
    left.delete_note();
    drop(left);
    second.delete_note();
    drop(second);
    assert_eq!(names(at), <[&str; 0]>::default(), "nothing stays where nothing was kept");
}

#[test]
fn a_film_without_a_lock_or_a_note_is_found() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("window-1-1.exr"), "film").unwrap();
    fs::write(directory.path().join("window-2-1.json"), "no note").unwrap();
    fs::write(directory.path().join("other.exr"), "film").unwrap();
    let left = RecoveryFiles::left_in(directory.path());
    assert_eq!(left.len(), 2);
    let told = left.iter().find_map(|files| files.note().err()).unwrap();
    assert!(told.contains("window-2-1.json"), "{told}");
}

#[test]
fn a_session_goes_from_window_to_window() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let first = RecoveryFiles::claim(at).unwrap();
    assert!(!first.take_session().unwrap());
    write(&first, "first", Some("film"));
    first.leave_session().unwrap();
    drop(first);
    assert!(RecoveryFiles::left_in(at).is_empty(), "it ended in order");
    let [second, third] = [(); 2].map(|()| RecoveryFiles::claim(at).unwrap());
    assert!(second.take_session().unwrap());
    assert_eq!((title(&second).as_str(), second.has_film()), ("first", true));
    assert!(!third.take_session().unwrap(), "one window takes it");
    // It is this window's now: if the window is killed, the film is left.
    drop(second);
    assert_eq!(RecoveryFiles::left_in(at).len(), 1);
}

#[test]
fn a_session_that_no_window_has_taken_is_replaced_only_if_nothing_is_lost() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let leave = |title: &str, film| {
        let files = RecoveryFiles::claim(at).unwrap();
        write(&files, title, film);
        files.leave_session().unwrap();
    };
    leave("plain", None);
    leave("long", Some("film"));
    assert!(RecoveryFiles::left_in(at).is_empty(), "the plain one cost nothing");
    leave("newest", None);
    let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
    assert_eq!((title(&left).as_str(), left.has_film()), ("long", true));
    let last = RecoveryFiles::claim(at).unwrap();
    assert!(last.take_session().unwrap() && title(&last) == "newest" && !last.has_film());
}

#[test]
fn a_film_is_set_aside() {
    let directory = tempfile::tempdir().unwrap();
    let [files, other] = [(); 2].map(|()| RecoveryFiles::claim(directory.path()).unwrap());
    write(&files, "mine", Some("film"));
    let aside = files.set_film_aside().unwrap();
    assert!(aside.exists() && !files.has_film());
    assert_ne!(aside, other.film(), "that name is another window's");
    let [left] = RecoveryFiles::left_in(directory.path()).try_into().unwrap();
    assert_eq!(left.film(), aside);
    files.take_film(&left).unwrap();
    assert!(files.has_film() && !left.has_film());
}

#[test]
fn a_directory_that_cannot_be_is_named() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("file"), "").unwrap();
    let told = RecoveryFiles::claim(&directory.path().join("file/deeper")).unwrap_err();
    assert!(told.contains("file/deeper"), "{told}");
}

#[test]
fn changes_and_kept_pictures_that_no_window_has_taken_are_not_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let leave = |note: serde_json::Value, has_slots: bool| {
        let files = RecoveryFiles::claim(at).unwrap();
        files.write_note(&serde_json::from_value(note).unwrap()).unwrap();
        if has_slots {
            fs::create_dir(files.slots().path()).unwrap();
            fs::write(files.slots().film("1"), "a film").unwrap();
        }
        files.leave_session().unwrap();
    };
    leave(serde_json::json!({ "title": "changed", "is_changed": true }), false);
    leave(serde_json::json!({ "title": "keeping" }), true);
    leave(serde_json::json!({ "title": "newest" }), false);
    let mut left = RecoveryFiles::left_in(at);
    left.sort_by_key(title);
    let found: Vec<_> = left.iter().map(|files| (title(files), files.slots().exists())).collect();
    assert_eq!(found, [("changed".to_owned(), false), ("keeping".to_owned(), true)]);
}

#[cfg(unix)]
#[test]
fn what_cannot_be_looked_at_is_not_taken_for_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    for ending in ["exr", "json", "slots"] {
        let other = at.join(format!("session.{ending}"));
        let _elsewhere = unreadable(&other);
        let files = RecoveryFiles::claim(at).unwrap();
        write(&files, "mine", Some("film"));
        files.leave_session().unwrap();
        let links = || fs::read_dir(at).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_symlink());
        assert!(!other.is_symlink(), "{ending}");
        assert_eq!(links().count(), 1, "it has another name now");
        drop(files);
        let [left] = RecoveryFiles::left_in(at).try_into().unwrap();
        assert!(!left.paths.is_empty());
        assert_eq!(left.has_film(), ending == "exr");
        assert_eq!(left.note().is_err(), ending == "json");
        drop(left);
        assert_eq!(links().count(), 1, "it is not deleted");
        for name in names(at) {
            fs::remove_file(at.join(name)).unwrap();
        }
    }
}

#[cfg(unix)]
#[test]
fn kept_pictures_are_set_aside_without_being_looked_at() {
    let directory = tempfile::tempdir().unwrap();
    let files = RecoveryFiles::claim(directory.path()).unwrap();
    let _elsewhere = unreadable(files.slots().path());
    let aside = files.set_slots_aside().unwrap();
    assert!(aside.is_symlink() && !files.slots().exists());
    let [left] = RecoveryFiles::left_in(directory.path()).try_into().unwrap();
    assert_eq!(left.slots().path(), aside);
}
