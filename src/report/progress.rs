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
        let (share, left) = so_far(self.done + within, self.total, self.begin.elapsed());
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

/// The share of `total` that is done, and how long the rest will take, in words, if `done` took `elapsed`.
fn so_far(done: f64, total: f64, elapsed: Duration) -> (f64, String) {
    let share = (done / total).clamp(0.0, 1.0);
    let left = (share > 0.02).then(|| elapsed.mul_f64((1.0 - share) / share));
    (share, left.map_or_else(String::new, |left| format!(", {} left", HumanDuration(left))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_share_that_is_done() {
        let ten = Duration::from_secs(10);
        assert_eq!(so_far(2.0, 8.0, ten), (0.25, ", 30 seconds left".to_owned()));
        assert_eq!(so_far(8.0, 16.0, ten), (0.5, ", 10 seconds left".to_owned()));
        // At the beginning, nothing can be told.
        assert_eq!(so_far(2.0, 100.0, ten), (0.02, String::new()));
        assert_eq!(so_far(4.0, 100.0, ten), (0.04, ", 4 minutes left".to_owned()));
        assert_eq!(so_far(9.0, 8.0, ten).0, 1.0);
    }

    #[test]
    fn what_is_finished_adds_up() {
        let mut progress = Progress::new(ProgressChoice::Off, 10.0);
        progress.finished(2.0);
        progress.finished(3.0);
        assert_eq!((progress.done, progress.total), (5.0, 10.0));
        assert!(Progress::new(ProgressChoice::Off, 0.0).total > 0.0);
    }
}
