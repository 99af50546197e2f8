//! Measures films and judges them by the expected result.

use crate::comparison::compare::half_differences;
use crate::film::Film;
use serde::Serialize;

/// Standard errors by which noise may move a mean; one mean in sixteen thousand moves further.
const DEVIATIONS: f64 = 4.0;

/// Pictures of the same samples differ by less than this share of their noise, unrelated ones by 1.4 times their noise.
const PAIRED_SHARE: f64 = 0.5;

/// Pixel difference that rounding may cause without noise.
const PAIRED_FLOOR: f64 = 1e-4;

/// The difference of a picture from the expected result, linear radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Mean over pixels and channels.
    pub bias: f64,
    /// Standard error of the bias.
    pub bias_deviation: f64,
    /// Root mean square over pixels; 0 if the expected result is a closed form.
    pub rms: f64,
}

impl Difference {
    /// From the radiance of every sample: that of the worst channel.
    pub fn from_every(level: &Level, value: f64) -> Self {
        let worst =
            level.mean.map(|mean| mean - value).into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        Difference { bias: worst.unwrap_or_default(), ..Difference::default() }
    }

    /// From the mean over pixels and channels.
    pub fn from_mean(level: &Level, value: f64) -> Self {
        Difference { bias: level.grey() - value, bias_deviation: level.deviation, rms: 0.0 }
    }

    /// From a film of the same samples, pixel by pixel. Both must have the same size.
    pub fn of(film: &Film, exact: &Film) -> Self {
        let (mut sum, mut sum_of_squares, mut squares, mut count) = (0.0, 0.0, 0.0, 0.0);
        for (a, b) in film.exact_means().zip(exact.exact_means()) {
            let difference = [0, 1, 2].map(|channel| a[channel] - b[channel]);
            let mean = grey(difference);
            sum += mean;
            sum_of_squares += mean * mean;
            squares += grey(difference.map(|x| x * x));
            count += 1.0;
        }
        let bias = sum / count;
        let variance = (sum_of_squares / count - bias * bias).max(0.0);
        Difference {
            bias,
            // A single pixel has no spread, so use its difference.
            bias_deviation: if count > 1.0 { (variance / (count - 1.0)).sqrt() } else { bias.abs() },
            rms: (squares / count).sqrt(),
        }
    }
}

/// A film's mean and noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Level {
    /// Mean over pixels, linear RGB.
    pub mean: [f64; 3],
    /// Standard error of the mean over pixels and channels, from the film's halves; 0 with a single half.
    pub deviation: f64,
    /// Root mean square of the pixels' noise, from the film's halves; 0 with a single half.
    pub noise: f64,
}

impl Level {
    pub fn of(film: &Film) -> Self {
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for mean in film.exact_means() {
            (0..3).for_each(|channel| sum[channel] += mean[channel]);
            count += 1.0;
        }
        let (mut variance_of_sum, mut squares) = (0.0, 0.0);
        for difference in half_differences(film).unwrap_or_default() {
            variance_of_sum += grey(difference).powi(2);
            squares += grey(difference.map(|x| x * x));
        }
        Level {
            mean: sum.map(|x| x / count),
            deviation: variance_of_sum.sqrt() / count,
            noise: (squares / count).sqrt(),
        }
    }

    /// Mean over pixels and channels.
    pub fn grey(&self) -> f64 {
        grey(self.mean)
    }
}

fn grey(channels: [f64; 3]) -> f64 {
    channels.iter().sum::<f64>() / 3.0
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(tag = "verdict", content = "reason", rename_all = "lowercase")]
pub enum Verdict {
    #[default]
    Right,
    /// Wrong, but the backend warned about it and offered a remedy.
    Warned(String),
    Wrong(String),
    /// No picture: it was refused, the tracer failed, or it took too long.
    None(String),
}

impl Verdict {
    /// Name in the table.
    pub fn name(&self) -> &'static str {
        match self {
            Verdict::Right => "right",
            Verdict::Warned(_) => "warned",
            Verdict::Wrong(_) => "WRONG",
            Verdict::None(_) => "NONE",
        }
    }

    /// The fault; empty for [`Verdict::Right`].
    pub fn reason(&self) -> &str {
        match self {
            Verdict::Right => "",
            Verdict::Warned(reason) | Verdict::Wrong(reason) | Verdict::None(reason) => reason,
        }
    }

    /// Whether the result is right or the backend warned about it.
    pub fn is_right(&self) -> bool {
        matches!(self, Verdict::Right | Verdict::Warned(_))
    }

    /// Turns a wrong result into a warned one if the backend gave a warning.
    #[must_use]
    pub fn given(self, warning: Option<&String>) -> Self {
        match (self, warning) {
            (Verdict::Wrong(reason), Some(warning)) => {
                Verdict::Warned(format!("{reason}; the backend warned: {warning}"))
            }
            (verdict, _) => verdict,
        }
    }
}

