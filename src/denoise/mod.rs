//! A picture with less noise, made from the two halves of a film, and its error, which needs no reference.
//!
//! Each half is filtered by itself in two steps: non-local means over few shifts give a *pilot*, then a plane is fitted
//! to the half around each pixel, with weights that compare patches of the pilot. What the filter loses is given back as
//! far as the other half confirms it. The mean of both filtered halves is the picture. A filtered half minus the other
//! half, whose noise is independent of it, tells the error.
//!
//! Sources: F. Rousselle, C. Knaus, M. Zwicker, *Adaptive Rendering with Non-Local Means Filtering*, 2012, for the distance
//! of patches and the use of two halves; A. Buades, B. Coll, J.-M. Morel, *A non-local algorithm for image denoising*,
//! 2005, for non-local means; B. Bitterli et al., *Nonlinearly Weighted First-order Regression for Denoising Monte Carlo
//! Renderings*, 2016, for fitting a plane.

mod filter;
mod repair;

use crate::film::{FIXED_POINT_MAX, FIXED_POINT_SCALE, Film, PixelSum};
use crate::system::memory;
use anyhow::{Result, bail, ensure};
use fearless_simd::{Level, Simd as _, dispatch};
use filter::{HIGH, Half, Place, Scratch, WIDE};
use rayon::prelude::*;
use repair::window_sums;
use std::array::from_fn;
use std::sync::atomic::{AtomicBool, Ordering};

/// Smaller pictures have too few pixels to tell an error from.
const LEAST_PIXELS: usize = 64;

/// Bytes per pixel that denoising needs besides the film.
pub const BYTES_PER_PIXEL: u64 =
    (6 * size_of::<[f32; 3]>() + size_of::<PixelSum>() + 2 * size_of::<f32>()) as u64;

/// The means of a film's halves.
pub struct Halves {
    /// Linear RGB, row by row from the top.
    pixels: [Vec<[f32; 3]>; 2],
    /// Samples per pixel of each.
    counts: [u64; 2],
    /// The parts of the mean squared difference between the halves that are the variances of each.
    shares: [f32; 2],
    /// Mean squared error of the film, as estimated.
    raw_mse: f64,
    /// A place for the denoised picture.
    picture: Film,
}

impl Halves {
    /// # Errors
    /// If a half is missing, empty or black, or if the picture is too small or too large.
    pub fn of(film: &Film) -> Result<Self> {
        let pixels = film.width() as usize * film.height() as usize;
        ensure!(
            pixels >= LEAST_PIXELS,
            "telling the error of denoising takes {LEAST_PIXELS} pixels, and the picture has {pixels}"
        );
        let counts = [0, 1].map(|half| film.half_sample_count(half));
        let (Some(error), [a, b]) = (film.error(), film.halves()) else {
            bail!("{}, and denoising needs two halves with light: render more samples", film.why_no_error());
        };
        let what = || format!("denoising {}x{} pixels", film.width(), film.height());
        memory::check(what, BYTES_PER_PIXEL * pixels as u64, "choose a smaller picture")?;
        let means = |half: &Vec<PixelSum>, count: u64| {
            let unit = count as f64 * FIXED_POINT_SCALE;
            half.par_iter().map(|sum| sum.0.map(|k| (k as f64 / unit) as f32)).collect()
        };
        let pixels = [means(a, counts[0]), means(b, counts[1])];
        let shares = film.variance_shares().map(|share| share as f32);
        Ok(Halves { pixels, counts, shares, raw_mse: error.rmse * error.rmse, picture: film.try_blank()? })
    }
}

/// A denoised picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Denoised {
    /// The picture, as a film of one half with the samples of the film that it was made from. Negative values, which
    /// fitting can give, are 0.
    pub film: Film,
    /// The estimated RMSE of the 17x17 pixels around each one: fewer would tell little.
    pub errors: Vec<f32>,
    pub error: DenoisedError,
}

