//! The film: the exact sums of all samples.
//!
//! A sample's radiance `x` becomes the integer `k = round(x 2^24)`, and a pixel is the 64-bit sum of its `k`. Integer
//! sums do not depend on order, so threads, lanes, backends, machines and resumed runs all produce the same bits.
//! Samples go to two halves in turn, and the difference of the halves gives an estimate of the error (see
//! [`Film::error`]). A film without an error estimate has one half.

pub mod checkpoint;
mod checksum;
mod description;
mod difference;
mod merge;
mod ranges;
mod shared_file;

pub use checkpoint::{CheckpointError, FilmFile};
pub use checksum::Checksum;
pub use description::{Description, RECIPE_KEY, key};
pub use merge::{MergeError, merge_files, same_recipe_text};
pub use ranges::SampleRanges;
pub use shared_file::{Saved, SharedFile};

use crate::memory::{self, MemoryError};
use crate::stages::Transfer;
use std::ops::Range;

/// One unit of the film's fixed point is `2^-24` of radiance.
pub const FIXED_POINT_SCALE: f64 = 16_777_216.0;

/// A sample's radiance is clamped to stay below this limit. It is the largest limit whose fixed-point values fit a
/// signed 32-bit integer, to which every processor converts in one instruction.
pub const RADIANCE_LIMIT: f64 = 128.0;

/// The largest `k`: that of the greatest `f32` below [`RADIANCE_LIMIT`].
pub const FIXED_POINT_MAX: u32 = 2_147_483_520;

/// Every sample index in a film is below this limit. A pixel's sum over all halves, and over any films that can be
/// merged, is therefore below `2^32 FIXED_POINT_MAX < 2^63` and cannot overflow.
pub const SAMPLE_LIMIT: u64 = 1 << 32;

const _: () = assert!((SAMPLE_LIMIT as u128) * (FIXED_POINT_MAX as u128) < 1 << 63);

/// Largest width and height of a picture, pixels: a pixel's position is packed into 32 bits.
pub const SIZE_LIMIT: u32 = 16_384;

/// Sums of one pixel in units of `2^-24`, RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelSum(pub [u64; 3]);

impl PixelSum {
    /// Adds another sum of other samples of the same pixel. It cannot overflow: see [`SAMPLE_LIMIT`].
    pub fn add(&mut self, other: PixelSum) {
        for (mine, theirs) in self.0.iter_mut().zip(other.0) {
            *mine += theirs;
        }
    }

    /// Sum in units of radiance. Exact up to 2^53 units, which is half a thousand million samples of radiance 1.
    pub fn radiance(self) -> [f64; 3] {
        self.0.map(|k| k as f64 / FIXED_POINT_SCALE)
    }
}

/// Converts one sample's radiance to fixed point. Returns `None` if a component is NaN, infinite or negative; such a
/// sample is counted but not added.
pub fn fixed_point(radiance: [f64; 3]) -> Option<PixelSum> {
    if radiance.iter().all(|x| x.is_finite() && *x >= 0.0) {
        let k = |x: f64| ((x * FIXED_POINT_SCALE).round_ties_even() as u64).min(u64::from(FIXED_POINT_MAX));
        Some(PixelSum(radiance.map(k)))
    } else {
        None
    }
}

/// An estimate of the picture's error from its two halves.
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

/// The error estimate is doubtful if it effectively rests on fewer pixels than this.
const PIXELS_IN_EFFECT_MIN: f64 = 100.0;

/// It is doubtful only if these are also less than this share of all pixels: small pictures have few pixels.
const DOMINANT_SHARE: f64 = 0.2;

impl ErrorEstimate {
    /// The effective number of pixels behind the estimate, `(sum e^2)^2 / sum e^4` with `e` the errors. It is small if
    /// a few pixels dominate, and infinite without any error.
    pub fn pixels_in_effect(&self) -> f64 {
        // For n pixels, the variance of the mean square is (mean e^4 - (mean e^2)^2) / n.
        let share = 2.0 * self.rmse_deviation / self.rmse;
        if share > 0.0 { 1.0 / (share * share) } else { f64::INFINITY }
    }

    /// The relative uncertainty of the estimate, one standard deviation, such as "± 0.2 %".
    pub fn uncertainty(&self) -> String {
        let share = if self.rmse > 0.0 { self.rmse_deviation / self.rmse } else { 0.0 };
        format!("± {:.1} %", (100.0 * share).max(0.1))
    }
}

