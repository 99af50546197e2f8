//! What is wrong with the texts of the page, each with file and line.

use std::fmt;
use thiserror::Error;

/// A fault of a text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fault {
    /// Path in the checkout.
    pub file: String,
    /// Line, counted from 1; 0 if the fault is that of the whole file.
    pub line: usize,
    /// What is wrong, and what to do.
    pub message: String,
}

impl Fault {
    /// A fault at a line.
    pub fn new(file: &str, line: usize, message: impl fmt::Display) -> Self {
        Fault { file: file.to_owned(), line, message: message.to_string() }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.message),
            line => write!(f, "{}:{line}: {}", self.file, self.message),
        }
    }
}

/// All faults of the texts, in the order of files and lines; at least one.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}", listed(.0))]
pub struct Faults(pub Vec<Fault>);

fn listed(faults: &[Fault]) -> String {
    let lines: Vec<String> = faults.iter().map(|fault| format!("\n  {fault}")).collect();
    let count = if faults.len() == 1 { "a fault".to_owned() } else { format!("{} faults", faults.len()) };
    format!("the texts of the page have {count}:{}", lines.concat())
}

/// The line of a byte position, counted from 1.
pub fn line_of(text: &str, position: usize) -> usize {
    1 + text.bytes().take(position).filter(|byte| *byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_name_file_and_line() {
        let faults = Faults(vec![Fault::new("a.md", 3, "no such figure"), Fault::new("b.md", 0, "is empty")]);
        assert_eq!(
            faults.to_string(),
            "the texts of the page have 2 faults:\n  a.md:3: no such figure\n  b.md: is empty"
        );
        assert_eq!([line_of("a\nb\n", 0), line_of("a\nb\n", 2)], [1, 2]);
    }
}
