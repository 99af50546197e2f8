//! Errors in the page's texts, with file and line.

use std::fmt;
use thiserror::Error;

#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}{}: {message}", if *.line == 0 { String::new() } else { format!(":{}", .line) })]
pub struct Fault {
    /// Path in the checkout.
    pub file: String,
    /// Counted from 1; 0 if the fault concerns the whole file.
    pub line: usize,
    /// What is wrong and how to fix it.
    pub message: String,
}

impl Fault {
    pub fn new(file: &str, line: usize, message: impl fmt::Display) -> Self {
        Fault { file: file.to_owned(), line, message: message.to_string() }
    }
}

/// The line of a byte position, counted from 1.
pub fn line_of(text: &str, position: usize) -> usize {
    1 + text.bytes().take(position).filter(|byte| *byte == b'\n').count()
}
