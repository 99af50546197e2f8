//! The plan of a progressive render: what to render, and when to stop.

use crate::job::render::SAMPLE_LIMIT;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::time::Duration;

/// The noise target is ignored until each pixel has this many samples, because earlier estimates are too rough.
pub const NOISE_TARGET_FIRST_SAMPLES: u64 = 16;

/// Stop conditions: the first one that is met ends the render. Without any, the render is endless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// The samples that every pixel should hold.
    pub samples: Option<u64>,
    /// Time limit in seconds, including preparation but not pauses. At least one pass is always rendered.
    pub seconds: Option<f64>,
    /// Target RMSE in linear radiance, as estimated from the halves.
    pub noise: Option<f64>,
    /// The picture whose error the target limits.
    pub noise_of: NoiseOf,
}

/// The picture whose error a noise target limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum NoiseOf {
    /// The film: see [`crate::film::Film::meets`].
    #[default]
    Film,
    /// The picture that is written with denoising: the denoised one, or the raw one if that is better. See
    /// [`crate::denoise::DenoisedError::upper_rmse`].
    Denoised,
}

impl Stop {
    /// The error below which the eye sees no further change in a picture on a screen.
    pub const NOISE: f64 = 0.002;

    /// Stops after this many samples per pixel.
    pub fn at_samples(samples: u64) -> Self {
        Stop { samples: Some(samples), ..Stop::default() }
    }

    /// The time limit as a duration.
    pub fn time_limit(&self) -> Option<Duration> {
        // Seconds that a duration cannot hold count as no limit.
        self.seconds.map(|seconds| Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX))
    }
}

/// Which samples to render, when to stop, and how long passes take.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The first sample of each pixel. Samples that are already in the film are skipped.
    pub first_sample: u64,
    pub stop: Stop,
    /// How long a pass should take, and the longest a stop should take. Commands are obeyed between passes.
    pub pass_target: Duration,
    /// For a preview, the samples of its first pass, a power of two. Its pictures are smoothed while they have few
    /// samples.
    pub preview: Option<u64>,
}

impl Plan {
    /// A pass duration so short that users do not notice it.
    pub const INTERACTIVE_PASS: Duration = Duration::from_millis(50);

    /// A pass duration so long that the overhead between passes is negligible.
    pub const BATCH_PASS: Duration = Duration::from_millis(900);

    /// All samples until `stop`, in interactive passes.
    pub fn until(stop: Stop) -> Self {
        Plan { first_sample: 0, stop, pass_target: Plan::INTERACTIVE_PASS, preview: None }
    }

    /// Samples `0..samples`, without other stop conditions, in interactive passes.
    pub fn samples(samples: u64) -> Self {
        Plan::until(Stop::at_samples(samples))
    }

    /// Renders until it is stopped by a command.
    pub fn endless() -> Self {
        Plan::until(Stop::default())
    }

    /// The planned duration of the first pass, once the time per sample is known. `None` if passes should start short, to
    /// show a picture or to estimate the error early.
    pub fn first_pass_target(&self) -> Option<Duration> {
        let is_long = self.pass_target >= Plan::BATCH_PASS && self.stop.noise.is_none();
        let limit = self.stop.time_limit().unwrap_or(Duration::MAX);
        is_long.then(|| self.pass_target.min(limit))
    }

    /// The duration of the passes after the first. Where a stop takes at most half a pass, long passes can be twice as
    /// long.
    pub fn later_pass_target(&self, stops_early: bool) -> Duration {
        match self.first_pass_target() {
            Some(_) if stops_early => 2 * self.pass_target,
            _ => self.pass_target,
        }
    }

    /// The samples that every pixel should hold.
    pub fn range(&self) -> Range<u64> {
        self.first_sample..self.stop.samples.unwrap_or(SAMPLE_LIMIT)
    }
}

/// Reports name it in lower case, with underscores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The film holds all samples of the plan.
    Samples,
    /// The time limit was reached, or no further pass would have fitted in.
    TimeLimit,
    /// The estimated error is at or below the target.
    NoiseTarget,
    /// The user or another part of the program stopped it.
    Stopped,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_time_limit_is_a_duration() {
        let limit = |seconds: f64| Stop { seconds: Some(seconds), ..Stop::default() }.time_limit();
        for (seconds, expected) in [
            (1.5, Duration::from_millis(1500)),
            (0.0, Duration::ZERO),
            (-3.0, Duration::ZERO),
            (1e300, Duration::MAX),
            (f64::INFINITY, Duration::MAX),
        ] {
            assert_eq!(limit(seconds), Some(expected), "{seconds} s");
        }
        assert_eq!(Stop::at_samples(8).time_limit(), None);
    }

    #[test]
    fn unwatched_passes_that_stop_early_are_long() {
        let batch = |stop| Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(stop) };
        let to_a_noise = Stop { noise: Some(0.1), ..Stop::default() };
        for (plan, stops_early, factor) in [
            (batch(Stop::at_samples(8)), true, 2),
            (batch(Stop::at_samples(8)), false, 1),
            (batch(to_a_noise), true, 1),
            (Plan::endless(), true, 1),
        ] {
            assert_eq!(plan.later_pass_target(stops_early), factor * plan.pass_target, "{plan:?}");
        }
    }
}
