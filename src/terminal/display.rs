//! Progress on standard error: a bar on a terminal, now and then a line elsewhere, or nothing.

use crate::cli::ProgressChoice;
use crate::console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// How progress is shown.
pub enum Display {
    /// As a bar.
    Bar(ProgressBar),
    /// As lines.
    Lines {
        /// When the next may come.
        next: Instant,
        /// Time between two.
        interval: Duration,
    },
    /// Not at all.
    Off,
}

impl Display {
    /// As `choice` and the terminal have it. The bar has `steps` and looks as indicatif's `template` says, with
    /// `prefix` for what that calls so; lines come `interval` apart.
    pub fn new(choice: ProgressChoice, steps: u64, template: &str, prefix: &str, interval: Duration) -> Self {
        match (choice, stderr().is_terminal()) {
            (ProgressChoice::Off, _) | (ProgressChoice::Auto, false) => Display::Off,
            (ProgressChoice::On, false) => Display::Lines { next: Instant::now(), interval },
            (_, true) => {
                let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
                if let Ok(style) = ProgressStyle::with_template(template) {
                    bar.set_style(style.progress_chars("=> "));
                }
                bar.set_prefix(console::printable(prefix).into_owned());
                Display::Bar(bar)
            }
        }
    }

    /// Whether it is a bar, which tells the share by its length.
    pub fn is_bar(&self) -> bool {
        matches!(self, Display::Bar(_))
    }

    /// Shows `words` at step `position`; as a line only if one is due.
    pub fn update(&mut self, position: u64, words: impl FnOnce() -> String) {
        match self {
            Display::Lines { next, .. } if Instant::now() < *next => {}
            _ => self.announce(position, words),
        }
    }

    /// Shows `words` at step `position`, whether a line is due or not.
    pub fn announce(&mut self, position: u64, words: impl FnOnce() -> String) {
        match self {
            Display::Bar(bar) => {
                bar.set_position(position);
                bar.set_message(console::printable(&words()).into_owned());
            }
            Display::Lines { next, interval } => {
                *next = Instant::now() + *interval;
                console::note(&words());
            }
            Display::Off => {}
        }
    }

    /// Says something that must be read, whatever the display.
    pub fn say(&self, message: &str) {
        match self {
            Display::Bar(bar) => bar.suspend(|| console::note(message)),
            Display::Lines { .. } | Display::Off => console::note(message),
        }
    }

    /// Lets `print` write to the terminal, above the bar.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        match self {
            Display::Bar(bar) => bar.suspend(print),
            Display::Lines { .. } | Display::Off => print(),
        }
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        if let Display::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
