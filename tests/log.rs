//! The log and the version.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod program_common;

use program_common::{text, weekender};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const PICTURE: [&str; 7] = ["--batch", "--size", "32x18", "--samples", "8", "--device", "cpu"];

fn program(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = weekender(directory, arguments);
    command.env_remove("RUST_LOG");
    command
}

fn said(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| text(bytes))
}

#[test]
fn the_log_is_off_unless_it_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let [_, errors] = said(&program(directory.path(), &PICTURE).output().unwrap());
    assert_eq!(errors, "");
    let [_, errors] = said(&program(directory.path(), &PICTURE).env("RUST_LOG", "info").output().unwrap());
    for part in [
        "INFO  weekender",
        "backend is to be Cpu",
        "prepared BackendInfo",
        "render ended (Samples) with 8",
        "wrote three",
    ] {
        assert!(errors.contains(part), "{part} is not in {errors}");
    }
    assert!(!errors.contains("DEBUG"), "{errors}");
}

#[test]
fn a_film_is_kept_as_often_as_was_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let written = |every: &str| {
        let picture =
            ["--batch", "--size", "32x18", "--device", "cpu", "--threads", "1", "--time-limit", "3"];
        let flags = ["--checkpoint", "film.exr", "--every", every, "--log", "run.log"];
        let output = program(directory.path(), &[&picture[..], &flags].concat()).output().unwrap();
        assert!(output.status.success(), "{:?}", said(&output));
        fs::remove_file(directory.path().join("film.exr")).unwrap();
        let log = fs::read_to_string(directory.path().join("run.log")).unwrap();
        log.lines().filter(|line| line.contains("checkpoint: ")).count()
    };
    assert_eq!(written("1h"), 0, "only the film at the end");
    assert!((1..=10).contains(&written("0.3s")));
}

#[test]
fn a_log_file_has_passes_and_checkpoints_and_replaces_no_picture() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let flags = ["--checkpoint", "film.exr", "--log", "run.log"];
    let output = program(directory.path(), &[&PICTURE[..], &flags].concat()).output().unwrap();
    assert!(output.status.success() && said(&output)[1].is_empty(), "{:?}", said(&output));
    let log = fs::read_to_string(at("run.log")).unwrap();
    for part in ["DEBUG weekender::progressive", "samples 0..8 in", "wrote film.exr"] {
        assert!(log.contains(part), "{part} is not in {log}");
    }
    fs::write(at("old.png"), "a picture").unwrap();
    for (flags, part) in [
        (["--log", "old.png"], "must end in .log"),
        (["--log", "missing/run.log"], "choose a file in a directory"),
    ] {
        let output = program(directory.path(), &[&PICTURE[..], &flags].concat()).output().unwrap();
        assert!(output.status.code() == Some(2) && said(&output)[1].contains(part), "{:?}", said(&output));
    }
    assert_eq!(fs::read(at("old.png")).unwrap(), b"a picture");
    let output = program(directory.path(), &PICTURE).env("RUST_LOG", "weekender=loud").output().unwrap();
    assert!(
        output.status.code() == Some(2) && said(&output)[1].contains("weekender=loud"),
        "{:?}",
        said(&output)
    );
}

#[test]
#[cfg(not(feature = "window"))]
fn a_build_without_a_window_says_what_to_do() {
    let directory = tempfile::tempdir().unwrap();
    let output = program(directory.path(), &[]).output().unwrap();
    let [_, errors] = said(&output);
    assert!(
        output.status.code() == Some(2) && errors.contains("no window") && errors.contains("--batch"),
        "{errors}"
    );
}
