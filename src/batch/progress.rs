//! The progress of a picture: samples, speed and remaining time.

use crate::progressive::describe::seconds;
use crate::progressive::{Phase, Plan, Status};
use crate::system::terminal::{Display, ProgressChoice};
use std::time::Duration;

/// Steps of the bar of a picture.
pub(super) const STEPS: u64 = 1000;

/// How the progress of `steps` is shown. Without a terminal, there is a line every five seconds.
pub(super) fn display(choice: ProgressChoice, steps: u64, name: &str) -> Display {
    Display::new(choice, steps, "{prefix} [{bar:24}] {wide_msg}", name, Duration::from_secs(5))
}

/// Shows the state of a render that has taken `elapsed` so far.
pub(super) fn show(display: &mut Display, plan: &Plan, status: &Status, elapsed: Duration) {
    let left = seconds_left(plan, status);
    let done = elapsed.as_secs_f64();
    // The first step until the end can be predicted.
    let share = left.map_or(0.0, |left| done / (done + left).max(f64::MIN_POSITIVE));
    display.update((share * STEPS as f64) as u64, || so_far(status, elapsed, left));
}

/// The render's progress. `elapsed` is the time since its start, and `left` the seconds to its end, if predictable.
fn so_far(status: &Status, elapsed: Duration, left: Option<f64>) -> String {
    if status.phase == Phase::Preparing {
        return "preparing the scene".to_owned();
    }
    let error = status.error.map_or_else(String::new, |e| format!("error {:.2e}, ", e.rmse));
    let left = left.map_or_else(String::new, |left| format!("{} left, ", seconds(left)));
    format!(
        "{error}{} spp, {left}{}, {:.1} Mpaths/s",
        status.samples_per_pixel,
        seconds(elapsed.as_secs_f64()),
        status.paths_per_second() / 1e6,
    )
}

/// Seconds until the first stop condition is met, if that can be predicted.
fn seconds_left(plan: &Plan, status: &Status) -> Option<f64> {
    let added = status.added();
    if added == 0 {
        return None;
    }
    let per_sample = status.trace.as_secs_f64() / added as f64;
    let held = status.samples_per_pixel as f64;
    let by_samples = (status.planned_samples_per_pixel as f64 - held) * per_sample;
    let by_time = plan.stop.time_limit().map(|limit| limit.saturating_sub(status.elapsed).as_secs_f64());
    // The error falls at least with the square root of the samples.
    let by_noise = plan
        .stop
        .noise
        .zip(status.error)
        .map(|(target, error)| held * ((error.rmse / target).powi(2) - 1.0).max(0.0) * per_sample);
    [Some(by_samples), by_time, by_noise].into_iter().flatten().reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;

    #[test]
    fn time_left_is_that_of_the_first_condition() {
        let mut status = Status {
            samples_per_pixel: 100,
            planned_samples_per_pixel: 1100,
            trace: Duration::from_secs(10),
            elapsed: Duration::from_secs(10),
            error: Some(ErrorEstimate { rmse: 0.02, rmse_deviation: 0.0, rel_mse: 0.1 }),
            ..Status::default()
        };
        let mut plan = Plan::samples(1100);
        assert_eq!(seconds_left(&plan, &status), None);
        let info =
            crate::job::render::BackendInfo { name: "cpu", device: String::new(), lanes: 1, threads: 1 };
        status.contributions =
            vec![crate::progressive::Contribution { backend: info, samples_per_pixel: 100 }];
        assert_eq!(seconds_left(&plan, &status), Some(100.0));
        // Samples of earlier runs took none of this run's time.
        status.contributions[0].samples_per_pixel = 50;
        assert_eq!(seconds_left(&plan, &status), Some(200.0));
        status.contributions[0].samples_per_pixel = 100;
        plan.stop.seconds = Some(60.0);
        assert_eq!(seconds_left(&plan, &status), Some(50.0));
        plan.stop.noise = Some(0.01);
        assert!((seconds_left(&plan, &status).unwrap() - 30.0).abs() < 1e-9);
        // The last pass has met the condition.
        plan.stop.noise = Some(0.05);
        assert_eq!(seconds_left(&plan, &status), Some(0.0));
        (plan.stop.noise, status.elapsed) = (None, Duration::from_secs(61));
        assert_eq!(seconds_left(&plan, &status), Some(0.0));
    }
}
