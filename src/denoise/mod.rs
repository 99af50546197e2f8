//! A picture with less noise, made from the two halves of a film, and its error, which needs no reference.
//!
//! Each half is filtered by itself in two steps: non-local means over few shifts give a *pilot*, then a plane is fitted
//! to the half around each pixel, with weights that compare patches of the pilot. The mean of both filtered halves is
//! the picture. A filtered half minus the other half, whose noise is independent of it, tells the error.
//!
//! Sources: F. Rousselle, C. Knaus, M. Zwicker, *Adaptive Rendering with Non-Local Means Filtering*, 2012, for the distance
//! of patches and the use of two halves; A. Buades, B. Coll, J.-M. Morel, *A non-local algorithm for image denoising*,
//! 2005, for non-local means; B. Bitterli et al., *Nonlinearly Weighted First-order Regression for Denoising Monte Carlo
//! Renderings*, 2016, for fitting a plane.

mod filter;

use crate::film::{FIXED_POINT_MAX, FIXED_POINT_SCALE, Film, PixelSum};
use crate::system::memory;
use anyhow::{Result, bail, ensure};
use fearless_simd::{Level, Simd as _, dispatch};
use filter::{HIGH, Half, Place, Scratch, WIDE};
use rayon::prelude::*;
use std::array::from_fn;
use std::sync::atomic::{AtomicBool, Ordering};

/// Smaller pictures have too few pixels to tell an error from.
const LEAST_PIXELS: usize = 64;

/// The means of a film's halves.
pub struct Halves {
    /// Linear RGB, row by row from the top.
    pixels: [Vec<[f32; 3]>; 2],
    /// Samples per pixel of each.
    counts: [u64; 2],
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
            bail!(
                "{}, and denoising needs two halves with light: render more samples, with --estimate-error on",
                film.why_no_error()
            );
        };
        let what = || format!("denoising {}x{} pixels", film.width(), film.height());
        let bytes = pixels * (2 * size_of::<[f32; 3]>() + size_of::<PixelSum>() + size_of::<f32>());
        memory::check(what, bytes as u64, "choose a smaller picture")?;
        let means = |half: &Vec<PixelSum>, count: u64| {
            let unit = count as f64 * FIXED_POINT_SCALE;
            half.par_iter().map(|sum| sum.0.map(|k| (k as f64 / unit) as f32)).collect()
        };
        let pixels = [means(a, counts[0]), means(b, counts[1])];
        Ok(Halves { pixels, counts, raw_mse: error.rmse * error.rmse, picture: film.try_blank()? })
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

    /// One standard deviation of [`DenoisedError::rmse`], upwards.
    pub fn rmse_deviation(&self) -> f64 {
        (self.mse.max(0.0) + self.mse_deviation).sqrt() - self.rmse()
    }

    /// The error as text: `3.000e-3 ± 2.0e-4 RMSE (raw 1.100e-2)`.
    pub fn words(&self) -> String {
        format!("{:.3e} ± {:.1e} RMSE (raw {:.3e})", self.rmse(), self.rmse_deviation(), self.raw_mse.sqrt())
    }
}

/// Whether a pixel is one of the chessboard's odd fields. The filters use variances from these only, and the error is
/// estimated in the others.
fn is_odd(x: usize, y: usize) -> bool {
    (x + y) % 2 == 1
}

/// The squared error of one channel, by the values of the halves and the filtered halves. A filtered half minus the other
/// half is its error plus noise that is independent of it, whose variance the halves tell. The mean of both lacks the
/// part in which they differ. `weights` are those of the halves in the picture.
fn squared_error(weights: [f32; 2], [a, b]: [f32; 2], [fa, fb]: [f32; 2]) -> f32 {
    let ([wa, wb], square) = (weights, |x: f32| x * x);
    let noise = square(a - b);
    wa * (square(fa - b) - wa * noise) + wb * (square(fb - a) - wb * noise) - wa * wb * square(fa - fb)
}

