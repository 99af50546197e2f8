//! Runs of the program with an end, and refusals.

pub use crate::program_common::{names, text, weekender};

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus, Output, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub const PATIENCE: Duration = Duration::from_secs(120);

/// Runs the program and fails if it does not end.
pub fn run(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = weekender(directory, arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let (stdout, stderr) = (gather(child.stdout.take().unwrap()), gather(child.stderr.take().unwrap()));
    let status = wait(&mut child, &format!("{arguments:?}"));
    Output { status, stdout: stdout.join().unwrap(), stderr: stderr.join().unwrap() }
}

/// Reads a pipe while the program runs, so that the program never waits for a full pipe.
fn gather(mut pipe: impl Read + Send + 'static) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).unwrap();
        bytes
    })
}

/// Waits for the end of the program that `what` describes. Ends it if it runs for too long.
pub fn wait(child: &mut Child, what: &str) -> ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{what} has not ended after {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Runs a small batch render that must succeed.
pub fn render(directory: &Path, arguments: &[&str]) -> Output {
    let output = run(directory, &[&["--batch", "--size", "32x18", "--threads", "2"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
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
