//! How far the report is, and how long it will still take.

use crate::cli::ProgressChoice;
use crate::terminal::Display;
use indicatif::HumanDuration;
use std::time::{Duration, Instant};

/// Time between lines where there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// How far the report is, by shares of its expected time.
pub(super) struct Progress {
    display: Display,
    begin: Instant,
    done: f64,
    total: f64,
}

impl Progress {
    /// `total` is the expected time of everything, in any unit.
    pub(super) fn new(choice: ProgressChoice, total: f64) -> Self {
        let display = Display::new(choice, STEPS as u64, "[{bar:24}] {wide_msg}", "", LINE_INTERVAL);
        Progress { display, begin: Instant::now(), done: 0.0, total: total.max(f64::MIN_POSITIVE) }
    }

    /// `within` of the expected time has been spent on `what`, which is not done yet.
    pub(super) fn at(&mut self, what: &str, within: f64) {
        let share = ((self.done + within) / self.total).clamp(0.0, 1.0);
        let left = (share > 0.02).then(|| self.begin.elapsed().mul_f64((1.0 - share) / share));
        let left = left.map_or_else(String::new, |left| format!(", {} left", HumanDuration(left)));
        let percent = if self.display.is_bar() { String::new() } else { format!("{:3.0} % ", 100.0 * share) };
        self.display.update((share * STEPS) as u64, || format!("{percent}{what}{left}"));
    }

    /// What took `expected` is done.
    pub(super) fn finished(&mut self, expected: f64) {
        self.done += expected;
    }

    /// Takes the bar away.
    pub(super) fn clear(&self) {
        self.display.clear();
    }
}
