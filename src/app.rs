//! The window.

use anyhow::{Result, bail};
use std::process::ExitCode;

/// Opens the window.
///
/// # Errors
/// This version has none.
pub fn run() -> Result<ExitCode> {
    bail!("this version has no window yet; add --batch to render to a file, or --help for all options")
}
