//! The same samples of two backends, compared one by one.

use crate::film::Film;
use serde::Serialize;

/// How far rounding may move samples that take the same path: root mean square.
pub const ROUNDING_RMS: f64 = 5e-5;

/// A sample with a larger difference has taken a different path.
pub const PARTED: f64 = 1e-3;

/// The share of samples that rounding may send along a different path.
pub const PARTED_SHARE: f64 = 1e-3;

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
