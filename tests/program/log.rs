//! The log and the version.

use crate::common::program::{ends, outcome, refused, succeeds, weekender};
use std::fs;

const PICTURE: [&str; 7] = ["--batch", "--size", "32x18", "--samples", "8", "--device", "cpu"];

#[test]
fn log_is_off_by_default() {
    let directory = tempfile::tempdir().unwrap();
    assert_eq!(ends(directory.path(), 0, &PICTURE).1, "");
    let logged = |filter: &str| {
        outcome(&weekender(directory.path(), &PICTURE).env("RUST_LOG", filter).output().unwrap())
    };
    let (_, _, errors) = logged("info");
    for part in ["INFO", "prepared", "8 samples", "three-spheres.png"] {
        assert!(errors.contains(part), "{part} is not in {errors}");
    }
    assert!(!errors.contains("DEBUG"), "{errors}");
    let (code, _, errors) = logged("weekender=loud");
    assert!(code == Some(2) && errors.contains("weekender=loud"), "{errors}");
}

#[test]
fn log_file_has_passes_and_replaces_no_picture() {
    let directory = tempfile::tempdir().unwrap();
    let flags = ["--checkpoint", "film.exr", "--log", "run.log"];
    succeeds(directory.path(), &[&PICTURE[..], &flags].concat());
    let log = fs::read_to_string(directory.path().join("run.log")).unwrap();
    for part in ["DEBUG", "samples 0..8", "film.exr"] {
        assert!(log.contains(part), "{part} is not in {log}");
    }
    let old = directory.path().join("old.png");
    fs::write(&old, "a picture").unwrap();
    for (file, part) in [("old.png", "must end in .log"), ("missing/run.log", "choose a file in a directory")]
    {
        refused(directory.path(), &[&PICTURE[..], &["--log", file]].concat(), &[part]);
    }
    assert_eq!(fs::read(old).unwrap(), b"a picture");
}

#[test]
#[cfg(not(feature = "window"))]
fn a_build_without_a_window_says_what_to_do() {
    let directory = tempfile::tempdir().unwrap();
    refused(directory.path(), &[], &["no window", "--batch"]);
}
