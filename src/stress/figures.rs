//! Figures from the films of a case: its mean, its distance from the expected result, and the effect of rounding.

use crate::film::Film;
use serde::Serialize;

/// The difference of two films of the same samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Paired {
    /// Mean difference over pixels and channels, linear radiance.
    pub bias: f64,
    /// Its standard error, from the spread over the pixels.
    pub bias_deviation: f64,
    /// Root mean square of the pixels' differences, linear radiance.
    pub rms: f64,
}

impl Paired {
    /// `film` minus `exact`, pixel by pixel. Both must have the same size.
    pub fn of(film: &Film, exact: &Film) -> Self {
        let count = pixel_count(film);
        let (mut sum, mut sum_of_squares, mut squares) = (0.0, 0.0, 0.0);
        for pixel in 0..count {
            let (a, b) = (film.mean(pixel), exact.mean(pixel));
            let difference = [0, 1, 2].map(|channel| a[channel] - b[channel]);
            let mean = difference.iter().sum::<f64>() / 3.0;
            sum += mean;
            sum_of_squares += mean * mean;
            squares += difference.iter().map(|x| x * x).sum::<f64>() / 3.0;
        }
        let count = count as f64;
        let bias = sum / count;
        let variance = (sum_of_squares / count - bias * bias).max(0.0);
        Paired {
            bias,
            // A single pixel has no spread: its difference is used instead.
            bias_deviation: if count > 1.0 { (variance / (count - 1.0)).sqrt() } else { bias.abs() },
            rms: (squares / count).sqrt(),
        }
    }
}

/// The mean of a film and its noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Level {
    /// Mean over pixels, linear RGB.
    pub mean: [f64; 3],
    /// Standard error of the mean over pixels and channels, from the film's halves; 0 if it has only one.
    pub deviation: f64,
    /// Root mean square of the pixels' noise, from the film's halves; 0 if it has only one.
    pub noise: f64,
}

impl Level {
    /// Measures a film.
    pub fn of(film: &Film) -> Self {
        let count = pixel_count(film);
        let mut sum = [0.0; 3];
        let (mut variance_of_sum, mut squares) = (0.0, 0.0);
        for pixel in 0..count {
            let mean = film.mean(pixel);
            (0..3).for_each(|channel| sum[channel] += mean[channel]);
            let half_difference = half_difference(film, pixel);
            variance_of_sum += (half_difference.iter().sum::<f64>() / 3.0).powi(2);
            squares += half_difference.iter().map(|x| x * x).sum::<f64>() / 3.0;
        }
        let count = count as f64;
        Level {
            mean: sum.map(|x| x / count),
            deviation: variance_of_sum.sqrt() / count,
            noise: (squares / count).sqrt(),
        }
    }

    /// The mean over pixels and channels.
    pub fn grey(&self) -> f64 {
        self.mean.iter().sum::<f64>() / 3.0
    }
}

/// Half the difference of the two halves' means; its square estimates the variance of the pixel.
fn half_difference(film: &Film, pixel: usize) -> [f64; 3] {
    let [a, b] = film.halves() else { return [0.0; 3] };
    let mean = |half: usize, sums: &[crate::film::PixelSum]| {
        sums[pixel].radiance().map(|sum| sum / film.half_sample_count(half).max(1) as f64)
    };
    let (a, b) = (mean(0, a), mean(1, b));
    [0, 1, 2].map(|channel| 0.5 * (a[channel] - b[channel]))
}

fn pixel_count(film: &Film) -> usize {
    film.width() as usize * film.height() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PixelSum, fixed_point};

    /// A film with one sample in each half.
    fn film(of: impl Fn(usize, usize) -> f64) -> Film {
        let mut film = Film::new(10, 10, 2);
        for half in 0..2 {
            for pixel in 0..100 {
                let sum: PixelSum = fixed_point([of(half, pixel); 3]).unwrap();
                film.halves_mut()[half][pixel] = sum;
            }
        }
        film.record(0..2, 0).unwrap();
        film
    }

    #[test]
    fn a_level_has_the_mean_and_its_noise() {
        let even = Level::of(&film(|_, _| 0.5));
        assert_eq!((even.mean, even.deviation, even.noise), ([0.5; 3], 0.0, 0.0));
        let noisy = Level::of(&film(|half, _| 0.4 + 0.2 * half as f64));
        assert!((noisy.grey() - 0.5).abs() < 1e-6 && (noisy.noise - 0.1).abs() < 1e-6, "{noisy:?}");
        assert!((noisy.deviation - 0.01).abs() < 1e-6, "{noisy:?}");
    }

    #[test]
    fn pairs_tell_bias_from_spread() {
        let exact = film(|_, _| 0.5);
        let moved = Paired::of(&film(|_, _| 0.5 + 1.0 / 1024.0), &exact);
        assert!((moved.bias - 1.0 / 1024.0).abs() < 1e-7 && moved.bias_deviation < 1e-7, "{moved:?}");
        let spread = Paired::of(&film(|_, pixel| if pixel % 2 == 0 { 0.6 } else { 0.4 }), &exact);
        assert!(spread.bias.abs() < 1e-6 && (spread.rms - 0.1).abs() < 1e-6, "{spread:?}");
        assert!((spread.bias_deviation - 0.01).abs() < 1e-3, "{spread:?}");
    }
}
