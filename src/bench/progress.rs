//! Progress of the runs, on standard error.

use crate::cli::ProgressChoice;
use crate::terminal::Display;
use std::time::Duration;

/// The number of finished runs.
pub struct Progress {
    display: Display,
    /// How many runs are finished.
    pub done: u64,
}

impl Progress {
    /// For `steps` runs. Without a terminal, each run prints a line.
    pub fn new(choice: ProgressChoice, steps: u64) -> Self {
        let template = "[{bar:24}] {pos} of {len} runs, {wide_msg}";
        Progress { display: Display::new(choice, steps, template, "", Duration::ZERO), done: 0 }
    }

    /// Shows that `what` starts.
    pub fn begin(&mut self, what: &str) {
        self.display.announce(self.done, || what.to_owned());
    }

    /// Counts a finished run.
    pub fn step(&mut self) {
        self.done += 1;
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.display.clear();
    }
}
