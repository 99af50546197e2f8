//! The error of a film, estimated from its halves.

use super::{FIXED_POINT_SCALE, Film, PixelSum, ROUNDING_LIMIT};
use std::f64::consts::SQRT_2;

/// An estimate of the picture's error from its two halves. Never below what rounding can cost, because halves that
/// round alike hide that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Root of the mean squared error over pixels and channels, linear radiance, at least [`ROUNDING_LIMIT`].
    pub rmse: f64,
    /// One standard deviation of the difference between `rmse` and the error of this picture, from the spread of the
    /// squared errors over the pixels; 0 if rounding is all. Neither number includes features that no sample has hit yet.
    pub rmse_deviation: f64,
    /// `mean(error^2 / (mean^2 + 0.01))`, which gives errors in dark regions more weight.
    pub rel_mse: f64,
}

/// The error estimate is doubtful if it effectively rests on fewer pixels than this.
const PIXELS_IN_EFFECT_MIN: f64 = 100.0;

/// In pictures with more pixels than that, it is doubtful only if they are also less than this share of all pixels.
const DOMINANT_SHARE: f64 = 0.2;

/// A doubtful estimate must be below a target by this many of its standard deviations.
const DEVIATIONS: f64 = 3.0;

/// The most that rounding can add to `rel_mse`.
const ROUNDING_REL_MSE: f64 = ROUNDING_LIMIT * ROUNDING_LIMIT / 1e-2;

impl ErrorEstimate {
    /// The effective number of pixels behind the estimate, `(sum e^2)^2 / sum e^4` with `e` the errors. It is small if
    /// a few pixels dominate, and infinite without any error.
    pub fn pixels_in_effect(&self) -> f64 {
        // For n pixels, the variance of the mean square is (mean e^4 - (mean e^2)^2) / n.
        let share = SQRT_2 * self.rmse_deviation / self.rmse;
        if share > 0.0 { 1.0 / (share * share) } else { f64::INFINITY }
    }

    /// Whether the halves differ by no more than rounding can cost.
    pub fn is_without_noise(&self) -> bool {
        self.rmse <= ROUNDING_LIMIT
    }

    /// The error as text: `2.000e-2 ± 5.0 % RMSE`, or what rounding can cost if that is more than the noise.
    pub fn words(&self) -> String {
        if self.is_without_noise() {
            format!("{ROUNDING_LIMIT:.0e} RMSE, by rounding alone")
        } else {
            format!("{:.3e} {} RMSE", self.rmse, self.uncertainty())
        }
    }

    /// The relative uncertainty of the estimate, one standard deviation, such as "± 0.2 %".
    pub fn uncertainty(&self) -> String {
        format!("± {:.1} %", (100.0 * self.rmse_deviation / self.rmse).max(0.1))
    }
}

impl Film {
    /// The error estimated from the halves. With `A` and `B` the means of `a` and `b` samples, and `s` and `t` the parts
    /// of `mean((A - B)^2)` that are their variances, `MSE = mean((A - B)^2) (s a^2 + t b^2) / (a + b)^2`. This is a
    /// quarter of the squared difference when `a = b`, as after every even number of samples. The root is at least
    /// [`ROUNDING_LIMIT`]. `None` while a half has no samples, and while all of it is black, because
    /// equal halves say nothing about light that no path has found.
    pub fn error(&self) -> Option<ErrorEstimate> {
        let [half_a, half_b] = self.halves.as_slice() else { return None };
        let (count_a, count_b) = (self.half_sample_count(0) as f64, self.half_sample_count(1) as f64);
        if count_a == 0.0 || count_b == 0.0 || self.is_black() {
            return None;
        }
        let count = count_a + count_b;
        let (scale_a, scale_b) = (1.0 / (count_a * FIXED_POINT_SCALE), 1.0 / (count_b * FIXED_POINT_SCALE));
        let scale = 1.0 / (count * FIXED_POINT_SCALE);
        let [share_a, share_b] = self.variance_shares();
        let weight = share_a * (count_a / count).powi(2) + share_b * (count_b / count).powi(2);
        let (mut square_sum, mut relative_sum, mut fourth_power_sum) = (0.0, 0.0, 0.0);
        for (a, b) in half_a.iter().zip(half_b) {
            let (mut squares, mut references) = ([0.0; 3], [0.0; 3]);
            for channel in 0..3 {
                let (a, b) = (a.0[channel], b.0[channel]);
                let mean = (a + b) as f64 * scale;
                let difference = a as f64 * scale_a - b as f64 * scale_b;
                squares[channel] = difference * difference * weight;
                references[channel] = mean * mean + 1e-2;
            }
            // One division instead of three, which take longer than all the rest.
            let ([x, y, z], [u, v, w]) = (squares, references);
            relative_sum += (x * v * w + y * u * w + z * u * v) / (u * v * w);
            // The channels of a pixel share their noise.
            let of_pixel = squares.iter().sum::<f64>();
            square_sum += of_pixel;
            fourth_power_sum += of_pixel * of_pixel;
        }
        let pixels = half_a.len() as f64;
        let [square, fourth_power] = [square_sum / (3.0 * pixels), fourth_power_sum / (9.0 * pixels)];
        // Normal noise has this spread at least, which few pixels may not show. This picture's own error deviates from
        // the expected one as much as the estimate does, hence the root of 2.
        let spread = (fourth_power - square * square).max(2.0 / 3.0 * square * square);
        let deviation_of_square = SQRT_2 * (spread / pixels).sqrt();
        let rmse = square.sqrt();
        Some(ErrorEstimate {
            rmse: rmse.max(ROUNDING_LIMIT),
            rmse_deviation: if rmse > ROUNDING_LIMIT { 0.5 * deviation_of_square / rmse } else { 0.0 },
            rel_mse: (relative_sum / (3.0 * pixels)).max(ROUNDING_REL_MSE),
        })
    }

