//! The source of a sample's numbers in plain scalar code: the oracle for all lane widths and the GPU.
//!
//! Each number is a pure function of (sampler, seed, pixel, sample index, bounce). No state is carried along a path, so
//! a sample does not depend on what was traced before it.

mod hash;
mod sobol;
mod warp;

pub use hash::{GOLDEN_RATIO, mix32, pcg4d};
pub use sobol::{LENS_BLOCK, laine_karras, pascal};
pub use warp::{sin_cos_turns, sine_coefficients, unit_disk, unit_sphere};

use crate::job::render::{RenderSettings, SamplerKind};

/// Four numbers for one ray of a path, in units of `2^-32`. The first two select a direction, a point in the pixel, or
/// a point on the lens if there is one. A dielectric uses the first to choose between reflection and refraction, since
/// it needs no direction. With a lens, the last two select the point in the pixel.
///
/// `pixel` is `x | y << 16`; `bounce` is 0 for the camera ray.
pub fn numbers(settings: &RenderSettings, pixel: u32, index: u32, bounce: u32) -> [u32; 4] {
    match settings.sampler {
        // The index is hashed without reversing it. The hash carries differences upwards and folds them down only once,
        // so samples whose numbers differ only in the highest bits, as reversed ones do, would not be independent.
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

/// The key that separates the Sobol scramblings of pixels, halves and seeds.
pub fn pixel_key(seed: u32, half: u32, pixel: u32) -> u32 {
    key_in_half(half_key(seed, half), pixel)
}

/// The part of [`pixel_key`] shared by all pixels.
fn half_key(seed: u32, half: u32) -> u32 {
    mix32(seed.wrapping_add(half.wrapping_mul(GOLDEN_RATIO)))
}

/// Completes [`pixel_key`] from the shared part.
fn key_in_half(half_key: u32, pixel: u32) -> u32 {
    mix32(half_key ^ pixel)
}

/// The part of a sampler's stream keys shared by all pixels.
#[derive(Clone, Copy, Debug)]
pub struct HalfKey(Option<u32>);

impl HalfKey {
    pub fn new(settings: &RenderSettings, half: u32) -> Self {
        match settings.sampler {
            SamplerKind::Independent => HalfKey(None),
            SamplerKind::Sobol => HalfKey(Some(half_key(settings.seed, half))),
        }
    }

    /// The number common to all pixels' keys; `None` for the sampler that hashes the pixel itself.
    #[inline(always)]
    pub fn bits(self) -> Option<u32> {
        self.0
    }

    /// The stream of a pixel's camera rays: [`pixel_key`] for the Sobol sampler, 0 for the sampler that hashes the
    /// pixel itself.
    #[inline(always)]
    pub fn of_pixel(self, pixel: u32) -> u32 {
        self.0.map_or(0, |half_key| key_in_half(half_key, pixel))
    }
}

/// The difference between the streams of a path's consecutive rays.
#[inline(always)]
pub fn stream_stride(sampler: SamplerKind) -> u32 {
    match sampler {
        SamplerKind::Independent => 1,
        SamplerKind::Sobol => GOLDEN_RATIO,
    }
}

/// Converts the upper 24 bits to a float in `[0, 1)`, so that the result is exact and never 1.
pub fn unit_float(u: u32) -> f32 {
    (u >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The `count` samples from `first` on in one half, where `count` is a power of two and `first` a multiple of it. A
/// kernel steps through them with one addition per sample; Sobol samples come in bit-reversed order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleBlock {
    /// Index of the half of the film.
    pub half: u32,
    /// Index of the first sample within the half.
    pub first: u32,
    /// A power of two.
    pub count: u32,
}

impl SampleBlock {
    /// Splits a range of samples into blocks of at most `count_limit` (a power of two).
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

    /// The sampler's counter for the first sample, and its increment per sample. The counter is the index for
    /// independent samples and the reversed index within the half for Sobol samples.
    pub fn counter(&self, settings: &RenderSettings) -> (u32, u32) {
        let half_count = settings.half_count() as u32;
        match settings.sampler {
            SamplerKind::Independent => (self.first * half_count + self.half, half_count),
            SamplerKind::Sobol => (self.first.reverse_bits(), ((1_u64 << 32) / u64::from(self.count)) as u32),
        }
    }
}
