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

    /// A film in a row, of these samples; each half has the sums of its pixels in units of a sixteenth.
    fn row(samples: u64, halves: [&[[f64; 3]]; 2]) -> Film {
        let mut film = Film::new(halves[0].len() as u32, 1, 2);
        for (half, sums) in halves.into_iter().enumerate() {
            for (pixel, sum) in sums.iter().enumerate() {
                film.halves_mut()[half][pixel] = fixed_point(sum.map(|x| x / 16.0)).unwrap();
            }
        }
        film.record(0..samples, 0).unwrap();
        film
    }

    #[test]
    fn a_level_is_worked_out_by_hand() {
        // Two samples in the first half and one in the second.
        let film = row(3, [&[[4.0, 8.0, 12.0], [2.0; 3]], &[[5.0, 1.0, 3.0], [4.0; 3]]]);
        let level = Level::of(&film);
        let close = |x: f64, y: f64| (x - y).abs() < 1e-6;
        let mean = [15.0, 15.0, 21.0].map(|sum| sum / (3.0 * 2.0 * 16.0));
        assert!((0..3).all(|channel| close(level.mean[channel], mean[channel])), "{level:?}");
        assert!(close(level.grey(), 51.0 / 288.0), "{level:?}");
        // Half the differences of the means are -1.5, 1.5 and 1.5 in the first pixel and -1.5 in the second.
        assert!(close(level.noise, 1.5 / 16.0), "{level:?}");
        assert!(
            close(level.deviation, (0.5_f64.powi(2) + 1.5_f64.powi(2)).sqrt() / (2.0 * 16.0)),
            "{level:?}"
        );
        let mut one_half = Film::new(1, 1, 1);
        one_half.record(0..1, 0).unwrap();
        assert_eq!(Level::of(&one_half), Level::default());
    }

    #[test]
    fn a_pair_is_worked_out_by_hand() {
        let exact = row(2, [&[[1.0; 3]; 4], &[[1.0; 3]; 4]]);
        let film =
            row(2, [&[[2.0; 3], [3.0; 3], [4.0; 3], [7.0; 3]], &[[2.0; 3], [3.0; 3], [4.0; 3], [7.0; 3]]]);
        let close = |x: f64, y: f64| (x - y / 16.0).abs() < 1e-6;
        // The differences of the pixels are 1, 2, 3 and 6 sixteenths.
        let pair = Paired::of(&film, &exact);
        assert!(close(pair.bias, 3.0) && close(pair.bias_deviation, (3.5_f64 / 3.0).sqrt()), "{pair:?}");
        assert!(close(pair.rms, 12.5_f64.sqrt()), "{pair:?}");
        assert!(close(Paired::of(&exact, &film).bias, -3.0));
        let [one, other] = [[[1.0, 2.0, 6.0]], [[1.0; 3]]].map(|pixel| row(2, [&pixel, &pixel]));
        let pair = Paired::of(&other, &one);
        assert!(close(pair.bias, -2.0) && close(pair.bias_deviation, 2.0), "{pair:?}");
        assert!(close(pair.rms, (26.0_f64 / 3.0).sqrt()), "{pair:?}");
    }
}
