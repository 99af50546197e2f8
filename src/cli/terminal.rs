//! Output of the programs without a window: text for people, JSON for other programs, and progress on standard error (a
//! bar on a terminal, otherwise a line from time to time, or nothing).

pub use crate::system::console::print;

use super::ProgressChoice;
use crate::system::console;
use crate::system::files::{STANDARD, write_text};
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

/// How progress is shown.
pub enum Display {
    /// A progress bar with its template.
    Bar(ProgressBar, &'static str),
    /// Single lines.
    Lines {
        /// When the next line may be printed.
        next: Instant,
        /// Minimum time between two lines.
        interval: Duration,
    },
    /// Nothing.
    Off,
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
        match (choice, stderr().is_terminal()) {
            (ProgressChoice::Off, _) | (ProgressChoice::Auto, false) => Display::Off,
            (ProgressChoice::On, false) => Display::Lines { next: Instant::now(), interval },
            (_, true) => Display::bar(ProgressDrawTarget::stderr(), steps, template, prefix),
        }
    }

    fn bar(target: ProgressDrawTarget, steps: u64, template: &'static str, prefix: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps), target);
        bar.set_prefix(console::printable(prefix).into_owned());
        Display::Bar(bar, template)
    }

    /// Shows `text` at step `position`. A line is printed only if one is due.
    pub fn update(&mut self, position: u64, text: impl FnOnce() -> String) {
        match self {
            Display::Lines { next, .. } if Instant::now() < *next => {}
            _ => self.announce(position, text),
        }
    }

    /// Shows `text` at step `position` even if no line is due. A narrow terminal shows only the text.
    pub fn announce(&mut self, position: u64, text: impl FnOnce() -> String) {
        match self {
            Display::Bar(bar, template) => {
                let is_narrow = terminal_size().is_some_and(|(Width(columns), _)| columns < WIDE);
                let template = if is_narrow { "{wide_msg}" } else { *template };
                if let Ok(style) = ProgressStyle::with_template(template) {
                    bar.set_style(style.progress_chars("=> "));
                }
                bar.set_position(position);
                bar.set_message(console::printable(&text()).into_owned());
            }
            Display::Lines { next, interval } => {
                *next = Instant::now() + *interval;
                console::note(&text());
            }
            Display::Off => {}
        }
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
        match self {
            Display::Bar(bar, ..) => bar.suspend(print),
            _ => print(),
        }
    }

    /// Removes the bar.
    pub fn clear(&self) {
        if let Display::Bar(bar, ..) = self {
            bar.finish_and_clear();
        }
    }
}

/// Columns that a bar needs.
const WIDE: u16 = 80;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_rate_limited_unless_announced() {
        let interval = Duration::from_secs(3600);
        let mut display = Display::Lines { next: Instant::now(), interval };
        let mut printed = Vec::new();
        let mut show = |display: &mut Display, word: &'static str, must: bool| {
            let words = || {
                printed.push(word);
                word.to_owned()
            };
            if must { display.announce(1, words) } else { display.update(1, words) }
        };
        show(&mut display, "first", false);
        show(&mut display, "too soon", false);
        show(&mut display, "announced", true);
        show(&mut display, "too soon again", false);
        show(&mut Display::Off, "nothing", true);
        assert_eq!(printed, ["first", "announced"]);
    }

    #[test]
    fn bar_escapes_control_characters() {
        let mut display =
            Display::bar(ProgressDrawTarget::hidden(), 4, "{prefix} [{bar:24}] {wide_msg}", "a\u{1b}b");
        let Display::Bar(bar, ..) = &display else { panic!("no bar") };
        let bar = bar.clone();
        display.update(2, || "half\u{1b} done".to_owned());
        assert_eq!((bar.position(), bar.length()), (2, Some(4)));
        assert_eq!((bar.prefix(), bar.message()), ("a\\u{1b}b".to_owned(), "half\\u{1b} done".to_owned()));
        display.clear();
        assert!(bar.is_finished());
    }
}
