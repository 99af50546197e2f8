//! Whether what was measured is what was expected.

use super::figures::{Level, Paired};
use serde::Serialize;

/// Standard errors that noise may move a mean by: one in sixteen thousand is farther off.
const DEVIATIONS: f64 = 4.0;

/// Pictures of the same samples differ by less than this share of their noise. Those that share no path differ by
/// 1.4 of it.
const PAIRED_SHARE: f64 = 0.5;

/// Pictures whose paths have parted differ by less than this times their noise: by 1.4 if all have, and noise is only
/// known to a tenth.
const PARTED_SHARE: f64 = 1.6;

/// What rounding may move pixels by where there is no noise.
const PAIRED_FLOOR: f64 = 1e-4;

/// The same where paths may part: some of the few hundred thousand of a picture.
const PARTED_FLOOR: f64 = 3e-4;

/// Times the tame twin's time that count as slow, once it is more than [`SLOW_SECONDS`].
const SLOW_RATIO: f64 = 8.0;

/// Seconds more than the tame twin took that matter.
const SLOW_SECONDS: f64 = 1.0;

/// What came of a case on a backend.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "verdict", content = "reason", rename_all = "lowercase")]
pub enum Verdict {
    /// As expected.
    Right,
    /// Another picture than expected, but the backend said so, with the limit and what to do.
    Warned(String),
    /// Another picture than expected.
    Wrong(String),
    /// As expected, but far slower than the tame twin.
    Slow(String),
    /// There is no picture: refused, broken off, or too slow.
    None(String),
}

impl Verdict {
    /// As the table has it.
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Right => "right",
            Verdict::Warned(_) => "warned",
            Verdict::Wrong(_) => "WRONG",
            Verdict::Slow(_) => "SLOW",
            Verdict::None(_) => "NONE",
        }
    }

    /// What is wrong; empty if nothing is.
    pub fn reason(&self) -> &str {
        match self {
            Verdict::Right => "",
            Verdict::Warned(reason)
            | Verdict::Wrong(reason)
            | Verdict::Slow(reason)
            | Verdict::None(reason) => reason,
        }
    }

    /// Whether it is as expected, or was said not to be.
    pub fn is_right(&self) -> bool {
        matches!(self, Verdict::Right | Verdict::Warned(_))
    }

    /// Takes into account what the backend said of the scene.
    #[must_use]
    pub fn given(self, warnings: &[String]) -> Self {
        match (self, warnings) {
            (Verdict::Wrong(reason), [first, ..]) => Verdict::Warned(format!("{reason}; it said: {first}")),
            (verdict, _) => verdict,
        }
    }
}

/// What the picture is held against.
#[derive(Clone, Copy, Debug)]
pub enum Against {
    /// A radiance that every sample has.
    Every([f64; 3]),
    /// A mean.
    Mean(f64),
    /// The same samples of another picture, and how far off they are.
    Picture(Paired),
    /// Another picture of the same light, whatever its paths.
    Estimate(Paired),
}

/// How far the mean is off, linear radiance: of the worst channel where each is known.
pub fn offset(level: &Level, against: Against) -> f64 {
    match against {
        Against::Every(value) => (0..3)
            .map(|channel| level.mean[channel] - value[channel])
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
            .unwrap_or(0.0),
        Against::Mean(value) => level.grey() - value,
        Against::Picture(paired) | Against::Estimate(paired) => paired.bias,
    }
}

/// Judges a picture.
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
        return Verdict::Wrong(format!("{rejected} samples were no numbers"));
    }
    if off.is_nan() || off.abs() > allowed {
        return Verdict::Wrong(format!("off by {off:+.1e}, where {allowed:.1e} are allowed"));
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
                "pixels are off by {:.1e} RMS, where {allowed:.1e} are allowed",
                paired.rms
            ));
        }
    }
    Verdict::Right
}

/// Judges the time of a picture that is right.
pub fn judge_time(verdict: Verdict, seconds: f64, tame: Option<f64>) -> Verdict {
    match (verdict, tame) {
        (Verdict::Right, Some(tame)) if seconds > SLOW_RATIO * tame && seconds > tame + SLOW_SECONDS => {
            Verdict::Slow(format!("{seconds:.1} s, where the tame twin takes {tame:.2} s"))
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
        // Whatever the halves say: there is no noise to be had.
        let verdict = judge(&level(0.499, 0.1, 0.1), every, 1e-6, 0);
        assert_eq!(verdict.reason(), "off by -1.0e-3, where 1.0e-6 are allowed");
        let one_channel = Level { mean: [0.5, 0.5, 0.6], ..Level::default() };
        assert_eq!(judge(&one_channel, every, 1e-6, 0).name(), "WRONG");
        assert!(!judge(&level(f64::NAN, 0.0, 0.0), every, 1e-6, 0).is_right());
        assert_eq!(judge(&level(0.5, 0.0, 0.0), every, 1e-6, 3).reason(), "3 samples were no numbers");
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
        // Another picture of the same mean.
        let verdict = judge(&noisy, paired(0.0, 0.06), 2e-6, 0);
        assert!(verdict.reason().starts_with("pixels are off by 6.0e-2"), "{verdict:?}");
        // As far apart as chance takes two estimates, and farther.
        let estimate = |rms| Against::Estimate(Paired { bias: 0.0, bias_deviation: 1e-3, rms });
        assert!(judge(&noisy, estimate(0.07), 2e-6, 0).is_right());
        assert!(!judge(&noisy, estimate(0.1), 2e-6, 0).is_right());
    }

    #[test]
    fn what_was_said_is_no_fault() {
        let warnings = ["too thin".to_owned()];
        let warned = Verdict::Wrong("off".into()).given(&warnings);
        assert_eq!(
            (warned.name(), warned.reason(), warned.is_right()),
            ("warned", "off; it said: too thin", true)
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
        assert_eq!((slow.name(), slow.reason()), ("SLOW", "20.0 s, where the tame twin takes 0.50 s"));
        let wrong = Verdict::Wrong("x".into());
        assert_eq!(judge_time(wrong.clone(), 20.0, Some(0.5)), wrong);
    }
}
