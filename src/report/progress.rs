//! Progress on standard error: a bar with the time left on a terminal, now and then a line elsewhere, or nothing.

use crate::cli::ProgressChoice;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Time between lines where there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// How far the report is, by shares of its expected time.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    next_line: Option<Instant>,
    begin: Instant,
    done: f64,
    total: f64,
}

impl Progress {
    /// `total` is the expected time of everything, in any unit.
    pub(super) fn new(choice: ProgressChoice, total: f64) -> Self {
        let is_terminal = stderr().is_terminal();
        let bar = (is_terminal && choice != ProgressChoice::Off).then(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS as u64), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template("[{bar:24}] {wide_msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar
        });
        let next_line = (!is_terminal && choice == ProgressChoice::On).then(Instant::now);
        Progress { bar, next_line, begin: Instant::now(), done: 0.0, total: total.max(f64::MIN_POSITIVE) }
    }

    /// `within` of the expected time has been spent on `what`, which is not done yet.
    pub(super) fn at(&mut self, what: &str, within: f64) {
        let share = ((self.done + within) / self.total).clamp(0.0, 1.0);
        let left = (share > 0.02).then(|| self.begin.elapsed().mul_f64((1.0 - share) / share));
        let left = left.map_or_else(String::new, |left| format!(", {} left", HumanDuration(left)));
        if let Some(bar) = &self.bar {
            bar.set_position((share * STEPS) as u64);
            bar.set_message(format!("{what}{left}"));
        }
        if let Some(next) = self.next_line.as_mut().filter(|next| Instant::now() >= **next) {
            *next = Instant::now() + LINE_INTERVAL;
            eprintln!("{:3.0} % {what}{left}", 100.0 * share);
        }
    }

    /// What took `expected` is done.
    pub(super) fn finished(&mut self, expected: f64) {
        self.done += expected;
    }

    /// Takes the bar away.
    pub(super) fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
