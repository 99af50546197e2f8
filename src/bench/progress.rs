//! Progress on standard error: one line that counts runs, on a terminal; lines elsewhere if asked for.

use crate::cli::ProgressChoice;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};

/// Counts runs.
pub struct Progress {
    bar: Option<ProgressBar>,
    has_lines: bool,
}

impl Progress {
    /// Of `steps` runs.
    pub fn new(choice: ProgressChoice, steps: u64) -> Self {
        let is_terminal = stderr().is_terminal();
        let bar = (is_terminal && choice != ProgressChoice::Off).then(|| {
            let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("[{bar:24}] {pos} of {len} runs, {wide_msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        });
        Progress { bar, has_lines: !is_terminal && choice == ProgressChoice::On }
    }

    /// `what` begins.
    pub fn begin(&self, what: &str) {
        match &self.bar {
            Some(bar) => bar.set_message(what.to_owned()),
            None if self.has_lines => eprintln!("{what}"),
            None => {}
        }
    }

    /// A run is done.
    pub fn step(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// Takes the line away.
    pub fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
