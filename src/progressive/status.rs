//! The status of a progressive render.

use super::EndReason;
use crate::denoise::DenoisedError;
use crate::film::{ErrorEstimate, Film};
use crate::job::render::{BackendInfo, Stats};
use serde::Serialize;
use std::time::Duration;

#[derive(Clone, Debug, Default, PartialEq)]
pub enum Phase {
    /// No render was started, or it was abandoned.
    #[default]
    Idle,
    /// The prepared scene, its hierarchy and kernels are being built.
    Preparing,
    Tracing,
    /// The render waits to be resumed.
    Paused,
    /// The render has ended; the film can be taken.
    Done(EndReason),
    /// Neither the backend nor its fallback could continue. The film holds what was rendered before.
    Failed(String),
}

impl Phase {
    /// Whether samples are being added, or will be.
    pub fn is_working(&self) -> bool {
        matches!(self, Phase::Preparing | Phase::Tracing)
    }

    /// Whether no more samples will come without a new command.
    pub fn is_over(&self) -> bool {
        matches!(self, Phase::Done(_) | Phase::Failed(_))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HistoryPoint {
    /// The backend that traced the newest samples: [`BackendInfo::name`].
    pub backend: &'static str,
    pub samples_per_pixel: u64,
    /// Wall seconds of tracing since the start.
    pub trace_seconds: f64,
    /// Estimated RMSE, linear radiance.
    pub rmse_estimate: f64,
    pub rel_mse_estimate: f64,
}

/// How many samples one backend has added since the start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contribution {
    /// The backend that added them.
    #[serde(flatten)]
    pub backend: BackendInfo,
    pub samples_per_pixel: u64,
}

/// The figures of a render, counted from its start; only the film's own figures include samples that it held before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Status {
    /// The run that this belongs to: 0 before the first start, then one more for each start.
    pub run: u64,
    pub phase: Phase,
    pub backend: Option<BackendInfo>,
    pub samples_per_pixel: u64,
    /// Samples per pixel that the film should reach.
    pub planned_samples_per_pixel: u64,
    /// Samples in the film that were NaN, infinite or negative.
    pub rejected_samples: u64,
    /// Statistics summed over the passes.
    pub stats: Stats,
    pub prepare: Duration,
    /// The parts of the current kernel.
    pub kernel: String,
    /// The parts that the current kernel leaves out.
    pub left_out: Vec<&'static str>,
    /// Wall time of building the hierarchy, which is part of `prepare`.
    pub hierarchy: Duration,
    /// Wall time of all passes.
    pub trace: Duration,
    /// Wall time since the start, without pauses.
    pub elapsed: Duration,
    /// The latest estimate of the film's error; it can be a few passes old.
    pub error: Option<ErrorEstimate>,
    /// The error of the denoised picture, as old as `error`, if the plan asks for it.
    pub denoised: Option<DenoisedError>,
    /// Why the estimate is doubtful.
    pub doubt: Option<String>,
    /// The error at powers of two of samples per pixel, each at the end of the first pass that reaches it, and where
    /// another backend takes over.
    pub history: Vec<HistoryPoint>,
    /// Which backends have added how many samples, in order of first appearance.
    pub contributions: Vec<Contribution>,
    /// Backends that failed or could not be prepared, in order.
    pub given_up: Vec<&'static str>,
    /// Problems that were handled, as messages for the user.
    pub messages: Vec<String>,
}

impl Status {
    pub fn paths_per_second(&self) -> f64 {
        per_second(self.stats.paths, self.trace)
    }

    pub fn rays_per_second(&self) -> f64 {
        per_second(self.stats.rays, self.trace)
    }

    /// Share of lanes that were in use, `0..=1`.
    pub fn lane_occupancy(&self) -> Option<f64> {
        let Stats { busy_lanes, offered_lanes, .. } = self.stats;
        (offered_lanes > 0).then(|| busy_lanes as f64 / offered_lanes as f64)
    }

