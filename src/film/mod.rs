//! The film: the exact sums of all samples.
//!
//! A sample's radiance `x` becomes the integer `k = round(x 2^24)`, and a pixel is the 64-bit sum of its `k`. Integer
//! sums do not depend on order, so threads, lanes, backends, machines and resumed runs all produce the same bits.
//! Samples go to two halves in turn, and the difference of the halves gives an estimate of the error (see
//! [`Film::error`]).

pub mod checkpoint;
mod checksum;
mod description;
mod error_estimate;
mod fixed_point;
mod locked;
mod merge;
mod ranges;
mod resolve;
mod smooth;

pub use checkpoint::{CheckpointError, FilmFile, FilmHead};
pub use checksum::Checksum;
pub use description::{Description, RECIPE_KEY, SOFTWARE, key};
pub use error_estimate::ErrorEstimate;
pub use fixed_point::{
    FIXED_POINT_MAX, FIXED_POINT_SCALE, PixelSum, RADIANCE_LIMIT, ROUNDING_LIMIT, fixed_point,
};
pub use locked::LockedFilm;
pub use merge::FilmSum;
pub use ranges::SampleRanges;
pub use resolve::to_byte;

use crate::system::memory::{self, MemoryError};
use std::ops::Range;

/// Every sample index in a film is below this limit. A pixel's sum over all halves, and over any films that can be
/// merged, is therefore below `2^32 FIXED_POINT_MAX < 2^63` and cannot overflow.
pub const SAMPLE_LIMIT: u64 = 1 << 32;

const _: () = assert!((SAMPLE_LIMIT as u128) * (FIXED_POINT_MAX as u128) < 1 << 63);

/// Largest width and height of a picture, pixels: a pixel's position is packed into 32 bits.
pub const SIZE_LIMIT: u32 = 16_384;

