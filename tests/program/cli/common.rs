//! Small renders, and refusals.

pub use crate::common::program::{ends, film, json, json_file, names, succeeds};

use std::path::Path;
use tempfile::TempDir;

/// Renders a small picture, which must succeed. Returns standard output.
pub fn render(directory: &Path, arguments: &[&str]) -> String {
    succeeds(directory, &[&["--batch", "--size", "32x18", "--threads", "2"], arguments].concat())
}

pub fn temp() -> TempDir {
    tempfile::tempdir().unwrap()
}

pub fn refused(arguments: &[&str], parts: &[&str]) {
    refused_in(&temp(), arguments, parts);
}

pub fn refused_in(directory: &TempDir, arguments: &[&str], parts: &[&str]) {
    crate::common::program::refused(directory.path(), arguments, parts);
}
