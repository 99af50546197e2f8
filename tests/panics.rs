//! A panic in the tracer: the picture is complete, and the user is told. A panic of the program: the samples are kept,
//! and a report says what happened.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use weekender::film::checkpoint;

/// Runs the program in `directory`, which is also the place for temporary files.
fn weekender(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.current_dir(directory).args(arguments).stdin(Stdio::null());
    command.env("TMPDIR", directory).env("XDG_STATE_HOME", directory).env_remove("RUST_LOG");
    command.output().unwrap()
}

fn reports(directory: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.to_string_lossy().contains("weekender-report")).collect()
}

#[test]
fn a_panic_of_the_tracer_leaves_a_whole_picture_and_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    for (tiles, level) in [("0", "auto"), ("7", "auto"), ("30", "auto"), ("20", "portable")] {
        let flags = ["--batch", "--device", "cpu", "--size", "100x70", "--samples", "64", "--isa", level];
        let files = ["--simulate-panic", tiles, "--out", "broken.exr", "--json", "broken.json"];
        let log = ["--log", "broken.log"];
        let output = weekender(directory.path(), &[&flags[..], &files, &log].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{tiles}: {said}");
        assert!(said.contains("panicked") && said.contains("continues the same picture"), "{tiles}: {said}");
        // The render goes on, so a line in the log is enough.
        assert!(reports(directory.path()).is_empty(), "{tiles}: {said}");
        let log = fs::read_to_string(directory.path().join("broken.log")).unwrap();
        assert!(log.contains("ERROR") && log.contains("internal error in thread trace"), "{log}");
        let film = checkpoint::load(&directory.path().join("broken.exr")).unwrap().film;
        assert_eq!((film.samples().to_string().as_str(), film.rejected()), ("0..64", 0), "{tiles}");
        let json = std::fs::read_to_string(directory.path().join("broken.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(report["warnings"].as_array().unwrap().len(), 1, "{report}");
        let added: u64 = report["backends"]
            .as_array()
            .unwrap()
            .iter()
            .map(|part| part["samples_per_pixel"].as_u64().unwrap())
            .sum();
        assert_eq!(added, 64, "{report}");
    }
}

#[test]
fn a_panic_of_the_program_keeps_the_samples_and_leaves_a_report() {
    let directory = tempfile::tempdir().unwrap();
    let flags = ["--batch", "--device", "cpu", "--size", "48x27", "--samples", "4294967296"];
    let crash = ["--simulate-crash", "8", "--out", "kept.png", "--checkpoint", "kept.exr", "--seed", "77"];
    let output = weekender(directory.path(), &[&flags[..], &crash].concat());
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("injected fault") && said.contains("kept.exr"), "{said}");
    let film = checkpoint::load(&directory.path().join("kept.exr")).unwrap().film;
    assert!(film.sample_count() >= 8 && directory.path().join("kept.png").exists());

    let reports = reports(directory.path());
    let [path] = reports.as_slice() else { panic!("{reports:?}: {said}") };
    assert!(said.contains(&path.display().to_string()), "{said}");
    let report = fs::read_to_string(path).unwrap();
    for part in
        ["injected fault", "--seed 77", env!("CARGO_PKG_VERSION"), "src/batch", "kernel:", "wrote kept.exr"]
    {
        assert!(report.contains(part), "{part} is not in {report}");
    }
}

#[test]
fn a_report_has_other_places_if_there_is_none_for_temporary_files() {
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.current_dir(directory.path()).env("TMPDIR", "/dev/null").env("XDG_STATE_HOME", "/dev/null");
    command.args([
        "--batch",
        "--device",
        "cpu",
        "--size",
        "48x27",
        "--samples",
        "4294967296",
        "--simulate-crash",
        "8",
    ]);
    let output = command.args(["--out", "kept.png"]).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    // The current directory is left.
    assert_eq!((output.status.code(), reports(directory.path()).len()), (Some(3), 1), "{said}");
    assert!(directory.path().join("kept.png").exists(), "{said}");
}