/// Sample `i` belongs to half `i mod HALVES` of a film.
pub const HALVES: u64 = 2;

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
    /// An empty film of `width` by `height` pixels, which takes 48 bytes per pixel.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = width as usize * height as usize;
        let halves = vec![vec![PixelSum::default(); pixels]; HALVES as usize];
        Film { width, height, halves, samples: SampleRanges::default(), rejected: 0 }
    }

    /// Like [`Film::new`], but returns an error if there is not enough memory.
    ///
    /// # Errors
    /// [`FilmError::Memory`], before any memory is allocated.
    pub fn try_new(width: u32, height: u32) -> Result<Self, FilmError> {
        Film::zeroed(width, height, HALVES)
    }

    fn zeroed(width: u32, height: u32, half_count: u64) -> Result<Self, FilmError> {
        let what = || format!("a film of {width}x{height} pixels");
        memory::check(what, Film::bytes(width, height) / HALVES * half_count, SMALLER_FILM)?;
        let pixels = width as usize * height as usize;
        let half = |_| memory::zeroed::<PixelSum>(pixels, what, SMALLER_FILM);
        let halves = (0..half_count).map(half).collect::<Result<_, _>>()?;
        Ok(Film { width, height, halves, samples: SampleRanges::default(), rejected: 0 })
    }

    /// A copy, or an error if there is not enough memory.
    ///
    /// # Errors
    /// [`FilmError::Memory`], before any memory is allocated.
    pub fn try_copy(&self) -> Result<Self, FilmError> {
        let mut copy = Film::try_new(self.width, self.height)?;
        for (sums, own) in copy.halves.iter_mut().zip(&self.halves) {
            sums.copy_from_slice(own);
        }
        (copy.samples, copy.rejected) = (self.samples.clone(), self.rejected);
        Ok(copy)
    }

    /// A black film with only one half that counts the same samples, for a picture made from this film, whose error
    /// the halves do not tell.
    ///
    /// # Errors
    /// [`FilmError::Memory`], before any memory is allocated.
    pub fn try_blank(&self) -> Result<Self, FilmError> {
        let blank = Film::zeroed(self.width, self.height, 1)?;
        Ok(Film { samples: self.samples.clone(), ..blank })
    }

    /// The film with the samples whose sums it has, which were read from a file.
    ///
    /// # Errors
    /// [`FilmError::Parts`] if such samples cannot give these sums.
    pub fn with_samples(self, samples: SampleRanges, rejected: u64) -> Result<Self, FilmError> {
        let film = Film { samples, rejected, ..self };
        let pixels = film.width as usize * film.height as usize;
        let invalid = |what: String| Err(FilmError::Parts { what });
        if u128::from(rejected) > u128::from(film.sample_count()) * pixels as u128 {
            let count = film.sample_count();
            return invalid(format!(
                "{rejected} samples rejected, more than all pixels have with {count} each"
            ));
        }
        for (index, half) in film.halves.iter().enumerate() {
            // It is below 2^63, see SAMPLE_LIMIT.
            let limit = film.half_sample_count(index) * u64::from(FIXED_POINT_MAX);
            if let Some(pixel) = half.iter().position(|sum| sum.0.iter().any(|k| *k > limit)) {
                return invalid(format!("the sum of pixel {pixel} is larger than its samples can give"));
            }
        }
        Ok(film)
    }

    /// Bytes that the sums of such a film need.
    pub fn bytes(width: u32, height: u32) -> u64 {
        (u64::from(width) * u64::from(height)).saturating_mul(HALVES * size_of::<PixelSum>() as u64)
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// The halves, each row by row from the top.
    pub fn halves(&self) -> &[Vec<PixelSum>] {
        &self.halves
    }

    /// The samples that every pixel holds.
    pub fn samples(&self) -> &SampleRanges {
        &self.samples
    }

    /// Samples, over all pixels, that were left out because they were NaN, infinite or negative.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    pub fn sample_count(&self) -> u64 {
        self.samples.count()
    }

    /// Samples per pixel of one half.
    pub fn half_sample_count(&self, half: usize) -> u64 {
        self.samples.count_in_half(half)
    }

    /// The sums, for a renderer to add to. The renderer must then record what it added: [`Film::record`].
    pub fn halves_mut(&mut self) -> &mut [Vec<PixelSum>] {
        &mut self.halves
    }

    /// Records that every pixel now also holds the samples of `range`, except for `rejected` ones that were left out.
    ///
    /// # Errors
    /// [`FilmError::Overlap`] if the film already had some of them, [`FilmError::Range`] if they reach beyond the
    /// limit. Nothing is recorded then.
    pub fn record(&mut self, range: Range<u64>, rejected: u64) -> Result<(), FilmError> {
        self.samples.insert(range)?;
        self.rejected = self.rejected.saturating_add(rejected);
        Ok(())
    }

    /// Sum of a pixel over the halves.
    pub fn pixel_sum(&self, index: usize) -> PixelSum {
        let mut sum = PixelSum::default();
        for half in &self.halves {
            sum.add(half[index]);
        }
        sum
    }

    /// Merges another film of the same size into this one.
    ///
    /// # Errors
    /// [`FilmError::Size`] or [`FilmError::Overlap`]. This film is then unchanged.
    pub fn merge(&mut self, other: &Film) -> Result<(), FilmError> {
        let size = |film: &Film| (film.width, film.height);
        if size(self) != size(other) {
            return Err(FilmError::Size { mine: size(self), theirs: size(other) });
        }
        self.samples = self.samples.union(&other.samples)?;
        self.rejected = self.rejected.saturating_add(other.rejected);
        for (mine, theirs) in self.halves.iter_mut().zip(&other.halves) {
            for (sum, more) in mine.iter_mut().zip(theirs) {
                sum.add(*more);
            }
        }
        Ok(())
    }
}

/// Remedy for a film that does not fit into memory.
const SMALLER_FILM: &str = "choose a smaller picture or close other programs";

/// Why films cannot be merged, or why data is not a film.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum FilmError {
    /// Width and height of the two films.
    #[error("the films differ in size: {}x{} and {}x{}", mine.0, mine.1, theirs.0, theirs.1)]
    Size { mine: (u32, u32), theirs: (u32, u32) },
    #[error(
        "{}..{} is not a range of samples: the start must be below the end, and the end at most {SAMPLE_LIMIT}",
        range.start, range.end
    )]
    Range { range: Range<u64> },
    #[error("samples {}..{} are already in the film; each sample may be added only once", range.start, range.end)]
    Overlap { range: Range<u64> },
    #[error(transparent)]
    Memory(#[from] MemoryError),
    #[error("this is not a valid film: {what}")]
    Parts { what: String },
}
