//! Where the numbers of a sample come from, in plain scalar code: the oracle that every lane width and the GPU
//! are held against.
//!
//! Each number is a pure function of (sampler, seed, pixel, sample index, bounce). No state walks along a path,
//! so a sample does not depend on what was traced before it.

mod hash;
mod sobol;
mod warp;

pub use hash::{GOLDEN_RATIO, mix32, pcg4d};
pub use sobol::{LENS_BLOCK, laine_karras, pascal};
pub use warp::{sin_cos_turns, sine_coefficients, unit_disk, unit_sphere};

use crate::render::{RenderSettings, SamplerKind};

/// Four numbers for one ray of a path, in units of `2^-32`. The first two choose a direction or a point in the
/// pixel (on the lens, if there is one); a dielectric tosses its coin with the first, since it needs no
/// direction. The last two are the point in the pixel when there is a lens.
///
/// `pixel` is `x | y << 16`, `bounce` 0 for the ray from the camera.
pub fn numbers(settings: &RenderSettings, pixel: u32, index: u32, bounce: u32) -> [u32; 4] {
    match settings.sampler {
        // The index as it is. The hash carries differences upwards and folds them down once: samples whose numbers
        // differ in the uppermost bits alone, as reversed ones do, would not be independent.
        SamplerKind::Independent => pcg4d([pixel, index, bounce, settings.seed]),
        SamplerKind::Sobol => {
            let half_count = settings.half_count() as u32;
            let key = pixel_key(settings.seed, index % half_count, pixel);
            let reversed = (index / half_count).reverse_bits();
            let pair = |block: u32| {
                let u = laine_karras(reversed, mix32(key.wrapping_add(block.wrapping_mul(GOLDEN_RATIO))));
                [u, pascal(u)]
            };
            let ([a, b], [c, d]) = (pair(bounce), pair(bounce.wrapping_add(LENS_BLOCK)));
            [a, b, c, d]
        }
    }
}

/// What tells the Sobol scramblings of pixels, halves and seeds apart.
pub fn pixel_key(seed: u32, half: u32, pixel: u32) -> u32 {
    key_in_half(half_key(seed, half), pixel)
}

/// The part of [`pixel_key`] that pixels share.
fn half_key(seed: u32, half: u32) -> u32 {
    mix32(seed.wrapping_add(half.wrapping_mul(GOLDEN_RATIO)))
}

/// [`pixel_key`] from that part.
fn key_in_half(half_key: u32, pixel: u32) -> u32 {
    mix32(half_key ^ pixel)
}

/// The part that pixels share of what tells a sampler's streams of numbers apart.
#[derive(Clone, Copy, Debug)]
pub struct HalfKey(Option<u32>);

impl HalfKey {
    /// Of a half of the film.
    pub fn new(settings: &RenderSettings, half: u32) -> Self {
        match settings.sampler {
            SamplerKind::Independent => HalfKey(None),
            SamplerKind::Sobol => HalfKey(Some(half_key(settings.seed, half))),
        }
    }

    /// The stream of numbers for the camera's rays of a pixel: [`pixel_key`] for Sobol's, 0 where the pixel itself is
    /// hashed.
    #[inline(always)]
    pub fn of_pixel(self, pixel: u32) -> u32 {
        self.0.map_or(0, |half_key| key_in_half(half_key, pixel))
    }
}

/// By how much a path's stream of numbers grows from ray to ray.
#[inline(always)]
pub fn stream_stride(sampler: SamplerKind) -> u32 {
    match sampler {
        SamplerKind::Independent => 1,
        SamplerKind::Sobol => GOLDEN_RATIO,
    }
}

/// The float in `[0, 1)` of a 32-bit number: its upper 24 bits, so that it is exact and never 1.
pub fn unit_float(u: u32) -> f32 {
    (u >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// `count` samples `first ..` of one half, `first` a multiple of `count`, a power of two. A kernel walks through
/// them, those of Sobol's in bit-reversed order, at the cost of one addition a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleBlock {
    /// Half of the film.
    pub half: u32,
    /// First index within the half.
    pub first: u32,
    /// Number of samples, a power of two.
    pub count: u32,
}

impl SampleBlock {
    /// Splits samples `range` into blocks of at most `count_limit` (a power of two) samples.
    pub fn split(range: std::ops::Range<u64>, half_count: u32, count_limit: u32) -> Vec<SampleBlock> {
        let mut blocks = Vec::new();
        for half in 0..half_count {
            let below =
                |end: u64| (end + u64::from(half_count) - 1 - u64::from(half)) / u64::from(half_count);
            let (mut first, end) = (below(range.start), below(range.end));
            while first < end {
                let aligned = if first == 0 { u64::MAX } else { 1 << first.trailing_zeros() };
                let fitting = 1 << (end - first).ilog2();
                let count = aligned.min(fitting).min(u64::from(count_limit));
                blocks.push(SampleBlock { half, first: first as u32, count: count as u32 });
                first += count;
            }
        }
        blocks
    }

    /// The sampler's counter of the first sample, and what to add to it for each next: for independent samples the
    /// index, for Sobol's the reversed index within the half.
    pub fn counter(&self, settings: &RenderSettings) -> (u32, u32) {
        let half_count = settings.half_count() as u32;
        match settings.sampler {
            SamplerKind::Independent => (self.first * half_count + self.half, half_count),
            SamplerKind::Sobol => (self.first.reverse_bits(), ((1_u64 << 32) / u64::from(self.count)) as u32),
        }
    }
}
