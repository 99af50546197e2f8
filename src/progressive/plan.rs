//! What a progressive render is to do, and when it ends.

use crate::film::ErrorEstimate;
use crate::render::SAMPLE_LIMIT;
use std::ops::Range;
use std::time::Duration;

/// The noise target is not looked at before each pixel has this many samples: the estimate of fewer is rough.
pub const NOISE_TARGET_FIRST_SAMPLES: u64 = 16;

/// When a render ends: the first of these conditions that is met. Without any it goes on without end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// The samples that every pixel should hold.
    pub samples: Option<u64>,
    /// Most seconds, preparation included and pauses left out. At least one pass is always rendered.
    pub seconds: Option<f64>,
    /// RMSE, linear radiance, as the halves estimate it. Needs a film with two halves.
    pub noise: Option<f64>,
}

impl Stop {
    /// The error at which a picture on a screen no longer changes to the eye.
    pub const NOISE: f64 = 0.002;

    /// After so many samples per pixel.
    pub fn at_samples(samples: u64) -> Self {
        Stop { samples: Some(samples), ..Stop::default() }
    }

    /// The most wall time.
    pub fn time_limit(&self) -> Option<Duration> {
        // Seconds that a duration cannot hold are as good as no limit.
        self.seconds.map(|seconds| Duration::try_from_secs_f64(seconds.max(0.0)).unwrap_or(Duration::MAX))
    }

    pub(super) fn noise_reached(&self, samples: u64, error: Option<ErrorEstimate>) -> bool {
        match (self.noise, error) {
            (Some(target), Some(error)) => samples >= NOISE_TARGET_FIRST_SAMPLES && error.rmse <= target,
            _ => false,
        }
    }
}

/// What a render is to do: which samples, until when, and how often it can be spoken to.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The first sample of each pixel. Samples that are in the film already are left out.
    pub first_sample: u64,
    /// When it ends.
    pub stop: Stop,
    /// What a pass should take; commands are obeyed between passes.
    pub pass_target: Duration,
}

impl Plan {
    /// Passes short enough that a person does not notice them.
    pub const INTERACTIVE_PASS: Duration = Duration::from_millis(50);

    /// Passes long enough that their ends cost nothing.
    pub const BATCH_PASS: Duration = Duration::from_millis(300);

    /// All samples until `stop`, in interactive passes.
    pub fn until(stop: Stop) -> Self {
        Plan { first_sample: 0, stop, pass_target: Plan::INTERACTIVE_PASS }
    }

    /// Samples `0..samples`, without other conditions, in interactive passes.
    pub fn samples(samples: u64) -> Self {
        Plan::until(Stop::at_samples(samples))
    }

    /// Until told to stop.
    pub fn endless() -> Self {
        Plan::until(Stop::default())
    }

    /// The samples that every pixel should hold.
    pub fn range(&self) -> Range<u64> {
        self.first_sample..self.stop.samples.unwrap_or(SAMPLE_LIMIT)
    }
}

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndReason {
    /// The film holds all samples of the plan.
    Samples,
    /// The time limit; no further pass would have fitted in.
    TimeLimit,
    /// The estimated error is at or below the target.
    NoiseTarget,
    /// It was told to stop.
    Stopped,
}

impl EndReason {
    /// As reports name it.
    pub fn name(self) -> &'static str {
        match self {
            EndReason::Samples => "samples",
            EndReason::TimeLimit => "time_limit",
            EndReason::NoiseTarget => "noise_target",
            EndReason::Stopped => "stopped",
        }
    }

    /// In words, after "ended by".
    pub fn words(self) -> &'static str {
        match self {
            EndReason::Samples => "the number of samples",
            EndReason::TimeLimit => "the time limit",
            EndReason::NoiseTarget => "the noise target",
            EndReason::Stopped => "a request to stop",
        }
    }
}
