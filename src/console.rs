//! Standard output and standard error. All of the program's text goes through this module.
//!
//! Text on standard error is informational: a closed pipe or a full device never ends a run. Text on standard output is
//! a result: if it cannot be written, the caller gets an error. In both cases a text may contain names, values and
//! messages from outside, which must neither control a terminal nor flood it.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::io::{self, Write};

/// Longest line for a person, in characters. The middle of longer lines is left out.
const LINE_LIMIT: usize = 1200;

/// Most lines of a message. Results may have more.
const MESSAGE_LINES: usize = 60;

/// Escape sequences that the program itself uses: bold, faint, green, bold red, and reset.
const OWN_SEQUENCES: [&str; 5] = ["\x1b[1m", "\x1b[2m", "\x1b[32m", "\x1b[1;31m", "\x1b[0m"];

/// Prints one or more lines to standard error. Nothing happens if that fails.
pub fn note(text: &str) {
    say(&message(text));
}

/// The lines of a message, as many as may be shown.
fn message(text: &str) -> String {
    let mut lines = text.trim_end_matches('\n').split('\n');
    let mut said: String = lines.by_ref().take(MESSAGE_LINES).map(|line| presentable(line) + "\n").collect();
    let left = lines.count();
    if left > 0 {
        // Writing to a string cannot fail.
        let _ = writeln!(said, "... and {left} more lines");
    }
    said
}

/// As [`note`], for commands and other texts to copy: nothing is left out of them.
pub fn note_whole(text: &str) {
    say(&(text.split('\n').map(harmless).collect::<Vec<_>>().join("\n") + "\n"));
}

/// As [`note`], for a text of any length that may contain the program's own colours: see [`print_painted`].
pub fn note_painted(text: &str) {
    say(&painted(text));
}

fn say(text: &str) {
    let mut stderr = io::stderr().lock();
    let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
}

/// Prints a result for a person to standard output.
///
/// # Errors
/// If the reader has gone away or the device is full.
pub fn print(text: &str) -> io::Result<()> {
    write_out(&text.split_inclusive('\n').map(presentable).collect::<String>())
}

/// As [`print()`], for a text with the program's own colours. Names from outside must have gone through [`printable`].
///
/// # Errors
/// As for [`print()`].
pub fn print_painted(text: &str) -> io::Result<()> {
    write_out(&painted(text))
}

/// Prints a result for another program to standard output, unchanged.
///
/// # Errors
/// As for [`print()`].
pub fn write_out(text: &str) -> io::Result<()> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    stdout.flush()
}

/// `text` as one line that cannot control a terminal: control characters, line ends and marks that change the writing
/// direction become `\u{1b}` and the like.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.chars().any(|c| is_steering(c) || is_blank_control(c)) {
        return Cow::Borrowed(text);
    }
    let escaped = |c: char| {
        if is_steering(c) || is_blank_control(c) { c.escape_default().to_string() } else { c.to_string() }
    };
    Cow::Owned(text.chars().map(escaped).collect())
}

/// JSON that a terminal can show safely: some control characters are legal in JSON, and these are escaped.
pub fn printable_json(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_steering(c) {
            // Such characters occur only within strings, and all of them are in the basic plane.
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    shown
}

/// A line, with or without its end, that cannot control a terminal and is not too long to read.
fn presentable(line: &str) -> String {
    let (line, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
    harmless(&shortened(line.trim_end_matches('\r'))) + end
}

/// A line that cannot control a terminal.
fn harmless(line: &str) -> String {
    let escape = |c: char| if is_steering(c) { c.escape_default().to_string() } else { c.to_string() };
    line.chars().map(escape).collect()
}

/// The line without its middle if it is too long.
fn shortened(line: &str) -> Cow<'_, str> {
    let count = line.chars().count();
    if count <= LINE_LIMIT {
        return Cow::Borrowed(line);
    }
    let kept = LINE_LIMIT / 2;
    let at = |index: usize| line.char_indices().nth(index).map_or(line.len(), |(at, _)| at);
    let (start, end) = (&line[..at(kept)], &line[at(count - kept)..]);
    Cow::Owned(format!("{start} ... ({} characters left out) ... {end}", count - 2 * kept))
}

/// Makes everything but the program's own colours presentable.
fn painted(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\x1b') {
        let (before, from) = rest.split_at(at);
        shown.extend(before.split_inclusive('\n').map(presentable));
        let own = OWN_SEQUENCES.into_iter().find(|own| from.starts_with(own));
        let taken = own.map_or(1, str::len);
        shown.push_str(own.unwrap_or("\\u{1b}"));
        rest = &from[taken..];
    }
    shown.extend(rest.split_inclusive('\n').map(presentable));
    shown
}

/// Whether a character can control a terminal or change the order in which text is shown. Tabs and line ends are
/// harmless where lines are expected.
fn is_steering(c: char) -> bool {
    let turns = matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let breaks = matches!(c, '\u{2028}' | '\u{2029}');
    turns || breaks || (c.is_control() && !is_blank_control(c))
}

fn is_blank_control(c: char) -> bool {
    matches!(c, '\n' | '\t')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_a_terminal() {
        let hostile = "a\x1b[2Jb\u{9b}31mc\rd\u{7}e\u{202e}f\u{2028}g\tö東";
        let shown = presentable(hostile);
        assert_eq!(shown, "a\\u{1b}[2Jb\\u{9b}31mc\\rd\\u{7}e\\u{202e}f\\u{2028}g\tö東");
        assert_eq!(printable("a\nb\tc"), "a\\nb\\tc");
        assert_eq!(printable("plain: öß 東"), "plain: öß 東");
        let json = serde_json::to_string(hostile).unwrap();
        let shown = printable_json(&json);
        assert!(!shown.chars().any(is_steering), "{shown}");
        assert_eq!(serde_json::from_str::<String>(&shown).unwrap(), hostile);
    }

    #[test]
    fn long_lines_lose_their_middle() {
        let line = format!("begin {} end\n", "ö".repeat(100_000));
        let shown = presentable(&line);
        assert!(shown.starts_with("begin ö") && shown.ends_with("ö end\n"), "{shown}");
        assert!(shown.contains("98810 characters left out") && shown.chars().count() < 1300, "{shown}");
        assert_eq!(presentable("short\n"), "short\n");
        let longest = "x".repeat(LINE_LIMIT);
        assert_eq!(presentable(&longest), longest);
    }

    #[test]
    fn only_own_colours_pass() {
        let text = "\x1b[1mscene\x1b[0m    a\x1b[5mb\n\x1b[1;31mx\x1b[0m\x1b]0;title\x07";
        assert_eq!(
            painted(text),
            "\x1b[1mscene\x1b[0m    a\\u{1b}[5mb\n\x1b[1;31mx\x1b[0m\\u{1b}]0;title\\u{7}"
        );
    }

    #[test]
    fn a_message_of_many_lines_says_how_many_are_left_out() {
        let lines = |count: usize| (0..count).map(|number| format!("line {number}\n")).collect::<String>();
        assert_eq!(message(&lines(60)), lines(60));
        assert_eq!(message(&lines(62)), lines(60) + "... and 2 more lines\n");
        assert_eq!(message("one"), "one\n");
        assert_eq!(message("a\r\nb\x1b\n\n"), "a\nb\\u{1b}\n");
    }
}
