//! Sampling code that all tracers share. Each number is a pure function of (sampler, seed, pixel, sample index, bounce).
//! No state is carried along a path, so a sample does not depend on what was traced before it.

use crate::film::HALVES;
use crate::job::render::{RenderSettings, SamplerKind};

/// `2^32` over the golden ratio, rounded to an odd number: its multiples are far apart.
pub const GOLDEN_RATIO: u32 = 0x9E37_79B9;

/// Hashes four numbers: a bijection in which each output bit depends on every input bit.
///
/// Source: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.
pub fn pcg4d(v: [u32; 4]) -> [u32; 4] {
    let v = stir(v.map(|a| a.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)));
    stir(v.map(|a| a ^ (a >> 16)))
}

fn stir([x, y, z, w]: [u32; 4]) -> [u32; 4] {
    let x = x.wrapping_add(y.wrapping_mul(w));
    let y = y.wrapping_add(z.wrapping_mul(x));
    let z = z.wrapping_add(x.wrapping_mul(y));
    let w = w.wrapping_add(y.wrapping_mul(z));
    [x, y, z, w]
}

/// Hashes a number: a bijection.
///
/// Source: Wellons, "Prospecting for Hash Functions", 2018 (`lowbias32`).
pub fn mix32(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// What rearranges the points of a path's first rays, as a polynomial of the bounce (even, and 0 for the camera ray): see
/// `sobol_pair` of the tracers. These constants leave the least error of 2,000 random ones in the scenes three-spheres and
/// book.
pub const REARRANGEMENT: u32 = 0xDA7B_DF80;
pub const REARRANGEMENT_SQUARE: u32 = 0x7285_8868;

/// What rearranges the points in a pixel when the camera ray's pair is used for the lens. It must be no small multiple of
/// another rearrangement: bits of two numbers would be equal in all samples, and the picture wrong.
pub const PIXEL_REARRANGEMENT: u32 = 0x4046_02D0;

/// The last bounce whose points share a shuffle with those of the camera ray.
pub const LAST_TOGETHER: u32 = 2;

/// Coefficients of `sin(2 pi x) / x` in powers of `x^2`, for `|x| <= 1/4`. Minimax in relative error (Remez in
/// 40 digits): 5.3e-9, a tenth of what `f32` resolves.
pub const fn sine_coefficients() -> [f64; 5] {
    [
        6.283_185_273_790_823,
        -41.341_677_478_395_816,
        81.602_231_242_559_88,
        -76.574_992_171_787_98,
        39.710_918_036_888_18,
    ]
}

/// The part of a sampler's stream keys shared by all pixels. It separates the Sobol scramblings of halves and seeds.
#[derive(Clone, Copy, Debug)]
pub struct HalfKey(Option<u32>);

impl HalfKey {
    pub fn new(settings: &RenderSettings, half: u32) -> Self {
        HalfKey(match settings.sampler {
            SamplerKind::Independent => None,
            SamplerKind::Sobol => Some(mix32(settings.seed.wrapping_add(half.wrapping_mul(GOLDEN_RATIO)))),
        })
    }

    /// The number common to all pixels' keys; `None` for the sampler that hashes the pixel itself.
    #[inline(always)]
    pub fn bits(self) -> Option<u32> {
        self.0
    }
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
    pub fn split(range: std::ops::Range<u64>, count_limit: u32) -> Vec<SampleBlock> {
        let mut blocks = Vec::new();
        for half in 0..HALVES as u32 {
            let below = |end: u64| (end + HALVES - 1 - u64::from(half)) / HALVES;
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
        match settings.sampler {
            SamplerKind::Independent => (self.first * HALVES as u32 + self.half, HALVES as u32),
            SamplerKind::Sobol => (self.first.reverse_bits(), ((1_u64 << 32) / u64::from(self.count)) as u32),
        }
    }
}
