//! The picture of a film: means, and 8-bit values.

use super::{FIXED_POINT_SCALE, Film, PixelSum};
use crate::stages::Transfer;
use std::ops::Range;

impl Film {
    /// Mean radiance of pixel `index` (row by row from the top), linear RGB; black without samples.
    pub fn mean(&self, index: usize) -> [f64; 3] {
        let count = self.sample_count().max(1) as f64;
        self.pixel_sum(index).radiance().map(|x| x / count)
    }

    /// The mean of each pixel, as [`Film::mean`].
    pub fn exact_means(&self) -> impl Iterator<Item = [f64; 3]> {
        (0..self.halves()[0].len()).map(|pixel| self.mean(pixel))
    }

    /// The whole picture, linear RGB, row by row from the top.
    pub fn means(&self) -> Vec<[f32; 3]> {
        let unit = self.fixed_point_of_1();
        let mut pixels = vec![[0.0; 3]; self.width as usize * self.height as usize];
        self.for_each_sum(0..self.height, &mut pixels, |sum, pixel| {
            *pixel = sum.0.map(|k| (k as f64 / unit) as f32)
        });
        pixels
    }

    /// The picture in 8 bits: `transfer`, then `floor(256 clamp(v, 0, 0.999))`; top row first.
    pub fn to_rgb8(&self, transfer: Transfer) -> Vec<u8> {
        self.exposed(transfer, 0.0)
    }

    /// The picture in 8 bits with all radiance multiplied by `2^stops` first.
    pub fn exposed(&self, transfer: Transfer, stops: f64) -> Vec<u8> {
        let mut bytes = vec![0; self.width as usize * self.height as usize * 3];
        self.resolve_sums(0..self.height, transfer, self.fixed_point_of_1() / stops.exp2(), &mut bytes);
        bytes
    }

    /// Writes rows `rows` of [`Film::to_rgb8`] to `bytes` (`3 width` bytes per row). Rows do not depend on each other,
    /// so several threads can share a picture.
    ///
    /// # Panics
    /// If a row is below the picture, or `bytes` has the wrong length.
    pub fn resolve_rows(&self, rows: Range<u32>, transfer: Transfer, bytes: &mut [u8]) {
        self.resolve_sums(rows, transfer, self.fixed_point_of_1(), bytes);
    }

    /// Resolves rows so that a sum of `unit` is white.
    fn resolve_sums(&self, rows: Range<u32>, transfer: Transfer, unit: f64, bytes: &mut [u8]) {
        let height = self.height as usize;
        let (pixels, []) = bytes.as_chunks_mut::<3>() else { panic!("a pixel has 3 bytes") };
        assert_eq!(pixels.len(), self.width as usize * rows.len(), "3 bytes for each pixel of {rows:?}");
        // Chosen once per row, outside the pixel loop.
        for (line, row) in pixels.chunks_exact_mut(self.width as usize).zip(rows) {
            if transfer.is_gamma(row as usize, height) {
                self.for_each_sum(row..row + 1, line, |sum, pixel| {
                    *pixel = sum.0.map(|k| quantise((k as f64 / unit).sqrt()));
                });
            } else {
                self.for_each_sum(row..row + 1, line, |sum, pixel| {
                    *pixel = sum.0.map(|k| quantise(k as f64 / unit));
                });
            }
        }
    }

    /// The sum of a pixel whose samples are all 1. It is a product with a power of two, so dividing by it gives the
    /// same bits as dividing by the two factors.
    pub(super) fn fixed_point_of_1(&self) -> f64 {
        Film::fixed_point(self.sample_count())
    }

    /// As [`Film::fixed_point_of_1`], for `samples` samples per pixel.
    pub(super) fn fixed_point(samples: u64) -> f64 {
        samples.max(1) as f64 * FIXED_POINT_SCALE
    }

    fn for_each_sum<T>(&self, rows: Range<u32>, places: &mut [T], each: impl Fn(PixelSum, &mut T)) {
        let width = self.width as usize;
        let pixels = rows.start as usize * width..rows.end as usize * width;
        assert_eq!(places.len(), pixels.len(), "a place for each pixel of the rows {rows:?}");
        match self.halves.as_slice() {
            [half_a, half_b] => {
                for ((a, b), place) in half_a[pixels.clone()].iter().zip(&half_b[pixels]).zip(places) {
                    let mut sum = *a;
                    sum.add(*b);
                    each(sum, place);
                }
            }
            _ => {
                for (sum, place) in self.halves[0][pixels].iter().zip(places) {
                    each(*sum, place);
                }
            }
        }
    }
}

/// Converts one channel of a pixel in `row` of `height` from linear radiance to 8 bits.
pub fn to_byte(linear: f64, transfer: Transfer, row: usize, height: usize) -> u8 {
    quantise(if transfer.is_gamma(row, height) { linear.max(0.0).sqrt() } else { linear })
}

fn quantise(value: f64) -> u8 {
    (256.0 * value.clamp(0.0, 0.999)) as u8
}
