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