impl Denoised {
    /// Whether it can stand for this film: it has the same size, and no samples that the film lacks.
    pub fn is_of(&self, film: &Film) -> bool {
        let size = |film: &Film| (film.width(), film.height());
        size(film) == size(&self.film) && film.samples().contains(self.film.samples())
    }

    /// This picture, unless the raw one is better.
    ///
    /// # Errors
    /// If the estimated error is above that of the raw picture.
    pub fn checked(self) -> Result<Self> {
        let (mine, raw) = (self.error.rmse(), self.error.raw_mse.sqrt());
        ensure!(
            mine <= raw,
            "its error would grow from {raw:.3e} to {mine:.3e} RMSE, because the filter loses detail"
        );
        Ok(self)
    }
}

/// The error of a denoised picture, estimated from the halves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DenoisedError {
    /// Mean squared error over pixels and channels, linear radiance. Noise can make it negative.
    pub mse: f64,
    /// One standard deviation of `mse`.
    pub mse_deviation: f64,
    /// Mean squared error of the picture that was not filtered.
    pub raw_mse: f64,
}

impl DenoisedError {
    pub fn rmse(&self) -> f64 {
        self.mse.max(0.0).sqrt()
    }

    /// An RMSE that the true one exceeds once in forty pictures: two standard deviations of `mse` above it.
    pub fn upper_rmse(&self) -> f64 {
        (self.mse.max(0.0) + 2.0 * self.mse_deviation).sqrt()
    }

    /// Whether the error is at most `target`. An estimate that rests on few pixels must be lower still.
    pub fn meets(&self, target: f64) -> bool {
        // As for the raw picture, fewer than 100: see `mse_deviation`.
        let rests_on_few_pixels = self.mse < (100.0_f64 / 2.0).sqrt() * self.mse_deviation;
        let deviations = if rests_on_few_pixels { 3.0 } else { 2.0 };
        (self.mse.max(0.0) + deviations * self.mse_deviation).sqrt() <= target
    }

    /// One standard deviation of [`DenoisedError::rmse`], upwards.
    pub fn rmse_deviation(&self) -> f64 {
        (self.mse.max(0.0) + self.mse_deviation).sqrt() - self.rmse()
    }

    /// The error as text: `3.000e-3 ± 2.0e-4 RMSE (raw 1.100e-2)`, or an upper bound if it is too small to tell.
    pub fn words(&self) -> String {
        let raw = self.raw_mse.sqrt();
        if self.mse <= 0.0 {
            return format!("below {:.1e} RMSE (raw {raw:.3e})", self.upper_rmse());
        }
        format!("{:.3e} ± {:.1e} RMSE (raw {raw:.3e})", self.rmse(), self.rmse_deviation())
    }
}

/// The squared error of one channel, by the values of the halves and the filtered halves. A filtered half minus the other
/// half is its error plus noise that is independent of it, whose variance the halves tell. The mean of both lacks the
/// part in which they differ. `weights` are those of the halves in the picture, and `shares` their parts of the variance
/// of the difference.
fn squared_error(weights: [f32; 2], shares: [f32; 2], [a, b]: [f32; 2], [fa, fb]: [f32; 2]) -> f32 {
    let ([wa, wb], [sa, sb], square) = (weights, shares, |x: f32| x * x);
    let noise = square(a - b);
    wa * (square(fa - b) - sb * noise) + wb * (square(fb - a) - sa * noise) - wa * wb * square(fa - fb)
}

/// Denoises a film.
///
/// # Errors
/// Those of [`Halves::of`] and [`Denoised::checked`].
pub fn of_film(film: &Film) -> Result<Denoised> {
    filtered(Halves::of(film)?, Level::new(), &AtomicBool::new(false)).checked()
}

/// Denoises a film, well or not; `None` if `stop` is set meanwhile.
pub fn denoise(halves: Halves, stop: &AtomicBool) -> Option<Denoised> {
    let denoised = filtered(halves, Level::new(), stop);
    (!stop.load(Ordering::Relaxed)).then_some(denoised)
}

