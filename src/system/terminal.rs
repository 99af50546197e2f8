//! Output of the programs without a window: text for people, JSON for other programs, and progress on standard error (a
//! bar on a terminal, otherwise a line from time to time, or nothing).

pub use super::console::print;

use super::console;
use super::files::{STANDARD, write_text};
use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::time::{Duration, Instant};
use terminal_size::{Width, terminal_size};

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

/// Figures, after the header that all JSON of this program has.
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
/// If the file or standard output cannot be written, or JSON cannot represent the value.
pub fn write_figures(schema: u32, figures: &impl Serialize, target: &Path) -> Result<()> {
    let value = Envelope { schema, version: env!("CARGO_PKG_VERSION"), figures };
    let text = serde_json::to_string_pretty(&value).context("cannot write the figures as JSON")? + "\n";
    if target == Path::new(STANDARD) {
        return console::write_out(&text);
    }
    Ok(write_text(target, &text)?)
}

/// Whether progress is shown on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ProgressChoice {
    /// If standard error is a terminal
    Auto,
    /// Always; as lines if it is not a terminal
    On,
    /// Never
    Off,
}

/// Progress on standard error.
pub struct Display {
    /// Hidden unless it is shown on a terminal.
    bar: ProgressBar,
    template: &'static str,
    /// For lines: when the next one may be printed, and the minimum time between two.
    lines: Option<(Instant, Duration)>,
}

impl Display {
    /// Depends on `choice` and on whether there is a terminal. The bar has `steps` and looks as indicatif's
    /// `template` says, where `prefix` fills the placeholder of that name. Lines are at least `interval` apart.
    pub fn new(
        choice: ProgressChoice,
        steps: u64,
        template: &'static str,
        prefix: &str,
        interval: Duration,
    ) -> Self {
        let is_terminal = stderr().is_terminal();
        let has_bar = is_terminal && choice != ProgressChoice::Off;
        let target = if has_bar { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let has_lines = !is_terminal && choice == ProgressChoice::On;
        let bar = ProgressBar::with_draw_target(Some(steps), target);
        bar.set_prefix(console::printable(prefix).into_owned());
        Display { bar, template, lines: has_lines.then(|| (Instant::now(), interval)) }
    }

    /// Shows `text` at step `position`. A line is printed only if one is due.
    pub fn update(&mut self, position: u64, text: impl FnOnce() -> String) {
        if self.lines.is_none_or(|(next, _)| next <= Instant::now()) {
            self.announce(position, text);
        }
    }

    /// Shows `text` at step `position` even if no line is due. A narrow terminal shows only the text.
    pub fn announce(&mut self, position: u64, text: impl FnOnce() -> String) {
        let text = text();
        if let Some((next, interval)) = &mut self.lines {
            *next = Instant::now() + *interval;
            console::note(&text);
        }
        let is_narrow = terminal_size().is_some_and(|(Width(columns), _)| columns < WIDE);
        if let Ok(style) = ProgressStyle::with_template(if is_narrow { "{wide_msg}" } else { self.template })
        {
            self.bar.set_style(style.progress_chars("=> "));
        }
        self.bar.set_position(position);
        self.bar.set_message(console::printable(&text).into_owned());
    }

    /// Prints a message that must be read, even if progress is off.
    pub fn say(&self, message: &str) {
        self.above(|| console::note(message));
    }

    pub fn warn(&self, warning: &str) {
        self.say(&format!("warning: {warning}"));
    }

    /// Hides the bar while `print` writes to the terminal.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Columns that a bar needs.
const WIDE: u16 = 80;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_rate_limited_unless_announced() {
        let mut display = Display::new(ProgressChoice::Off, 4, "", "", Duration::ZERO);
        display.lines = Some((Instant::now(), Duration::from_secs(3600)));
        let mut printed = Vec::new();
        let mut show = |word: &'static str, must: bool| {
            let words = || {
                printed.push(word);
                word.to_owned()
            };
            if must { display.announce(1, words) } else { display.update(1, words) }
        };
        show("first", false);
        show("too soon", false);
        show("announced", true);
        show("too soon again", false);
        assert_eq!(printed, ["first", "announced"]);
    }

    #[test]
    fn bar_escapes_control_characters() {
        let template = "{prefix} [{bar:24}] {wide_msg}";
        let mut display = Display::new(ProgressChoice::Off, 4, template, "a\u{1b}b", Duration::ZERO);
        display.update(2, || "half\u{1b} done".to_owned());
        let bar = &display.bar;
        assert_eq!((bar.position(), bar.length()), (2, Some(4)));
        assert_eq!((bar.prefix(), bar.message()), ("a\\u{1b}b".to_owned(), "half\\u{1b} done".to_owned()));
    }
}