/// Sums of samples for every pixel, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    halves: Vec<Vec<PixelSum>>,
    samples: SampleRanges,
    rejected: u64,
}

impl Film {
    /// An empty film of `width` by `height` pixels and `half_count` halves (1 or 2).
    /// It takes 24 bytes per pixel and half.
    pub fn new(width: u32, height: u32, half_count: usize) -> Self {
        debug_assert!(half_count == 1 || half_count == 2);
        let pixels = width as usize * height as usize;
        Film {
            width,
            height,
            halves: vec![vec![PixelSum::default(); pixels]; half_count],
            samples: SampleRanges::default(),
            rejected: 0,
        }
    }

    /// Like [`Film::new`], but returns an error if there is not enough memory.
    ///
    /// # Errors
    /// [`FilmError::Memory`], before any memory is allocated.
    pub fn try_new(width: u32, height: u32, half_count: usize) -> Result<Self, FilmError> {
        let what = || format!("a film of {width}x{height} pixels");
        memory::check(what, Film::bytes(width, height, half_count), SMALLER_FILM)?;
        let pixels = width as usize * height as usize;
        let half = |_| memory::filled(pixels, PixelSum::default(), what, SMALLER_FILM);
        let halves = (0..half_count).map(half).collect::<Result<_, _>>()?;
        Ok(Film { width, height, halves, samples: SampleRanges::default(), rejected: 0 })
    }

    /// Assembles a film from parts that were read from a file.
    ///
    /// # Errors
    /// [`FilmError::Parts`] if the parts do not make a valid film.
    pub fn from_parts(
        width: u32,
        height: u32,
        halves: Vec<Vec<PixelSum>>,
        samples: SampleRanges,
        rejected: u64,
    ) -> Result<Self, FilmError> {
        let film = Film { width, height, halves, samples, rejected };
        film.validate().map_err(|what| FilmError::Parts { what })?;
        Ok(film)
    }

    fn validate(&self) -> Result<(), String> {
        let pixels = self.width as usize * self.height as usize;
        if pixels == 0 {
            return Err(format!("a size of {}x{}", self.width, self.height));
        }
        if !(1..=2).contains(&self.halves.len()) {
            return Err(format!("{} halves", self.halves.len()));
        }
        if u128::from(self.rejected) > u128::from(self.sample_count()) * pixels as u128 {
            return Err(format!("{} samples rejected of {} a pixel", self.rejected, self.sample_count()));
        }
        for (index, half) in self.halves.iter().enumerate() {
            if half.len() != pixels {
                return Err(format!("{} sums for {pixels} pixels", half.len()));
            }
            let limit = u128::from(self.half_sample_count(index)) * u128::from(FIXED_POINT_MAX);
            if let Some(pixel) = half.iter().position(|sum| sum.0.iter().any(|k| u128::from(*k) > limit)) {
                return Err(format!("a sum of pixel {pixel} that its samples cannot reach"));
            }
        }
        Ok(())
    }

