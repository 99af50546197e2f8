//! Progress of the report and the remaining time.

use crate::cli::ProgressChoice;
use crate::terminal::Display;
use indicatif::HumanDuration;
use std::time::{Duration, Instant};

/// Interval of progress lines when there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Progress as a fraction of the expected time.
pub(super) struct Progress {
    display: Display,
    begin: Instant,
    done: f64,
    total: f64,
}

impl Progress {
    /// `total` is the expected time of the whole report, in any unit.
    pub(super) fn new(choice: ProgressChoice, total: f64) -> Self {
        let display = Display::new(choice, STEPS as u64, "[{bar:24}] {wide_msg}", "", LINE_INTERVAL);
        Progress { display, begin: Instant::now(), done: 0.0, total: total.max(f64::MIN_POSITIVE) }
    }

    /// Shows `what`, which is not finished and has taken `within` of the expected time.
    pub(super) fn at(&mut self, what: &str, within: f64) {
        let share = ((self.done + within) / self.total).clamp(0.0, 1.0);
        let left = (share > 0.02).then(|| self.begin.elapsed().mul_f64((1.0 - share) / share));
        let left = left.map_or_else(String::new, |left| format!(", {} left", HumanDuration(left)));
        let percent = if self.display.is_bar() { String::new() } else { format!("{:3.0} % ", 100.0 * share) };
        self.display.update((share * STEPS) as u64, || format!("{percent}{what}{left}"));
    }

    /// Counts something finished that was expected to take `expected`.
    pub(super) fn finished(&mut self, expected: f64) {
        self.done += expected;
    }

    /// Removes the bar.
    pub(super) fn clear(&self) {
        self.display.clear();
    }
}
