//! Finds the path that differs most.

use super::compare::radiance_amount;
use super::side::Side;
use crate::render::{RenderError, RenderJob};

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Index of the sample.
    pub sample: u64,
    /// Number of samples per pixel that were searched.
    pub searched: u64,
    /// Number of samples, over all pixels, that differ by more than the tolerance.
    pub differing: u64,
}

/// Searches samples `0 .. samples` of all pixels for the one whose radiance differs most.
///
/// # Errors
/// [`RenderError`] of either side.
pub fn find(
    job: &RenderJob,
    sides: &mut [Side; 2],
    samples: u64,
    tolerance: f64,
) -> Result<Found, RenderError> {
    let mut found = Found { pixel: [0, 0], sample: 0, searched: samples, differing: 0 };
    let mut most = 0.0;
    for sample in 0..samples {
        let [a, b] = sides;
        let films = [a.film(job, sample)?, b.film(job, sample)?];
        let width = films[0].width() as usize;
        for pixel in 0..width * films[0].height() as usize {
            let [a, b] = [0, 1].map(|side| films[side].pixel_sum(pixel).radiance());
            found.differing += u64::from(radiance_amount(a, b) > tolerance);
            let by = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
            if by > most {
                most = by;
                (found.pixel, found.sample) = ([(pixel % width) as u32, (pixel / width) as u32], sample);
            }
        }
    }
    Ok(found)
}