    /// Bytes that the sums of such a film need.
    pub fn bytes(width: u32, height: u32, half_count: usize) -> u64 {
        (u64::from(width) * u64::from(height)).saturating_mul((half_count * size_of::<PixelSum>()) as u64)
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The halves: sample `i` is in half `i mod half_count`. Each is row by row from the top.
    pub fn halves(&self) -> &[Vec<PixelSum>] {
        &self.halves
    }

    /// The samples that every pixel holds.
    pub fn samples(&self) -> &SampleRanges {
        &self.samples
    }

    /// The number of samples, over all pixels, that were left out because they were NaN, infinite or negative.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Samples per pixel.
    pub fn sample_count(&self) -> u64 {
        self.samples.count()
    }

    /// Samples per pixel of one half.
    pub fn half_sample_count(&self, half: usize) -> u64 {
        self.samples.count_in_half(half, self.halves.len())
    }

    /// The sums, for a renderer to add to. The renderer must then record what it added: [`Film::record`].
    pub fn halves_mut(&mut self) -> &mut [Vec<PixelSum>] {
        &mut self.halves
    }

    /// Records that every pixel now also holds the samples of `range`, of which `rejected` were left out.
    ///
    /// # Errors
    /// [`FilmError::Overlap`] if the film already had some of them, [`FilmError::Range`] if they reach beyond the
    /// limit. Nothing is recorded then.
    pub fn record(&mut self, range: Range<u64>, rejected: u64) -> Result<(), FilmError> {
        let rejected = self.with_rejected(rejected)?;
        self.samples.insert(range)?;
        self.rejected = rejected;
        Ok(())
    }

    fn with_rejected(&self, more: u64) -> Result<u64, FilmError> {
        let what = || format!("{} and {more} samples rejected, more than can be counted", self.rejected);
        self.rejected.checked_add(more).ok_or_else(|| FilmError::Parts { what: what() })
    }

    /// Sum of a pixel over the halves.
    pub fn pixel_sum(&self, index: usize) -> PixelSum {
        let mut sum = PixelSum::default();
        for half in &self.halves {
            sum.add(half[index]);
        }
        sum
    }

    /// Mean radiance of pixel `index` (row by row from the top), linear RGB; black without samples.
    pub fn mean(&self, index: usize) -> [f64; 3] {
        mean_of(self.pixel_sum(index), self.sample_count())
    }

    /// The whole picture, linear RGB, row by row from the top.
    pub fn means(&self) -> Vec<[f32; 3]> {
        let mut pixels = vec![[0.0; 3]; self.width as usize * self.height as usize];
        self.mean_rows(0..self.height, &mut pixels);
        pixels
    }

    /// Writes rows `rows` of the picture, linear RGB, to `pixels` (`width` pixels per row).
    ///
    /// # Panics
    /// If a row is below the picture, or `pixels` has another length.
    pub fn mean_rows(&self, rows: Range<u32>, pixels: &mut [[f32; 3]]) {
        let unit = self.fixed_point_of_1();
        self.for_each_sum(rows, pixels, |sum, pixel| *pixel = sum.0.map(|k| (k as f64 / unit) as f32));
    }

    /// The picture in 8 bits: `transfer`, then `floor(256 clamp(v, 0, .999))`; top row first.
    pub fn to_rgb8(&self, transfer: Transfer) -> Vec<u8> {
        let mut bytes = vec![0; self.width as usize * self.height as usize * 3];
        self.resolve_rows(0..self.height, transfer, &mut bytes);
        bytes
    }

    /// Writes rows `rows` of [`Film::to_rgb8`] to `bytes` (`3 width` bytes per row). Rows do not depend on each other,
    /// so several threads can share a picture.
    ///
    /// # Panics
    /// If a row is below the picture, or `bytes` has another length.
    pub fn resolve_rows(&self, rows: Range<u32>, transfer: Transfer, bytes: &mut [u8]) {
        let (unit, height) = (self.fixed_point_of_1(), self.height as usize);
        let (pixels, []) = bytes.as_chunks_mut::<3>() else { panic!("a pixel has 3 bytes") };
        assert_eq!(pixels.len(), self.width as usize * rows.len(), "3 bytes for each pixel of {rows:?}");
        // Chosen once per row, outside the loop over its pixels.
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
    fn fixed_point_of_1(&self) -> f64 {
        Film::fixed_point(self.sample_count())
    }

    /// The same for `samples` samples per pixel.
    fn fixed_point(samples: u64) -> f64 {
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

    /// The error estimated from the halves. With `A` and `B` the means of `a` and `b` samples,
    /// `MSE = mean((A - B)^2) a b / (a + b)^2`. This is a quarter of the squared difference when `a = b`, as after
    /// every even number of samples. `None` with one half, or while a half has no samples.
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
            let (mut squares, mut relative) = ([0.0; 3], [0.0; 3]);
            for channel in 0..3 {
                let (a, b) = (a.0[channel], b.0[channel]);
                let mean = (a + b) as f64 * scale;
                let difference = a as f64 * scale_a - b as f64 * scale_b;
                let square = difference * difference * weight;
                squares[channel] = square;
                relative[channel] = square / (mean * mean + 1e-2);
            }
            // The channels of a pixel share their noise.
            let of_pixel = squares.iter().sum::<f64>();
            square_sum += of_pixel;
            fourth_power_sum += of_pixel * of_pixel;
            relative_sum += relative.iter().sum::<f64>();
        }
        let pixels = half_a.len() as f64;
        let [square, fourth_power] = [square_sum / (3.0 * pixels), fourth_power_sum / (9.0 * pixels)];
        let deviation_of_square = ((fourth_power - square * square).max(0.0) / pixels).sqrt();
        let rmse = square.sqrt();
        Some(ErrorEstimate {
            rmse,
            rmse_deviation: if rmse > 0.0 { 0.5 * deviation_of_square / rmse } else { 0.0 },
            rel_mse: relative_sum / (3.0 * pixels),
        })
    }

    /// Why an estimate of this film's error is doubtful, in words: few pixels dominate it, or no path has found any
    /// light. The estimate and its deviation are then most likely too low.
    pub fn doubt(&self, estimate: &ErrorEstimate) -> Option<String> {
        if estimate.rmse == 0.0 && self.halves.iter().flatten().all(|sum| sum.0 == [0; 3]) {
            let count = self.sample_count();
            return Some(format!(
                "no path has found any light in {count} samples per pixel, so that the error cannot be estimated; only \
                 more samples tell whether there is some"
            ));
        }
        let (pixels, all) = (estimate.pixels_in_effect(), self.halves.first().map_or(0, Vec::len));
        (pixels < PIXELS_IN_EFFECT_MIN && pixels < DOMINANT_SHARE * all as f64).then(|| {
            format!(
                "few pixels dominate the error estimate: it is worth that of {pixels:.0} of {all} pixels, where \
                 {PIXELS_IN_EFFECT_MIN:.0} would do; it may be off by a factor, and only more samples tell"
            )
        })
    }

    /// Merges another film of the same size into this one.
    ///
    /// # Errors
    /// [`FilmError::Size`] or [`FilmError::Overlap`], or an error if there are more rejected samples than can be
    /// counted. This film is then unchanged.
    pub fn merge(&mut self, other: &Film) -> Result<(), FilmError> {
        let shape = |f: &Film| (f.width, f.height, f.halves.len());
        if shape(self) != shape(other) {
            return Err(FilmError::Size { mine: shape(self), theirs: shape(other) });
        }
        let samples = self.samples.union(&other.samples)?;
        self.rejected = self.with_rejected(other.rejected)?;
        self.samples = samples;
        for (mine, theirs) in self.halves.iter_mut().zip(&other.halves) {
            for (sum, more) in mine.iter_mut().zip(theirs) {
                sum.add(*more);
            }
        }
        Ok(())
    }
}

/// Advice for making a film that fits into memory.
const SMALLER_FILM: &str =
    "choose a smaller picture, or half the film with --estimate-error off, or close other programs";

fn mean_of(sum: PixelSum, count: u64) -> [f64; 3] {
    if count == 0 { [0.0; 3] } else { sum.radiance().map(|x| x / count as f64) }
}

/// Converts one channel of a pixel in `row` of `height` from linear radiance to 8 bits.
pub fn to_byte(linear: f64, transfer: Transfer, row: usize, height: usize) -> u8 {
    quantise(if transfer.is_gamma(row, height) { linear.max(0.0).sqrt() } else { linear })
}

fn quantise(value: f64) -> u8 {
    (256.0 * value.clamp(0.0, 0.999)) as u8
}

/// Why films cannot be merged, or why data is not a film.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum FilmError {
    /// The films differ in width, height or number of halves.
    #[error("the films differ in shape: {}x{} with {} halves and {}x{} with {}", mine.0, mine.1, mine.2, theirs.0, theirs.1, theirs.2)]
    Size {
        /// Width, height and number of halves of this film.
        mine: (u32, u32, usize),
        /// Width, height and number of halves of the other film.
        theirs: (u32, u32, usize),
    },
    /// The sample indices are outside the range that a film can hold.
    #[error(
        "samples {}..{} are no range of samples, which begins before it ends, at {SAMPLE_LIMIT} at most",
        range.start, range.end
    )]
    Range {
        /// The rejected indices.
        range: Range<u64>,
    },
    /// A sample would be counted twice.
    #[error("samples {}..{} are already in the film; each sample may be added once", range.start, range.end)]
    Overlap {
        /// The samples that are in both.
        range: Range<u64>,
    },
    /// There is not enough memory for the sums.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The parts do not fit together.
    #[error("this is no film: {what}")]
    Parts {
        /// What is wrong.
        what: String,
    },
}