    /// This status adjusted to `film`, which may be some passes older or newer. `held_before` is the number of samples
    /// per pixel that the film held when the render started.
    pub fn of_film(&self, film: &Film, held_before: u64) -> Status {
        let mut status = self.clone();
        let added = film.sample_count().saturating_sub(held_before);
        let reported = status.added();
        if reported > 0 && reported != added {
            status.trace = status.trace.mul_f64(added as f64 / reported as f64);
            let at_work =
                status.contributions.iter().position(|part| Some(&part.backend) == status.backend.as_ref());
            let at_work = at_work.unwrap_or(status.contributions.len() - 1);
            let count = &mut status.contributions[at_work].samples_per_pixel;
            *count = (*count + added).saturating_sub(reported);
        }
        status
    }

    /// Tracing time of one sample per pixel, seconds, as measured since the start.
    pub fn seconds_per_sample(&self) -> f64 {
        let samples = if self.added() > 0 { self.added() } else { self.samples_per_pixel };
        self.trace.as_secs_f64() / samples.max(1) as f64
    }

    /// Samples per pixel that were added since the start.
    pub fn added(&self) -> u64 {
        self.contributions.iter().map(|part| part.samples_per_pixel).sum()
    }

    pub(super) fn say(&mut self, messages: impl IntoIterator<Item = String>) {
        for message in messages {
            if !self.messages.contains(&message) {
                log::warn!("{message}");
                self.messages.push(message);
            }
        }
    }

    pub(super) fn credit(&mut self, backend: &BackendInfo, samples: u64) {
        match self.contributions.iter_mut().find(|c| c.backend == *backend) {
            Some(found) => found.samples_per_pixel += samples,
            None => {
                self.contributions.push(Contribution { backend: backend.clone(), samples_per_pixel: samples })
            }
        }
    }
}

fn per_second(count: u64, time: Duration) -> f64 {
    if time.is_zero() { 0.0 } else { count as f64 / time.as_secs_f64() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backends_with_other_options_are_credited_separately() {
        let info = |lanes| BackendInfo { name: "cpu", device: "x".to_owned(), lanes, threads: 1 };
        let mut status = Status::default();
        for (lanes, samples) in [(8, 4), (1, 2), (8, 16)] {
            status.credit(&info(lanes), samples);
        }
        let found: Vec<_> =
            status.contributions.iter().map(|part| (part.backend.lanes, part.samples_per_pixel)).collect();
        assert_eq!(found, [(8, 20), (1, 2)]);
    }

    #[test]
    fn matching_status_is_unchanged() {
        let info = |name| BackendInfo { name, device: String::new(), lanes: 8, threads: 1 };
        let part = |name, samples_per_pixel| Contribution { backend: info(name), samples_per_pixel };
        let mut status = Status {
            backend: Some(info("cpu")),
            contributions: vec![part("gpu", 30), part("cpu", 10)],
            trace: Duration::from_secs(40),
            ..Status::default()
        };
        let film = |samples: u64| {
            let mut film = Film::new(1, 1);
            film.record(0..samples, 0).unwrap();
            film
        };
        assert_eq!(status.added(), 40);
        assert_eq!(status.of_film(&film(60), 20), status);
        // An earlier film has fewer samples of the current backend.
        let earlier = status.of_film(&film(54), 20);
        assert_eq!(earlier.contributions, [part("gpu", 30), part("cpu", 4)]);
        assert_eq!(earlier.trace, Duration::from_secs(34));
        let much_earlier = status.of_film(&film(40), 20);
        assert_eq!(much_earlier.contributions, [part("gpu", 30), part("cpu", 0)]);
        // A backend that has added nothing yet is not the current one.
        status.backend = Some(info("reference"));
        let later = status.of_film(&film(64), 20);
        assert_eq!(later.contributions, [part("gpu", 30), part("cpu", 14)]);
        let nothing = Status::default();
        assert_eq!(nothing.of_film(&film(8), 4), nothing);
    }
}
