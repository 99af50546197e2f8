//! Progress of a measurement, on standard error.

use crate::cli::ProgressChoice;
use crate::cli::terminal::Display;
use indicatif::HumanDuration;
use std::time::{Duration, Instant};

const BAR_STEPS: f64 = 1000.0;

/// Shows the current step, the share done and the remaining time.
pub(super) struct Progress {
    display: Display,
    begin: Instant,
    done: f64,
    total: f64,
}

impl Progress {
    /// `total` is the expected work, in any unit.
    pub fn new(choice: ProgressChoice, total: f64) -> Self {
        let display = Display::new(choice, BAR_STEPS as u64, "[{bar:24}] {wide_msg}", "", Duration::ZERO);
        Progress { display, begin: Instant::now(), done: 0.0, total: total.max(f64::MIN_POSITIVE) }
    }

    /// Shows the step `what`.
    pub fn at(&mut self, what: &str) {
        let share = (self.done / self.total).min(1.0);
        let left = time_left(share, self.begin.elapsed())
            .map_or_else(String::new, |left| format!(", {} left", HumanDuration(left)));
        self.display.announce((share * BAR_STEPS) as u64, || format!("{:3.0} % {what}{left}", 100.0 * share));
    }

    pub fn finished(&mut self, amount: f64) {
        self.done += amount;
    }

    /// Hides the bar while `print` writes to the terminal.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        self.display.above(print)
    }

    /// Removes the bar.
    pub fn clear(&self) {
        self.display.clear();
    }
}

/// `None` until there is enough progress to extrapolate.
fn time_left(share: f64, elapsed: Duration) -> Option<Duration> {
    (share > 0.02).then(|| elapsed.mul_f64((1.0 - share) / share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_extrapolated() {
        let left = |share| time_left(share, Duration::from_secs(10)).map(|left| left.as_secs());
        assert_eq!([0.25, 0.5, 1.0, 0.02].map(left), [Some(30), Some(10), Some(0), None]);
    }
}
