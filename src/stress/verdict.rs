//! Compares what was measured with what was expected.

use super::figures::{Level, Paired};
use serde::Serialize;

/// Standard errors by which noise may move a mean; one mean in sixteen thousand moves further.
const DEVIATIONS: f64 = 4.0;

/// Pictures of the same samples differ by less than this fraction of their noise. Pictures of unrelated samples differ
/// by 1.4 times their noise.
const PAIRED_SHARE: f64 = 0.5;

/// Pictures whose paths have parted differ by less than this times their noise: by 1.4 times if all paths have, and
/// the noise itself is only known to within a tenth.
const PARTED_SHARE: f64 = 1.6;

/// Difference of the pixels that rounding may cause where there is no noise.
const PAIRED_FLOOR: f64 = 1e-4;

/// The same where paths may part, as a few of the several hundred thousand paths of a picture do.
const PARTED_FLOOR: f64 = 3e-4;

/// A picture is slow if it takes this many times as long as the tame twin and [`SLOW_SECONDS`] longer.
const SLOW_RATIO: f64 = 8.0;

/// Extra seconds from which a slow picture matters.
const SLOW_SECONDS: f64 = 1.0;

/// The verdict on a case on one backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", content = "reason", rename_all = "lowercase")]
pub enum Verdict {
    /// As expected.
    Right,
    /// Not as expected, but the backend warned about it and said what to do.
    Warned(String),
    /// Not as expected.
    Wrong(String),
    /// As expected, but far slower than the tame twin.
    Slow(String),
    /// There is no picture: it was refused, the tracer failed, or it took too long.
    None(String),
}

impl Verdict {
    /// Its name in the table.
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Right => "right",
            Verdict::Warned(_) => "warned",
            Verdict::Wrong(_) => "WRONG",
            Verdict::Slow(_) => "SLOW",
            Verdict::None(_) => "NONE",
        }
    }

    /// What is wrong; empty for [`Verdict::Right`].
    pub fn reason(&self) -> &str {
        match self {
            Verdict::Right => "",
            Verdict::Warned(reason)
            | Verdict::Wrong(reason)
            | Verdict::Slow(reason)
            | Verdict::None(reason) => reason,
        }
    }

    /// Whether the result is as expected or the backend warned about it.
    pub fn is_right(&self) -> bool {
        matches!(self, Verdict::Right | Verdict::Warned(_))
    }

    /// Turns a wrong result into a warned one if the backend gave a warning.
    #[must_use]
    pub fn given(self, warnings: &[String]) -> Self {
        match (self, warnings) {
            (Verdict::Wrong(reason), [first, ..]) => {
                Verdict::Warned(format!("{reason}; the backend warned: {first}"))
            }
            (verdict, _) => verdict,
        }
    }
}

/// What a picture is compared with.
#[derive(Clone, Copy, Debug)]
pub enum Against {
    /// The radiance of every sample, linear RGB.
    Every([f64; 3]),
    /// The mean over pixels and channels, linear radiance.
    Mean(f64),
    /// A picture of the same samples; the value is the difference from it.
    Picture(Paired),
    /// A picture of the same light from other paths; the value is the difference from it.
    Estimate(Paired),
}

/// Distance of the mean from the expected one, linear radiance; if each channel is known, that of the worst channel.
pub fn offset(level: &Level, against: Against) -> f64 {
    match against {
        Against::Every(value) => {
            let [red, green, blue] = [0, 1, 2].map(|channel| level.mean[channel] - value[channel]);
            let farther = |a: f64, b: f64| if a.abs().total_cmp(&b.abs()).is_le() { b } else { a };
            farther(farther(red, green), blue)
        }
        Against::Mean(value) => level.grey() - value,
        Against::Picture(paired) | Against::Estimate(paired) => paired.bias,
    }
}

