//! What a progressive render is to do, and when it ends.

use crate::film::ErrorEstimate;
use crate::render::SAMPLE_LIMIT;
use std::ops::Range;
use std::time::Duration;

/// The noise target is not looked at before each pixel has this many samples: the estimate of fewer is rough.
pub const NOISE_TARGET_FIRST_SAMPLES: u64 = 16;

/// When a render ends, and how often it can be spoken to. The conditions combine: the first one met ends it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The samples that every pixel should hold. Those in the film already are left out.
    pub samples: Range<u64>,
    /// Most wall time, preparation included and pauses left out. At least one pass is always rendered.
    pub time_limit: Option<Duration>,
    /// RMSE, linear radiance, as the halves estimate it. Needs a film with two halves.
    pub noise_target: Option<f64>,
    /// What a pass should take; commands are obeyed between passes.
    pub pass_target: Duration,
}

impl Plan {
    /// Passes short enough that a person does not notice them.
    pub const INTERACTIVE_PASS: Duration = Duration::from_millis(50);

    /// Passes long enough that their ends cost nothing.
    pub const BATCH_PASS: Duration = Duration::from_millis(300);

    /// Samples `0..samples`, without other conditions, in interactive passes.
    pub fn samples(samples: u64) -> Self {
        Plan {
            samples: 0..samples,
            time_limit: None,
            noise_target: None,
            pass_target: Plan::INTERACTIVE_PASS,
        }
    }

    /// Until told to stop.
    pub fn endless() -> Self {
        Plan::samples(SAMPLE_LIMIT)
    }

    pub(super) fn noise_reached(&self, samples: u64, error: Option<ErrorEstimate>) -> bool {
        match (self.noise_target, error) {
            (Some(target), Some(error)) => samples >= NOISE_TARGET_FIRST_SAMPLES && error.rmse <= target,
            _ => false,
        }
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
