//! What the programs without a window say: text for a person, JSON for other programs, progress.

mod display;

pub use display::Display;

use crate::cli::JsonTarget;
use crate::film::write_text;
use anyhow::{Context, Result};
use serde::Serialize;
use std::io::{ErrorKind, Write};

/// Prints for a person, to standard output. A reader who has gone away is no failure.
pub fn print(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

/// Prints for a person: to standard output, or to standard error where JSON goes to the other.
pub fn print_beside(json: Option<&JsonTarget>, text: &str) {
    if is_taken(json) {
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    } else {
        print(text);
    }
}

/// Whether standard output is for JSON alone.
pub fn is_taken(json: Option<&JsonTarget>) -> bool {
    json == Some(&JsonTarget::StandardOutput)
}

/// Writes `value` as JSON, with a line's end behind it. A reader who has gone away is no failure.
///
/// # Errors
/// A file or a standard output that cannot be written, or a value that JSON cannot hold.
pub fn write_json(value: &impl Serialize, target: &JsonTarget) -> Result<()> {
    let text = serde_json::to_string_pretty(value).context("the figures cannot be put as JSON")? + "\n";
    match target {
        JsonTarget::File(path) => Ok(write_text(path, &text)?),
        JsonTarget::StandardOutput => match std::io::stdout().lock().write_all(text.as_bytes()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(error).context("cannot write JSON to standard output; choose a file")
            }
            _ => Ok(()),
        },
    }
}