/// Judges a picture by its radiance.
pub fn judge(level: &Level, against: Against, tolerance: f64, rejected: u64) -> Verdict {
    let off = offset(level, against);
    let allowed = match against {
        Against::Every(_) => tolerance,
        Against::Mean(_) => tolerance + DEVIATIONS * level.deviation,
        Against::Picture(paired) | Against::Estimate(paired) => {
            tolerance + DEVIATIONS * paired.bias_deviation
        }
    };
    if rejected > 0 {
        return Verdict::Wrong(format!("rejected samples (NaN, infinite or negative): {rejected}"));
    }
    if off.is_nan() || off.abs() > allowed {
        return Verdict::Wrong(format!("off by {off:+.1e}; at most {allowed:.1e} is allowed"));
    }
    let pairs = match against {
        Against::Every(_) | Against::Mean(_) => None,
        Against::Picture(paired) => Some((paired, PAIRED_SHARE, PAIRED_FLOOR)),
        Against::Estimate(paired) => Some((paired, PARTED_SHARE, PARTED_FLOOR)),
    };
    if let Some((paired, share, floor)) = pairs {
        let allowed = (share * level.noise).max(floor);
        if paired.rms > allowed {
            return Verdict::Wrong(format!(
                "pixels are off by {:.1e} RMS; at most {allowed:.1e} is allowed",
                paired.rms
            ));
        }
    }
    Verdict::Right
}

