//! Standard output and standard error. All of the program's text goes through this module.
//!
//! Text on standard error is informational: a closed pipe or a full device never ends a run. Text on standard output is
//! a result: if it cannot be written, the caller gets an error.

use anyhow::{Result, anyhow};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

/// Standard error while [`foreign`](super::foreign) redirects it.
pub(super) static STANDARD_ERROR: Mutex<Option<File>> = Mutex::new(None);

/// Prints lines to standard error, without control characters. Failures are ignored.
pub fn note(text: &str) {
    let text = harmless(text.trim_end_matches('\n')) + "\n";
    let write = |to: &mut dyn Write| to.write_all(text.as_bytes()).and_then(|()| to.flush());
    let _ = match &mut *STANDARD_ERROR.lock().unwrap_or_else(PoisonError::into_inner) {
        Some(file) => write(file),
        None => write(&mut io::stderr().lock()),
    };
}

/// Prints a result for a person to standard output, without control characters.
///
/// # Errors
/// If the reader has gone away or the device is full.
pub fn print(text: &str) -> Result<()> {
    write_out(&harmless(text))
}

/// Prints a result to standard output unchanged, for other programs or with the program's own colours. Names in
/// coloured text must have gone through [`printable`].
///
/// # Errors
/// As for [`print()`].
pub fn write_out(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| {
        anyhow!(
            "cannot write to standard output: {error}; keep its reader running, or write to a disk with free space"
        )
    })
}

/// Makes a name from outside safe to print as part of one line: control characters, line ends and marks that change the
/// writing direction become escapes such as `\u{1b}`.
pub fn printable(name: &str) -> Cow<'_, str> {
    let steers = |c: char| {
        c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    escaped(name, steers)
}

/// Lines that cannot control a terminal.
fn harmless(text: &str) -> String {
    escaped(text, |c| c.is_control() && !matches!(c, '\n' | '\t')).into_owned()
}

/// Longest line of a message about what the user gave, characters.
const LINE: usize = 320;

/// A message about what the user gave, which may be as long as a file: the middle of a long line is left out.
pub fn brief(text: &str) -> String {
    let cut = |line: &str| match harmless(line) {
        line if line.chars().count() <= LINE => line,
        line => {
            let ends = [0, line.chars().count() - LINE / 2];
            ends.map(|skip| line.chars().skip(skip).take(LINE / 2).collect::<String>()).join(" … ")
        }
    };
    text.lines().map(cut).collect::<Vec<String>>().join("\n")
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let escape = |c: char| if is_escaped(c) { c.escape_default().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(escape).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_controls_a_terminal() {
        let hostile = "a\x1b[2Jb\u{9b}31mc\rd\u{7}e\tö東\n";
        assert_eq!(harmless(hostile), "a\\u{1b}[2Jb\\u{9b}31mc\\rd\\u{7}e\tö東\n");
        assert_eq!(printable("a\nb\tc\u{202e}d\u{2028}e"), "a\\nb\\tc\\u{202e}d\\u{2028}e");
        assert!(matches!(printable("plain: öß 東"), Cow::Borrowed(_)));
    }
}