/// Filters a picture, on all threads of the current pool. The result does not depend on the processor or the number of
/// threads. It is incomplete if `stop` is set.
fn filtered(halves: Halves, level: Level, stop: &AtomicBool) -> Denoised {
    let Halves { pixels, counts, shares, raw_mse, picture: mut film } = halves;
    let size = [film.width() as usize, film.height() as usize];
    let inputs: [Half; 2] = from_fn(|i| Half { pixels: &pixels[i], share: shares[i] });
    let mut smooth = pixels.clone();
    let [a, b] = &mut smooth;
    let rows = HIGH * size[0];
    let bands = a.par_chunks_mut(rows).zip(b.par_chunks_mut(rows)).enumerate();
    bands.for_each_init(bytemuck::zeroed_box::<Scratch>, |scratch, (band, (a, b))| {
        for first in (0..size[0]).step_by(WIDE).take_while(|_| !stop.load(Ordering::Relaxed)) {
            let place = Place { first: [first, band * HIGH], size };
            dispatch!(level, simd => simd.vectorize(#[inline(always)] || filter::filter(&inputs, place, scratch)));
            for (half, out) in [&mut *a, &mut *b].into_iter().enumerate() {
                for (y, line) in out.chunks_mut(size[0]).enumerate() {
                    for (column, pixel) in line[first..].iter_mut().take(WIDE).enumerate() {
                        *pixel = from_fn(|c| scratch.filtered[half][y][c][column]);
                    }
                }
            }
        }
    });
    let [a, b] = &pixels;
    repair::repair(size, a, b, &mut smooth[0]);
    repair::repair(size, b, a, &mut smooth[1]);

    let count = film.sample_count() as f64;
    let weights = counts.map(|of_half| (of_half as f64 / count) as f32);
    let (unit, most) = (count * FIXED_POINT_SCALE, count * f64::from(FIXED_POINT_MAX));
    let mut squared_errors = vec![[0.0]; size[0] * size[1]];
    let outputs = film.halves_mut()[0].par_iter_mut().zip(&mut squared_errors);
    outputs.enumerate().for_each(|(i, (picture, error))| {
        let ([a, b], [fa, fb]) = ([pixels[0][i], pixels[1][i]], [smooth[0][i], smooth[1][i]]);
        let mean = [0, 1, 2].map(|c| f64::from(weights[0] * fa[c] + weights[1] * fb[c]));
        *picture = PixelSum(mean.map(|x| (x * unit).clamp(0.0, most) as u64));
        let square = |c| squared_error(weights, shares, [a[c], b[c]], [fa[c], fb[c]]);
        *error = [(0..3).map(square).sum::<f32>() / 3.0];
    });
    let pixels = squared_errors.len() as f64;
    let mean = |of: fn(f64) -> f64| squared_errors.iter().map(|[e]| of(f64::from(*e))).sum::<f64>() / pixels;
    let (mse, of_squares) = (mean(|error| error), mean(|error| error * error));
    // Two pixels that enter each other's means have the same products of both halves' noise in their errors. So the mean has
    // up to twice the variance that it would have if the pixels were independent.
    let mse_deviation = (2.0 * (of_squares - mse * mse).max(0.0) / (pixels - 1.0)).sqrt();
    let error = DenoisedError { mse, mse_deviation, raw_mse };
    let errors = local(size, &squared_errors);
    Denoised { film, errors, error }
}

/// The root of the mean squared error of the 17x17 pixels around each one.
fn local(size: [usize; 2], squared_errors: &[[f32; 1]]) -> Vec<f32> {
    const REACH: isize = 8;
    let sums = window_sums(size, REACH as usize, -REACH..=REACH, 1, |i| [squared_errors[i][0], 1.0]);
    sums.into_par_iter().map(|[sum, count]| (f32::max(sum, 0.0) / count).sqrt()).collect()
}

#[cfg(test)]
mod tests;