/// Judges the time of a picture if its radiance is right.
pub fn judge_time(verdict: Verdict, seconds: f64, tame: Option<f64>) -> Verdict {
    match (verdict, tame) {
        (Verdict::Right, Some(tame)) if seconds > SLOW_RATIO * tame && seconds > tame + SLOW_SECONDS => {
            Verdict::Slow(format!("{seconds:.1} s; the tame twin takes {tame:.2} s"))
        }
        (verdict, _) => verdict,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(mean: f64, deviation: f64, noise: f64) -> Level {
        Level { mean: [mean; 3], deviation, noise }
    }

    #[test]
    fn a_closed_form_without_noise_has_no_excuse() {
        let every = Against::Every([0.5; 3]);
        assert!(judge(&level(0.5, 0.0, 0.0), every, 1e-6, 0).is_right());
        // The spread between the halves is no excuse: this expectation has no noise.
        let verdict = judge(&level(0.499, 0.1, 0.1), every, 1e-6, 0);
        assert_eq!(verdict.reason(), "off by -1.0e-3; at most 1.0e-6 is allowed");
        let one_channel = Level { mean: [0.5, 0.5, 0.6], ..Level::default() };
        assert_eq!(judge(&one_channel, every, 1e-6, 0).name(), "WRONG");
        assert!(!judge(&level(f64::NAN, 0.0, 0.0), every, 1e-6, 0).is_right());
        assert_eq!(
            judge(&level(0.5, 0.0, 0.0), every, 1e-6, 1).reason(),
            "rejected samples (NaN, infinite or negative): 1"
        );
    }

    #[test]
    fn a_mean_is_judged_by_its_noise() {
        let mean = Against::Mean(1.0);
        assert!(judge(&level(0.997, 1e-3, 0.1), mean, 1e-6, 0).is_right());
        assert!(!judge(&level(0.995, 1e-3, 0.1), mean, 1e-6, 0).is_right());
    }

    #[test]
    fn the_same_samples_give_the_same_picture() {
        let paired = |bias, rms| Against::Picture(Paired { bias, bias_deviation: 1e-7, rms });
        let noisy = level(0.5, 1e-3, 0.05);
        assert!(judge(&noisy, paired(1e-6, 1e-3), 2e-6, 0).is_right());
        assert!(!judge(&noisy, paired(1e-5, 1e-3), 2e-6, 0).is_right());
        // A different picture with the same mean.
        let verdict = judge(&noisy, paired(0.0, 0.06), 2e-6, 0);
        assert!(verdict.reason().starts_with("pixels are off by 6.0e-2"), "{verdict:?}");
        // As far apart as two independent estimates are, and further.
        let estimate = |rms| Against::Estimate(Paired { bias: 0.0, bias_deviation: 1e-3, rms });
        assert!(judge(&noisy, estimate(0.07), 2e-6, 0).is_right());
        assert!(!judge(&noisy, estimate(0.1), 2e-6, 0).is_right());
    }

    #[test]
    fn the_channel_that_is_farthest_off_counts() {
        let every = Against::Every([0.5, 0.25, 0.75]);
        for (mean, off) in [
            ([0.75, 0.5, 0.625], 0.25),
            ([0.375, 0.375, 1.0], 0.25),
            ([0.375, -0.25, 0.875], -0.5),
            ([-0.5, 0.25, 0.75], -1.0),
            ([0.5, 0.25, 0.75], 0.0),
        ] {
            assert_eq!(offset(&Level { mean, ..Level::default() }, every), off, "{mean:?}");
        }
        for mean in [[f64::NAN, 0.25, 0.75], [0.5, f64::NAN, 0.75], [0.5, 0.25, f64::NAN]] {
            assert!(offset(&Level { mean, ..Level::default() }, every).is_nan(), "{mean:?}");
        }
        let level = Level { mean: [0.25, 0.5, 1.5], ..Level::default() };
        assert_eq!(offset(&level, Against::Mean(0.5)), 0.25);
        let paired = Paired { bias: -0.125, bias_deviation: 1.0, rms: 2.0 };
        assert_eq!(
            [Against::Picture(paired), Against::Estimate(paired)].map(|a| offset(&level, a)),
            [-0.125; 2]
        );
    }

    /// A little within each limit and a little beyond it.
    #[test]
    fn limits_lie_where_they_should() {
        let paired = |bias_deviation, bias, rms| Paired { bias, bias_deviation, rms };
        let (picture, estimate) = (Against::Picture, Against::Estimate);
        let noisy = level(1.0, 1e-3, 0.1);
        let quiet = level(1.0, 0.0, 0.0);
        for (level, within, beyond) in [
            (quiet, Against::Every([1.0 - 0.99e-6; 3]), Against::Every([1.0 - 1.01e-6; 3])),
            (noisy, Against::Mean(1.0039), Against::Mean(1.0041)),
            (noisy, Against::Mean(0.9961), Against::Mean(0.9959)),
            (noisy, picture(paired(1e-4, 3.9e-4, 0.0)), picture(paired(1e-4, 4.1e-4, 0.0))),
            (noisy, estimate(paired(1e-4, -3.9e-4, 0.0)), estimate(paired(1e-4, -4.1e-4, 0.0))),
            (noisy, picture(paired(0.0, 0.0, 0.049)), picture(paired(0.0, 0.0, 0.051))),
            (noisy, estimate(paired(0.0, 0.0, 0.159)), estimate(paired(0.0, 0.0, 0.161))),
            (quiet, picture(paired(0.0, 0.0, 0.99e-4)), picture(paired(0.0, 0.0, 1.01e-4))),
            (quiet, estimate(paired(0.0, 0.0, 2.99e-4)), estimate(paired(0.0, 0.0, 3.01e-4))),
        ] {
            assert!(judge(&level, within, 1e-6, 0).is_right(), "{within:?}");
            assert!(!judge(&level, beyond, 1e-6, 0).is_right(), "{beyond:?}");
        }
        for (seconds, tame, is_right) in
            [(7.9, 1.0, true), (8.1, 1.0, false), (1.09, 0.1, true), (1.11, 0.1, false)]
        {
            assert_eq!(
                judge_time(Verdict::Right, seconds, Some(tame)).is_right(),
                is_right,
                "{seconds} {tame}"
            );
        }
    }

    #[test]
    fn what_was_said_is_no_fault() {
        let warnings = ["too thin".to_owned()];
        let warned = Verdict::Wrong("off".into()).given(&warnings);
        assert_eq!(
            (warned.name(), warned.reason(), warned.is_right()),
            ("warned", "off; the backend warned: too thin", true)
        );
        assert!(!Verdict::Wrong("off".into()).given(&[]).is_right());
        assert_eq!(Verdict::Right.given(&warnings), Verdict::Right);
        assert!(!Verdict::None("gone".into()).given(&warnings).is_right());
    }

    #[test]
    fn only_what_is_much_slower_is_slow() {
        assert!(judge_time(Verdict::Right, 0.9, Some(0.01)).is_right());
        assert!(judge_time(Verdict::Right, 7.0, Some(1.0)).is_right());
        assert!(judge_time(Verdict::Right, 70.0, None).is_right());
        let slow = judge_time(Verdict::Right, 20.0, Some(0.5));
        assert_eq!((slow.name(), slow.reason()), ("SLOW", "20.0 s; the tame twin takes 0.50 s"));
        let wrong = Verdict::Wrong("x".into());
        assert_eq!(judge_time(wrong.clone(), 20.0, Some(0.5)), wrong);
    }
}
