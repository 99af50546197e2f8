//! The progress of a gallery, on standard error.

use super::{Event, Work};
use crate::cli::ProgressChoice;
use crate::describe::seconds;
use crate::progressive::Phase;
use crate::terminal::Display;
use std::time::{Duration, Instant};

/// Interval of progress lines when there is no terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// Steps of the bar.
const STEPS: f64 = 1000.0;

/// Least part of the work after which the remaining time is predicted.
const PREDICTED_FROM: f64 = 0.02;

/// The progress of all stills.
pub struct StillProgress {
    display: Display,
    begin: Instant,
}

impl StillProgress {
    /// Depends on `choice` and on whether there is a terminal.
    pub fn new(choice: ProgressChoice) -> Self {
        let display = Display::new(choice, STEPS as u64, "[{bar:24}] {wide_msg}", "", LINE_INTERVAL);
        StillProgress { display, begin: Instant::now() }
    }

    /// Shows what happens.
    pub fn tell(&mut self, event: &Event<'_>) {
        match event {
            Event::Rendering(work) => {
                let elapsed = self.begin.elapsed();
                self.display.update((work.share * STEPS) as u64, || words(work, elapsed));
            }
            Event::Warning(warning) => self.display.say(&format!("warning: {warning}")),
            Event::Finished(_) => {}
        }
    }

    /// Hides the bar while `print` writes to the terminal.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        self.display.above(print)
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.display.clear();
    }
}

fn words(work: &Work<'_>, elapsed: Duration) -> String {
    let Work { stage, number, count, status, share } = work;
    let state = match status.phase {
        Phase::Preparing => "preparing the scene".to_owned(),
        _ => {
            let error = status.error.map_or_else(String::new, |error| format!(", error {:.1e}", error.rmse));
            format!("{} of {} spp{error}", status.samples_per_pixel, status.planned_samples_per_pixel)
        }
    };
    let left = elapsed.as_secs_f64() * (1.0 - share) / share.max(f64::MIN_POSITIVE);
    let left = if *share < PREDICTED_FROM { String::new() } else { format!(", {} left", seconds(left)) };
    format!("{number} of {count}, {}: {state}{left}", stage.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;
    use crate::progressive::Status;
    use crate::stages::Stage;

    #[test]
    fn the_time_left_is_that_of_the_rest() {
        let status = Status {
            phase: Phase::Tracing,
            samples_per_pixel: 16,
            planned_samples_per_pixel: 64,
            ..Status::default()
        };
        let said = |share| {
            let work = Work { stage: &Stage::ALL[0], number: 2, count: 9, status: &status, share };
            words(&work, Duration::from_secs(60))
        };
        assert_eq!(said(0.25), "2 of 9, ppm-tiny: 16 of 64 spp, 3 min 00 s left");
        assert_eq!(said(0.01), "2 of 9, ppm-tiny: 16 of 64 spp", "too early to tell");
    }

    #[test]
    fn the_time_left_is_told_from_a_fiftieth_of_the_work_on() {
        let mut status = Status::default();
        let said = |status: &Status, share| {
            let work = Work { stage: &Stage::ALL[0], number: 1, count: 1, status, share };
            words(&work, Duration::from_secs(1))
        };
        status.phase = Phase::Preparing;
        assert_eq!(said(&status, 0.02), "1 of 1, ppm-tiny: preparing the scene, 49.0 s left");
        assert_eq!(said(&status, 0.019), "1 of 1, ppm-tiny: preparing the scene");
        status.phase = Phase::Tracing;
        (status.samples_per_pixel, status.planned_samples_per_pixel) = (4, 8);
        status.error = Some(ErrorEstimate { rmse: 0.0123, rmse_deviation: 0.0, rel_mse: 0.0 });
        assert_eq!(said(&status, 1.0), "1 of 1, ppm-tiny: 4 of 8 spp, error 1.2e-2, 0.0 s left");
    }
}
