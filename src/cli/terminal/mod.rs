//! Output of the programs without a window: text for people, JSON for other programs, and progress.

mod display;

pub use display::Display;

pub use crate::system::console::print;

use crate::system::console;
use crate::system::files::{STANDARD, write_text};
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::Path;

/// Prints text to standard output, or to standard error if JSON goes to standard output.
///
/// # Errors
/// As for [`print()`]. Standard error never fails.
pub fn print_beside(json: Option<&Path>, text: &str) -> Result<()> {
    if json == Some(Path::new(STANDARD)) {
        console::note(text);
        return Ok(());
    }
    print(text)
}

/// Figures with what all JSON of this program begins with.
#[derive(Serialize)]
struct Envelope<'a, T> {
    /// Incremented when a key is removed or changes meaning.
    schema: u32,
    version: &'static str,
    #[serde(flatten)]
    figures: &'a T,
}

/// Writes `figures` as JSON, which begins with its `schema`.
///
/// # Errors
/// As [`write_json`].
pub fn write_figures(schema: u32, figures: &impl Serialize, target: &Path) -> Result<()> {
    write_json(&Envelope { schema, version: env!("CARGO_PKG_VERSION"), figures }, target)
}

/// Writes `value` as JSON, followed by a newline.
///
/// # Errors
/// If the file or standard output cannot be written, or JSON cannot represent the value.
pub fn write_json(value: &impl Serialize, target: &Path) -> Result<()> {
    let text = serde_json::to_string_pretty(value).context("cannot write the figures as JSON")? + "\n";
    if target == Path::new(STANDARD) {
        return console::write_out(&text);
    }
    Ok(write_text(target, &text)?)
}
