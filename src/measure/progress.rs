//! Progress of a measurement, on standard error.

use crate::system::terminal::{Display, ProgressChoice};
use std::time::Duration;

const BAR_STEPS: f64 = 1000.0;

/// Shows the current step, the share done and the remaining time.
pub(super) struct Progress {
    pub display: Display,
    done: f64,
    total: f64,
}

impl Progress {
    /// `total` is the expected work, in any unit.
    pub fn new(choice: ProgressChoice, total: f64) -> Self {
        let template = "[{bar:24}] {eta} left, {wide_msg}";
        let display = Display::new(choice, BAR_STEPS as u64, template, "", Duration::ZERO);
        Progress { display, done: 0.0, total: total.max(f64::MIN_POSITIVE) }
    }

    /// Shows the step `what`.
    pub fn at(&mut self, what: &str) {
        let share = (self.done / self.total).min(1.0);
        self.display.announce((share * BAR_STEPS) as u64, || format!("{:3.0} % {what}", 100.0 * share));
    }

    pub fn finished(&mut self, amount: f64) {
        self.done += amount;
    }
}
