//! The error of a film, estimated from its halves.

use super::{FIXED_POINT_SCALE, Film, ROUNDING_LIMIT};

/// An estimate of the picture's error from its two halves. It is never below what rounding can cost, which the halves do
/// not show where both are rounded the same way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Root of the mean squared error over pixels and channels, linear radiance.
    pub rmse: f64,
    /// One standard deviation of `rmse`, from the spread of the squared errors over the pixels. Neither number includes
    /// features that no sample has hit yet.
    pub rmse_deviation: f64,
    /// `mean(error^2 / (mean^2 + 0.01))`, which gives errors in dark regions more weight.
    pub rel_mse: f64,
}

/// The most that rounding can add to `rel_mse`.
const ROUNDING_REL_MSE: f64 = ROUNDING_LIMIT * ROUNDING_LIMIT / 1e-2;

impl ErrorEstimate {
    /// The effective number of pixels behind the estimate, `(sum e^2)^2 / sum e^4` with `e` the errors. It is small if
    /// a few pixels dominate, and infinite without any error.
    pub fn pixels_in_effect(&self) -> f64 {
        // For n pixels, the variance of the mean square is (mean e^4 - (mean e^2)^2) / n.
        let share = 2.0 * self.rmse_deviation / self.rmse;
        if share > 0.0 { 1.0 / (share * share) } else { f64::INFINITY }
    }

    /// Whether the halves do not differ, so that only rounding is left. Either the picture has no noise, or no path has
    /// found any light yet.
    pub fn is_without_noise(&self) -> bool {
        self.rmse <= ROUNDING_LIMIT
    }

    /// The error in words: `2.000e-2 ± 5.0 % RMSE`, or how much rounding can cost if there is nothing else.
    pub fn words(&self) -> String {
        if self.is_without_noise() {
            format!("{ROUNDING_LIMIT:.0e} RMSE, by rounding alone")
        } else {
            format!("{:.3e} {} RMSE", self.rmse, self.uncertainty())
        }
    }

    /// The relative uncertainty of the estimate, one standard deviation, such as "± 0.2 %".
    pub fn uncertainty(&self) -> String {
        let share = if self.rmse > 0.0 { self.rmse_deviation / self.rmse } else { 0.0 };
        format!("± {:.1} %", (100.0 * share).max(0.1))
    }
}

impl Film {
    /// The error estimated from the halves. With `A` and `B` the means of `a` and `b` samples,
    /// `MSE = mean((A - B)^2) a b / (a + b)^2`. This is a quarter of the squared difference when `a = b`, as after
    /// every even number of samples. The root is at least [`ROUNDING_LIMIT`]. `None` with one half, or while a half has
    /// no samples.
    pub fn error(&self) -> Option<ErrorEstimate> {
        let [half_a, half_b] = self.halves.as_slice() else { return None };
        let (count_a, count_b) = (self.half_sample_count(0) as f64, self.half_sample_count(1) as f64);
        if count_a == 0.0 || count_b == 0.0 || half_a.is_empty() {
            return None;
        }
        let count = count_a + count_b;
        let (scale_a, scale_b) = (1.0 / (count_a * FIXED_POINT_SCALE), 1.0 / (count_b * FIXED_POINT_SCALE));
        let scale = 1.0 / (count * FIXED_POINT_SCALE);
        let weight = (count_a / count) * (count_b / count);
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
        let deviation_of_square = ((fourth_power - square * square).max(0.0) / pixels).sqrt();
        let rmse = square.sqrt();
        Some(ErrorEstimate {
            rmse: rmse.max(ROUNDING_LIMIT),
            rmse_deviation: if rmse > ROUNDING_LIMIT { 0.5 * deviation_of_square / rmse } else { 0.0 },
            rel_mse: (relative_sum / (3.0 * pixels)).max(ROUNDING_REL_MSE),
        })
    }
}
