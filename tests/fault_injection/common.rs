//! The program and its signals.

pub use crate::program_common::{names, text};

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use weekender::film::{Film, checkpoint};

pub const PATIENCE: Duration = Duration::from_secs(120);
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_weekender");

/// A small picture with enough samples to interrupt.
pub const PICTURE: [&str; 8] =
    ["--batch", "--size", "48x27", "--threads", "2", "--device", "cpu", "--progress"];

/// An endless render that keeps its film.
pub const ENDLESS: [&str; 8] =
    ["--samples", "4294967296", "--checkpoint", "g.exr", "--every", "0.1s", "--out", "g.png"];

pub fn rounds(usual: u32) -> u32 {
    std::env::var("WEEKENDER_FAULT_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(usual)
}

/// The program with default signals, even if a script in the background, which ignores SIGINT, started the tests.
pub fn weekender(at: &Path, arguments: &[&str]) -> Command {
    let program = crate::program_common::weekender(at, arguments);
    let mut command = Command::new("env");
    command.arg("--default-signal=INT,TERM,HUP").arg(program.get_program()).args(program.get_args());
    for (name, value) in program.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.current_dir(at).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub fn batch(at: &Path, progress: &str, arguments: &[&str]) -> Command {
    weekender(at, &[&PICTURE[..], &[progress], arguments].concat())
}

pub fn succeeds(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
}

pub fn signal(child: &Child, name: &str) {
    let killed = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
}

pub fn wait(child: &mut Child) -> ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("it does not end");
        }
        sleep(Duration::from_millis(5));
    }
}

/// Waits until `is_so` returns true.
pub fn until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < PATIENCE, "{what}");
        sleep(Duration::from_millis(5));
    }
}

pub fn film(path: &Path) -> Film {
    checkpoint::load(path).unwrap().film
}
