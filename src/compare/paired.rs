//! The same samples of two backends, compared one by one.

use crate::film::Film;
use serde::Serialize;

/// How far rounding may move samples that take the same path: root mean square.
pub const ROUNDING_RMS: f64 = 5e-5;

/// A sample with a larger difference has taken a different path.
pub const PARTED: f64 = 1e-3;

/// The share of samples that rounding may send along a different path.
pub const PARTED_SHARE: f64 = 1e-3;

/// How the same samples of two backends differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PairedSamples {
    /// Samples over all pixels.
    pub count: u64,
    /// Samples with a channel that differs by more than `PARTED`.
    pub parted: u64,
    /// Root mean square difference of the other samples.
    pub rms: f64,
    /// Mean difference of the other samples, second less first.
    pub bias: f64,
}

impl PairedSamples {
    /// The share of samples that took a different path.
    pub fn parted_share(&self) -> f64 {
        self.parted as f64 / self.count.max(1) as f64
    }
}

/// The sums from which [`PairedSamples`] are computed.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairedSums {
    count: u64,
    parted: u64,
    sum: f64,
    squares: f64,
}

impl PairedSums {
    /// Adds one sample of every pixel, as two backends traced it.
    pub fn add(&mut self, a: &Film, b: &Film) {
        for pixel in 0..a.width() as usize * a.height() as usize {
            let (a, b) = (a.pixel_sum(pixel).radiance(), b.pixel_sum(pixel).radiance());
            let difference = [0, 1, 2].map(|channel| b[channel] - a[channel]);
            self.count += 1;
            if difference.iter().any(|x| x.abs() > PARTED) {
                self.parted += 1;
            } else {
                self.sum += difference.iter().sum::<f64>();
                self.squares += difference.iter().map(|x| x * x).sum::<f64>();
            }
        }
    }

    /// The figures of all samples added so far.
    pub fn finish(&self) -> PairedSamples {
        let values = (3 * (self.count - self.parted)).max(1) as f64;
        PairedSamples {
            count: self.count,
            parted: self.parted,
            rms: (self.squares / values).sqrt(),
            bias: self.sum / values,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::fixed_point;

    /// A film of one row with one sample of each pixel.
    fn row(pixels: &[[f64; 3]]) -> Film {
        let mut film = Film::new(pixels.len() as u32, 1, 1);
        for (sum, pixel) in film.halves_mut()[0].iter_mut().zip(pixels) {
            *sum = fixed_point(*pixel).unwrap();
        }
        film.record(0..1, 0).unwrap();
        film
    }

    #[test]
    fn a_sample_is_parted_by_any_of_its_channels_and_the_others_are_averaged_over_all_three() {
        // In units that a film holds exactly.
        let unit = 2.0_f64.powi(-12);
        let at = |[r, g, b]: [f64; 3]| [0.5 + r * unit, 0.5 + g * unit, 0.5 + b * unit];
        let middle = row(&[[0.5; 3]; 5]);
        // Five units are more than a thousandth.
        let other =
            row(&[[0.0, 0.0, 5.0], [-5.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.0, -4.0, 0.0], [0.0; 3]].map(at));
        let mut sums = PairedSums::default();
        sums.add(&middle, &other);
        let found = sums.finish();
        assert_eq!((found.count, found.parted, found.parted_share()), (5, 2, 0.4));
        // Nine channels are left, with the sum 1 + 2 + 3 - 4 and the squares 1 + 4 + 9 + 16.
        assert!((found.bias - 2.0 / 9.0 * unit).abs() < 1e-15, "{found:?}");
        assert!((found.rms - (30.0_f64 / 9.0).sqrt() * unit).abs() < 1e-15, "{found:?}");
        sums.add(&other, &middle);
        let both = sums.finish();
        assert_eq!((both.count, both.parted, both.bias), (10, 4, 0.0));
        assert!((both.rms - found.rms).abs() < 1e-15, "{both:?}");
    }

    #[test]
    fn without_a_sample_on_the_same_path_nothing_differs_on_it() {
        let mut sums = PairedSums::default();
        assert_eq!((sums.finish(), sums.finish().parted_share()), (PairedSamples::default(), 0.0));
        sums.add(&row(&[[0.0; 3]]), &row(&[[1.0; 3]]));
        let found = sums.finish();
        assert_eq!((found.rms, found.bias, found.parted_share()), (0.0, 0.0, 1.0));
    }
}