/// Judges a picture by its difference from the expected result.
pub fn judge(level: &Level, difference: &Difference, tolerance: f64, rejected: u64) -> Verdict {
    let Difference { bias, bias_deviation, rms } = *difference;
    let allowed = tolerance + DEVIATIONS * bias_deviation;
    let allowed_rms = (PAIRED_SHARE * level.noise).max(PAIRED_FLOOR);
    if rejected > 0 {
        Verdict::Wrong(format!("rejected samples (NaN, infinite or negative): {rejected}"))
    } else if bias.is_nan() || bias.abs() > allowed {
        Verdict::Wrong(format!("off by {bias:+.1e}; at most {allowed:.1e} is allowed"))
    } else if rms > allowed_rms {
        Verdict::Wrong(format!("pixels are off by {rms:.1e} RMS; at most {allowed_rms:.1e} is allowed"))
    } else {
        Verdict::Right
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::fixed_point;

    /// A film of one row; each half gives its pixels' sums in sixteenths.
    fn row(samples: u64, halves: [&[[f64; 3]]; 2]) -> Film {
        let mut film = Film::new(halves[0].len() as u32, 1);
        for (half, sums) in halves.into_iter().enumerate() {
            for (pixel, sum) in sums.iter().enumerate() {
                film.halves_mut()[half][pixel] = fixed_point(sum.map(|x| x / 16.0)).unwrap();
            }
        }
        film.record(0..samples, 0).unwrap();
        film
    }

    #[test]
    fn level_matches_hand_calculation() {
        // Two samples in the first half and one in the second.
        let film = row(3, [&[[4.0, 8.0, 12.0], [2.0; 3]], &[[5.0, 1.0, 3.0], [4.0; 3]]]);
        let level = Level::of(&film);
        let close = |x: f64, y: f64| (x - y).abs() < 1e-6;
        let mean = [15.0, 15.0, 21.0].map(|sum| sum / (3.0 * 2.0 * 16.0));
        assert!((0..3).all(|channel| close(level.mean[channel], mean[channel])), "{level:?}");
        assert!(close(level.grey(), 51.0 / 288.0), "{level:?}");
        // Half the differences of the means are -1.5, 1.5 and 1.5 in the first pixel and -1.5 in the second.
        assert!(close(level.noise, 1.5 / 16.0), "{level:?}");
        let deviation = (0.5_f64.powi(2) + 1.5_f64.powi(2)).sqrt() / (2.0 * 16.0);
        assert!(close(level.deviation, deviation), "{level:?}");
        let mut one_half = Film::new(1, 1);
        one_half.record(0..1, 0).unwrap();
        assert_eq!(Level::of(&one_half), Level::default());
    }

    #[test]
    fn pair_matches_hand_calculation() {
        let exact = row(2, [&[[1.0; 3]; 4], &[[1.0; 3]; 4]]);
        let pixels = [[2.0; 3], [3.0; 3], [4.0; 3], [7.0; 3]];
        let film = row(2, [&pixels, &pixels]);
        let close = |x: f64, y: f64| (x - y / 16.0).abs() < 1e-6;
        // The pixels differ by 1, 2, 3 and 6 sixteenths.
        let pair = Difference::of(&film, &exact);
        assert!(close(pair.bias, 3.0) && close(pair.bias_deviation, (3.5_f64 / 3.0).sqrt()), "{pair:?}");
        assert!(close(pair.rms, 12.5_f64.sqrt()), "{pair:?}");
        let [one, other] = [[[1.0, 2.0, 6.0]], [[1.0; 3]]].map(|pixel| row(2, [&pixel, &pixel]));
        let pair = Difference::of(&other, &one);
        assert!(close(pair.bias, -2.0) && close(pair.bias_deviation, 2.0), "{pair:?}");
        assert!(close(pair.rms, (26.0_f64 / 3.0).sqrt()), "{pair:?}");
    }

    #[test]
    fn worst_channel_counts() {
        let from = |mean| Difference::from_every(&Level { mean, ..Level::default() }, 0.5);
        for (mean, off) in [
            ([0.75, 0.5, 0.625], 0.25),
            ([0.375, 0.0, 0.875], -0.5),
            ([-0.5, 0.5, 0.75], -1.0),
            ([0.5; 3], 0.0),
        ] {
            assert_eq!(from(mean).bias, off, "{mean:?}");
        }
        for mean in [[f64::NAN, 0.25, 0.75], [0.5, 0.25, f64::NAN]] {
            let difference = from(mean);
            assert!(difference.bias.is_nan() && !judge(&Level::default(), &difference, 1.0, 0).is_right());
        }
    }

    /// Slightly within each limit and slightly beyond it.
    #[test]
    fn limits_are_where_they_should_be() {
        let level = |deviation, noise| Level { mean: [1.0; 3], deviation, noise };
        let (quiet, noisy) = (level(0.0, 0.0), level(1e-3, 0.1));
        let every = |value| Difference::from_every(&quiet, value);
        let mean = |value| Difference::from_mean(&noisy, value);
        let picture = |bias_deviation, bias, rms| Difference { bias, bias_deviation, rms };
        for (level, within, beyond) in [
            (quiet, every(1.0 - 0.99e-6), every(1.0 - 1.01e-6)),
            (noisy, mean(1.0039), mean(1.0041)),
            (noisy, mean(0.9961), mean(0.9959)),
            (noisy, picture(1e-4, 3.9e-4, 0.0), picture(1e-4, 4.1e-4, 0.0)),
            (noisy, picture(0.0, 0.0, 0.049), picture(0.0, 0.0, 0.051)),
            (quiet, picture(0.0, 0.0, 0.99e-4), picture(0.0, 0.0, 1.01e-4)),
        ] {
            assert!(judge(&level, &within, 1e-6, 0).is_right(), "{within:?}");
            assert!(!judge(&level, &beyond, 1e-6, 0).is_right(), "{beyond:?}");
            assert!(!judge(&level, &within, 1e-6, 1).is_right(), "rejected");
        }
    }
}