/// The root of the mean of the even fields around each pixel.
fn local(width: usize, squared_errors: &[f32]) -> Vec<f32> {
    const REACH: usize = 8;
    let around = |at: usize, end: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(end);
    // Sum and number of the even fields in a piece of a row.
    let of_row = |(y, row): (usize, &[f32])| -> Vec<[f32; 2]> {
        let of_piece = |x| {
            let piece = around(x, width);
            let even = row[piece.start..piece.end].iter().skip((piece.start + y) % 2).step_by(2);
            even.fold([0.0, 0.0], |[sum, count], error| [sum + error, count + 1.0])
        };
        (0..width).map(of_piece).collect()
    };
    let rows: Vec<Vec<[f32; 2]>> = squared_errors.par_chunks(width).enumerate().map(of_row).collect();
    let mut errors = vec![0.0; squared_errors.len()];
    errors.par_chunks_mut(width).enumerate().for_each(|(y, errors)| {
        for (x, error) in errors.iter_mut().enumerate() {
            let near = rows[around(y, rows.len())].iter().map(|row| row[x]);
            let [sum, count] = near.fold([0.0, 0.0], |[sum, count], [s, c]| [sum + s, count + c]);
            *error = (f32::max(sum, 0.0) / f32::max(count, 1.0)).sqrt();
        }
    });
    errors
}

/// Denoises a film.
///
/// # Errors
/// Those of [`Halves::of`].
pub fn of_film(film: &Film) -> Result<Denoised> {
    Ok(filtered(Halves::of(film)?, Level::new(), &AtomicBool::new(false)))
}

/// Denoises a film; `None` if `stop` is set meanwhile.
pub fn denoise(halves: Halves, stop: &AtomicBool) -> Option<Denoised> {
    let denoised = filtered(halves, Level::new(), stop);
    (!stop.load(Ordering::Relaxed)).then_some(denoised)
}

/// Filters a picture, on all threads of the current pool. The result does not depend on the processor or the number of
/// threads. It is incomplete if `stop` is set.
fn filtered(halves: Halves, level: Level, stop: &AtomicBool) -> Denoised {
    let Halves { pixels, counts, raw_mse, picture: mut film } = halves;
    let size = [film.width() as usize, film.height() as usize];
    let count = film.sample_count() as f64;
    // The weights of the halves in the picture. The variance of a half is inverse to its samples.
    let weights = counts.map(|of_half| (of_half as f64 / count) as f32);
    let inputs: [Half; 2] = from_fn(|i| Half { pixels: &pixels[i], share: 1.0 - weights[i] });
    let (unit, most) = (count * FIXED_POINT_SCALE, count * f64::from(FIXED_POINT_MAX));
    let mut squared_errors = vec![0.0; size[0] * size[1]];
    let picture = film.halves_mut()[0].as_mut_slice();
    let rows = HIGH * size[0];
    let bands = picture.par_chunks_mut(rows).zip(squared_errors.par_chunks_mut(rows)).enumerate();
    bands.for_each_init(bytemuck::zeroed_box::<Scratch>, |scratch, (band, (picture, errors))| {
        for first in (0..size[0]).step_by(WIDE).take_while(|_| !stop.load(Ordering::Relaxed)) {
            let place = Place { first: [first, band * HIGH], size };
            dispatch!(level, simd => simd.vectorize(#[inline(always)] || filter::filter(&inputs, place, scratch)));
            let lines = picture.chunks_mut(size[0]).zip(errors.chunks_mut(size[0])).enumerate();
            for (y, (picture, errors)) in lines {
                for column in 0..WIDE.min(size[0] - first) {
                    let x = first + column;
                    let [a, b] = from_fn(|half| pixels[half][band * rows + y * size[0] + x]);
                    let [fa, fb]: [[f32; 3]; 2] =
                        from_fn(|half| from_fn(|c| scratch.filtered[half][y][c][column]));
                    let mean = [0, 1, 2].map(|c| f64::from(weights[0] * fa[c] + weights[1] * fb[c]));
                    picture[x] = PixelSum(mean.map(|x| (x * unit).clamp(0.0, most) as u64));
                    let square = |c| squared_error(weights, [a[c], b[c]], [fa[c], fb[c]]);
                    errors[x] = (0..3).map(square).sum::<f32>() / 3.0;
                }
            }
        }
    });
    let even = squared_errors.iter().enumerate().filter(|(i, _)| !is_odd(i % size[0], i / size[0]));
    let even: Vec<f64> = even.map(|(_, error)| f64::from(*error)).collect();
    let mean = |of: fn(f64) -> f64| even.iter().map(|error| of(*error)).sum::<f64>() / even.len() as f64;
    let (mse, of_squares) = (mean(|error| error), mean(|error| error * error));
    let mse_deviation = ((of_squares - mse * mse).max(0.0) / (even.len() - 1) as f64).sqrt();
    let error = DenoisedError { mse, mse_deviation, raw_mse };
    Denoised { film, errors: local(size[0], &squared_errors), error }
}

#[cfg(test)]
mod tests;
