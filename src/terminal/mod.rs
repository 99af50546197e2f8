//! What the programs without a window say: text for a person, JSON for other programs, progress.

mod display;

pub use display::Display;

use crate::cli::JsonTarget;
use crate::console;
use crate::failure::output_failure;
use crate::files::write_text;
use anyhow::{Context, Result, anyhow};
use serde::Serialize;
use std::io;

/// Prints a result for a person, to standard output.
///
/// # Errors
/// A standard output that cannot be written, be it that its reader has gone away.
pub fn print(text: &str) -> Result<()> {
    told(console::print(text))
}

/// Prints for a person: to standard output, or to standard error where JSON goes to the other.
///
/// # Errors
/// As [`print`]; what goes to standard error cannot fail.
pub fn print_beside(json: Option<&JsonTarget>, text: &str) -> Result<()> {
    if is_taken(json) {
        console::note_painted(text);
        return Ok(());
    }
    print(text)
}

/// As [`print_beside`], for a text with colours: see [`console::print_painted`].
///
/// # Errors
/// As [`print`].
pub fn print_painted_beside(json: Option<&JsonTarget>, text: &str) -> Result<()> {
    if is_taken(json) {
        console::note_painted(text);
        return Ok(());
    }
    told(console::print_painted(text))
}

/// Whether standard output is for JSON alone.
pub fn is_taken(json: Option<&JsonTarget>) -> bool {
    json == Some(&JsonTarget::StandardOutput)
}

/// Writes `value` as JSON, with a line's end behind it.
///
/// # Errors
/// A file or a standard output that cannot be written, or a value that JSON cannot hold.
pub fn write_json(value: &impl Serialize, target: &JsonTarget) -> Result<()> {
    let text = serde_json::to_string_pretty(value).context("the figures cannot be put as JSON")? + "\n";
    match target {
        JsonTarget::File(path) => Ok(write_text(path, &text)?),
        JsonTarget::StandardOutput => told(console::write_out(&console::printable_json(&text))),
    }
}

fn told(written: io::Result<()>) -> Result<()> {
    written.map_err(|error| anyhow!(output_failure(&error)))
}