    /// Whether this film's error, estimated as `estimate`, is at most `target`. An estimate dominated by few pixels
    /// must be lower still. While no path has found light, the error may be as large as `brightest`, the largest
    /// radiance of a sample.
    pub fn meets(&self, target: f64, estimate: Option<&ErrorEstimate>, brightest: f64) -> bool {
        match estimate {
            Some(found) if self.rests_on_few_pixels(found) => {
                found.rmse + DEVIATIONS * found.rmse_deviation <= target
            }
            Some(found) => found.rmse <= target,
            None => self.has_both_halves() && brightest <= target,
        }
    }

    /// Why the estimate is doubtful: if few pixels dominate it, it and its deviation are likely too low.
    pub fn doubt(&self, estimate: &ErrorEstimate) -> Option<String> {
        let (pixels, all) = (estimate.pixels_in_effect(), self.halves[0].len());
        self.rests_on_few_pixels(estimate).then(|| {
            if (all as f64) < PIXELS_IN_EFFECT_MIN {
                return format!(
                    "an error estimate needs {PIXELS_IN_EFFECT_MIN:.0} pixels, but the picture has {all}: it may be far \
                     too low"
                );
            }
            format!(
                "a few pixels dominate the error estimate: it effectively rests on {pixels:.0} of {all} pixels, but needs \
                 {PIXELS_IN_EFFECT_MIN:.0}; until there are more samples it may be far too low"
            )
        })
    }

    fn rests_on_few_pixels(&self, estimate: &ErrorEstimate) -> bool {
        let (pixels, all) = (estimate.pixels_in_effect(), self.halves[0].len() as f64);
        pixels < PIXELS_IN_EFFECT_MIN && (all < PIXELS_IN_EFFECT_MIN || pixels < DOMINANT_SHARE * all)
    }

    /// The parts of the squared difference between the halves that are the variance of each. Where one half has more
    /// samples, how much less its variance is depends on the sampler and the scene. The steps from pixel to pixel
    /// reveal it: apart from noise, they are the same in both halves.
    pub(crate) fn variance_shares(&self) -> [f64; 2] {
        let counts = [0, 1].map(|half| self.half_sample_count(half));
        let [a, b] = counts.map(|count| count as f64 * FIXED_POINT_SCALE);
        let (mut difference, mut steps, mut before) = (0.0, 0.0, None);
        if counts[0] != counts[1] {
            for (PixelSum(sum_a), PixelSum(sum_b)) in self.halves[0].iter().zip(&self.halves[1]) {
                let own = [sum_a.map(|k| k as f64 / a), sum_b.map(|k| k as f64 / b)];
                let [before_a, before_b] = before.replace(own).unwrap_or(own);
                for channel in 0..3 {
                    let [x, y] = [own[0][channel], own[1][channel]];
                    difference += (x - y) * (x - y);
                    steps += (x - before_a[channel]).powi(2) - (y - before_b[channel]).powi(2);
                }
            }
        }
        // The half with fewer samples has more of the variance.
        let lean = if difference > 0.0 { 0.5 * steps / difference } else { 0.0 };
        let lean = if counts[0] > counts[1] { lean.clamp(-1.0, 0.0) } else { lean.clamp(0.0, 1.0) };
        [0.5 + 0.5 * lean, 0.5 - 0.5 * lean]
    }

    /// Whether no path has found any light.
    fn is_black(&self) -> bool {
        self.halves.iter().flatten().all(|sum| sum.0 == [0; 3])
    }

    /// The estimated error, or why there is none.
    pub fn error_words(&self) -> String {
        let none = || format!("not estimated: {}", self.why_no_error());
        self.error().map_or_else(none, |error| error.words())
    }

    /// Why [`Film::error`] returns `None`.
    pub fn why_no_error(&self) -> &'static str {
        if !self.has_both_halves() { "only one half has samples" } else { "no path has found any light" }
    }

    fn has_both_halves(&self) -> bool {
        (0..2).all(|half| self.half_sample_count(half) > 0)
    }
}
