//! A panic in the tracer: the picture is complete, with a warning. A panic of the program: the samples are kept,
//! and a report says what happened.

use crate::common::program::{film, json_file, outcome};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use weekender::system::journal;

/// The program in `directory`, which is also the place for temporary files.
fn weekender(directory: &Path, arguments: &[&str]) -> Command {
    let mut command =
        crate::common::program::weekender(directory, &[&["--batch", "--device", "cpu"], arguments].concat());
    command.env("TMPDIR", directory).env("XDG_STATE_HOME", directory);
    command
}

/// A run that crashes after 8 samples, and then writes its picture.
const CRASH: [&str; 8] =
    ["--size", "48x27", "--samples", "4294967296", "--simulate-crash", "8", "--out", "kept.png"];

fn reports(directory: &Path) -> Vec<PathBuf> {
    let files = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.to_string_lossy().contains("weekender-report")).collect()
}

#[test]
fn tracer_panic_leaves_a_whole_picture_and_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    for (tiles, level) in [("0", "auto"), ("7", "auto"), ("20", "auto"), ("20", "portable")] {
        // On two threads a pass has 12 tiles. There are at least two passes, because 96 is not a power of two.
        let flags = ["--threads", "2", "--isa", level, "--size", "100x70", "--samples", "96"];
        let files = ["--simulate-panic", tiles, "--out", "broken.exr", "--json", "broken.json"];
        let arguments = [&flags[..], &files, &["--log", "broken.log"]].concat();
        let (code, _, said) = outcome(&weekender(directory.path(), &arguments).output().unwrap());
        assert_eq!(code, Some(0), "{tiles}: {said}");
        assert!(said.contains("panicked") && said.contains("continues the same picture"), "{tiles}: {said}");
        // The render continues, so a line in the log is enough.
        assert!(reports(directory.path()).is_empty(), "{tiles}: {said}");
        let log = fs::read_to_string(at("broken.log")).unwrap();
        assert!(log.contains("ERROR") && log.contains("internal error in thread trace"), "{log}");
        let film = film(&at("broken.exr"));
        assert_eq!((film.samples().to_string().as_str(), film.rejected()), ("0..96", 0), "{tiles}");
        let report = json_file(&at("broken.json"));
        assert_eq!(report["warnings"].as_array().unwrap().len(), 1, "{report}");
        let parts = report["backends"].as_array().unwrap().iter();
        let added: u64 = parts.map(|part| part["samples_per_pixel"].as_u64().unwrap()).sum();
        assert_eq!(added, 96, "{report}");
    }
}

#[test]
fn program_panic_keeps_samples_and_leaves_a_report() {
    let directory = tempfile::tempdir().unwrap();
    let more = ["--checkpoint", "kept.exr", "--seed", "77"];
    let mut command = weekender(directory.path(), &[&CRASH[..], &more].concat());
    let (code, _, said) = outcome(&command.output().unwrap());
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("injected fault") && said.contains("kept.exr"), "{said}");
    assert!(film(&directory.path().join("kept.exr")).sample_count() >= 8);
    assert!(directory.path().join("kept.png").exists());

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
fn report_is_written_without_a_temporary_directory() {
    let directory = tempfile::tempdir().unwrap();
    let mut command = weekender(directory.path(), &CRASH);
    command.env("TMPDIR", "/dev/null").env("XDG_STATE_HOME", "/dev/null");
    let (code, _, said) = outcome(&command.output().unwrap());
    // The current directory is left.
    assert_eq!((code, reports(directory.path()).len()), (Some(3), 1), "{said}");
    assert!(directory.path().join("kept.png").exists(), "{said}");
}

/// The test runs itself in a separate process, because the panic hook is set for the whole process.
#[test]
fn panic_outside_a_render_leaves_a_report() {
    const CHILD: &str = "WEEKENDER_TEST_OF_A_PANIC";
    if std::env::var_os(CHILD).is_some() {
        journal::watched("weekender of a test".to_owned(), || panic!("outside of a render"));
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", "panic_outside_a_render_leaves_a_report"]).env(CHILD, "1");
    command.current_dir(directory.path()).env("TMPDIR", directory.path());
    let (code, _, said) = outcome(&command.output().unwrap());
    assert!(code == Some(0) && said.contains("a report is in "), "{said}");
    let report = fs::read_to_string(&reports(directory.path())[0]).unwrap();
    assert!(report.contains("weekender of a test") && report.contains("outside of a render"), "{report}");
}
