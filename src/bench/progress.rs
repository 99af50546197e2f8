//! Counts runs on standard error.

use crate::cli::ProgressChoice;
use crate::terminal::Display;
use std::time::Duration;

/// Runs that are done, of all.
pub struct Progress {
    display: Display,
    done: u64,
}

impl Progress {
    /// Of `steps` runs. Where there is no terminal, each has a line.
    pub fn new(choice: ProgressChoice, steps: u64) -> Self {
        let template = "[{bar:24}] {pos} of {len} runs, {wide_msg}";
        Progress { display: Display::new(choice, steps, template, "", Duration::ZERO), done: 0 }
    }

    /// `what` begins.
    pub fn begin(&mut self, what: &str) {
        self.display.announce(self.done, || what.to_owned());
    }

    /// A run is done.
    pub fn step(&mut self) {
        self.done += 1;
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.display.clear();
    }
}
