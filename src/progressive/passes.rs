//! Chooses the number of samples per pass.
//!
//! A pass is a range of samples. Its length is a power of two and its start a multiple of its length, so that blocks of
//! Sobol points stay whole. The length depends on how long earlier passes took.

use crate::film::SampleRanges;
use std::ops::Range;
use std::time::Duration;

/// Chooses the ranges of passes.
#[derive(Clone, Debug)]
pub struct PassSizer {
    smallest: u64,
    length: u64,
    seconds_per_sample: Option<f64>,
}

/// The longest pass, samples per pixel.
const LENGTH_LIMIT: u64 = 1 << 16;

impl PassSizer {
    /// Passes have at least `smallest` samples, and the first has `length`, both powers of two. If `smallest` is the
    /// number of halves, each pass gives both the same number of samples.
    pub fn new(smallest: u64, length: u64) -> Self {
        PassSizer { smallest, length: length.clamp(smallest, LENGTH_LIMIT), seconds_per_sample: None }
    }

    /// Begins with a pass of about `target` at an estimated time per sample.
    pub fn estimated(&mut self, per_sample: Duration, target: Duration) {
        let wanted = largest_power_of_two(target.as_secs_f64(), per_sample.as_secs_f64());
        self.length = wanted.clamp(self.smallest, LENGTH_LIMIT);
    }

    /// Whether the speed is unknown: no pass has been measured.
    pub fn is_new(&self) -> bool {
        self.seconds_per_sample.is_none()
    }

    /// Forgets the measured times, because another backend has a different speed.
    pub fn restart(&mut self) {
        self.length = self.smallest;
        self.seconds_per_sample = None;
    }

    /// Records how long a pass took. The next should take about `target`, with at most twice as many samples.
    pub fn measured(&mut self, samples: u64, took: Duration, target: Duration) {
        let per_sample = took.as_secs_f64() / samples.max(1) as f64;
        self.seconds_per_sample = Some(per_sample);
        let wanted = largest_power_of_two(target.as_secs_f64(), per_sample);
        // Alignment may have shortened the pass; the previous length then still applies.
        let most = (2 * samples).max(self.length);
        self.length = wanted.min(most).clamp(self.smallest, LENGTH_LIMIT);
    }

    /// The next pass within `planned` without the samples in `held`; `None` when nothing is missing. With `time_left`,
    /// the pass is shortened to finish in that time; `None` if even the shortest pass would take longer.
    pub fn next(
        &self,
        held: &SampleRanges,
        planned: Range<u64>,
        time_left: Option<Duration>,
    ) -> Option<Range<u64>> {
        if time_left.is_some_and(|left| left.is_zero()) {
            return None;
        }
        let mut length = self.length;
        if let (Some(left), Some(per_sample)) = (time_left, self.seconds_per_sample) {
            let fits = largest_power_of_two(left.as_secs_f64(), per_sample);
            if fits < self.smallest {
                return None;
            }
            length = length.min(fits);
        }
        let gap = held.first_gap(planned, length)?;
        let mut aligned = length;
        while aligned > gap.end - gap.start || !gap.start.is_multiple_of(aligned) {
            aligned /= 2;
        }
        Some(gap.start..gap.start + aligned)
    }
}

/// The largest power-of-two number of samples that fits into `seconds`, or 0.
fn largest_power_of_two(seconds: f64, per_sample: f64) -> u64 {
    if per_sample <= 0.0 {
        return LENGTH_LIMIT;
    }
    let samples = (seconds / per_sample).min(LENGTH_LIMIT as f64) as u64;
    if samples == 0 { 0 } else { 1 << samples.ilog2() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAST: Duration = Duration::from_millis(1);
    const TARGET: Duration = Duration::from_secs(1);

    fn passes(smallest: u64, held: SampleRanges, planned: Range<u64>) -> Vec<Range<u64>> {
        let (mut sizer, mut held, mut passes) = (PassSizer::new(smallest, 1), held, Vec::new());
        while let Some(pass) = sizer.next(&held, planned.clone(), None) {
            held.insert(pass.clone()).unwrap();
            sizer.measured(pass.end - pass.start, FAST, TARGET);
            passes.push(pass);
        }
        passes
    }

    #[test]
    fn passes_are_aligned_fill_every_gap_and_never_overlap() {
        for smallest in [1, 2] {
            for planned in [0..1, 0..77, 3..17, 64..1000, 5..6] {
                let mut held = SampleRanges::default();
                held.insert(6..9).unwrap();
                held.insert(100..164).unwrap();
                for pass in passes(smallest, held.clone(), planned.clone()) {
                    let length = pass.end - pass.start;
                    assert!(length.is_power_of_two() && pass.start % length == 0, "{pass:?}");
                    held.insert(pass).unwrap();
                }
                assert_eq!(held.first_gap(planned, u64::MAX), None);
            }
        }
    }

    #[test]
    fn slow_passes_stay_small_and_fit_the_time_left() {
        let (mut sizer, none) = (PassSizer::new(2, 2), SampleRanges::default());
        let within =
            |sizer: &PassSizer, seconds| sizer.next(&none, 0..100, Some(Duration::from_millis(seconds)));
        sizer.measured(2, 20 * TARGET, TARGET);
        assert_eq!(sizer.next(&none, 0..100, None), Some(0..2));
        // Each half gets a sample, and 15 seconds are enough for one only.
        assert_eq!([1000, 15_000, 25_000].map(|time| within(&sizer, time)), [None, None, Some(0..2)]);
        let mut restarted = sizer.clone();
        restarted.restart();
        assert_eq!(
            [0, 1000].map(|time| within(&restarted, time)),
            [None, Some(0..2)],
            "the speed is unknown"
        );
        sizer.measured(64, TARGET, TARGET);
        assert_eq!(within(&sizer, 250), Some(0..16));
    }

    #[test]
    fn alignment_does_not_shorten_later_passes() {
        let (mut sizer, none) = (PassSizer::new(1, 64), SampleRanges::default());
        assert_eq!(sizer.next(&none, 4..1000, None), Some(4..8));
        sizer.measured(4, FAST, TARGET);
        assert_eq!(sizer.next(&none, 64..1000, None), Some(64..128));
        // A pass that took too long does.
        sizer.measured(64, 8 * TARGET, TARGET);
        assert_eq!(sizer.next(&none, 64..1000, None), Some(64..72));
    }

    #[test]
    fn passes_have_at_most_65536_samples() {
        let begun = PassSizer::new(2, 1 << 20);
        let length = |sizer: &PassSizer| {
            let pass = sizer.next(&SampleRanges::default(), 0..1 << 30, None).unwrap();
            pass.end - pass.start
        };
        assert_eq!(length(&begun), 1 << 16);
        for took in [Duration::ZERO, Duration::from_nanos(1)] {
            let mut sizer = begun.clone();
            sizer.measured(1 << 16, took, TARGET);
            assert_eq!(length(&sizer), 1 << 16, "{took:?}");
        }
    }
}
