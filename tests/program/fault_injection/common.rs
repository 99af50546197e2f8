//! The program with a small picture, or an endless one.

pub use crate::common::program::{PROGRAM, film, names, signal, text, until, wait};

use std::path::Path;
use std::process::{Command, Stdio};

/// A small picture with enough samples to interrupt.
pub const PICTURE: [&str; 8] =
    ["--batch", "--size", "48x27", "--threads", "2", "--device", "cpu", "--progress"];

/// An endless render that keeps its film.
pub const ENDLESS: [&str; 8] =
    ["--samples", "4294967296", "--checkpoint", "g.exr", "--every", "0.1s", "--out", "g.png"];

pub fn rounds(usual: u32) -> u32 {
    std::env::var("WEEKENDER_FAULT_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(usual)
}

pub fn weekender(at: &Path, arguments: &[&str]) -> Command {
    let mut command = crate::common::program::weekender(at, arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

pub fn batch(at: &Path, progress: &str, arguments: &[&str]) -> Command {
    weekender(at, &[&PICTURE[..], &[progress], arguments].concat())
}

pub fn succeeds(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
}
