//! The program, run in a directory of its own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

pub const PATIENCE: Duration = Duration::from_secs(120);

pub fn weekender(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    // If a command that should be refused is accepted, it must not open a window.
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.current_dir(directory).args(arguments).stdin(Stdio::null());
    command
}

pub fn run(directory: &Path, arguments: &[&str]) -> Output {
    weekender(directory, arguments).output().unwrap()
}

/// Runs a small batch render that must succeed.
pub fn render(directory: &Path, arguments: &[&str]) -> Output {
    let output = run(directory, &[&["--batch", "--size", "32x18", "--threads", "2"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

pub fn temp() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn film(path: PathBuf) -> weekender::film::Film {
    weekender::film::checkpoint::load(&path).unwrap().film
}

/// Bad input: exit code 2, a message with all of `parts`, and no new file.
pub fn refused(arguments: &[&str], parts: &[&str]) {
    refused_in(&temp(), arguments, parts);
}

pub fn refused_in(directory: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = names(directory.path());
    let output = run(directory.path(), arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
    }
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert_eq!(names(directory.path()), before, "{arguments:?} left something behind");
}
