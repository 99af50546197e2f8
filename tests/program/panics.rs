//! A panic of the program outside of a render leaves a report. Panics of a tracer, of an onlooker and of the window are
//! tested beside their code.

use crate::common::program::outcome;
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use weekender::system::journal;

/// The test runs itself in a separate process, because the panic hook is set for the whole process.
#[test]
fn a_panic_leaves_a_report() {
    const CHILD: &str = "WEEKENDER_TEST_OF_A_PANIC";
    if std::env::var_os(CHILD).is_some() {
        journal::watched("weekender of a test".to_owned(), || panic!("outside of a render"));
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    // Without a directory for temporary files or for the state, the current one is left.
    for (place, is_found) in [(directory.path().to_owned(), true), (PathBuf::from("/dev/null"), false)] {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", "panics::a_panic_leaves_a_report"]).env(CHILD, "1");
        let here = tempfile::tempdir().unwrap();
        command.current_dir(here.path()).env("TMPDIR", &place).env("XDG_STATE_HOME", &place);
        let (code, _, said) = outcome(&command.output().unwrap());
        assert!(code == Some(0) && said.contains("a report is in "), "{said}");
        let found = if is_found { place.as_path() } else { here.path() };
        let mut files = fs::read_dir(found).unwrap().map(|entry| entry.unwrap().path());
        let report = files.find(|path| path.is_file()).unwrap();
        let report = fs::read_to_string(report).unwrap();
        assert!(report.contains("weekender of a test") && report.contains("outside of a render"), "{report}");
    }
}
