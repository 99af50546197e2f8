//! The numbers of a sample, lane by lane.
//!
//! [`laine_karras`] and [`pascal`] work on reversed bits, where Owen scrambling is an integer hash and the first Sobol
//! dimension is the index itself. Scrambling the reversed index shuffles the sequence within each aligned power-of-two
//! block and moves the block as a whole. The pair `(u, pascal(u))` is then a point of a moved Sobol net. Every aligned
//! block of samples is such a net. The first rays of a path share a shuffle, so that they are evenly distributed together;
//! blocks of later bounces and of different pixels are independent.
//!
//! Twin: shaders/rng.wgsl

use super::lanes::{Lanes, Unsigned};
use crate::job::render::{RenderSettings, SamplerKind};
use crate::kernel::sampling::{
    HalfKey, LAST_TOGETHER, PIXEL_REARRANGEMENT, REARRANGEMENT, REARRANGEMENT_SQUARE,
};

/// Hashes 32 bits to 32 bits; a bijection: [`crate::kernel::sampling::mix32`].
#[inline(always)]
pub fn mix32<L: Lanes>(l: L, x: L::U) -> L::U {
    let x = (x ^ (x >> 16)) * l.splat_u(0x7FEB_352D);
    let x = (x ^ (x >> 15)) * l.splat_u(0x846C_A68B);
    x ^ (x >> 16)
}

/// Hashes four numbers to four numbers: [`crate::kernel::sampling::pcg4d`].
#[inline(always)]
pub fn pcg4d<L: Lanes>(l: L, v: [L::U; 4]) -> [L::U; 4] {
    let (a, c) = (l.splat_u(1_664_525), l.splat_u(1_013_904_223));
    let v = stir::<L>([v[0] * a + c, v[1] * a + c, v[2] * a + c, v[3] * a + c]);
    stir::<L>([v[0] ^ (v[0] >> 16), v[1] ^ (v[1] >> 16), v[2] ^ (v[2] >> 16), v[3] ^ (v[3] >> 16)])
}

#[inline(always)]
fn stir<L: Lanes>([x, y, z, w]: [L::U; 4]) -> [L::U; 4] {
    let x = x + y * w;
    let y = y + z * x;
    let z = z + x * y;
    [x, y, z, w + y * z]
}

/// Owen's nested uniform scrambling, on reversed bits: each bit is flipped or kept depending on a hash of the bits below
/// it.
///
/// Source: Laine and Karras, "Stratified Sampling for Stochastic Transparency", EGSR 2011; constants from Vegdahl,
/// "Building a Better LK Hash", 2021.
#[inline(always)]
pub fn laine_karras<L: Lanes>(l: L, x: L::U, seed: L::U) -> L::U {
    let x = x ^ (x * l.splat_u(0x3D20_ADEA));
    let x = x + seed;
    let x = x * ((seed >> 16) | l.splat_u(1));
    let x = x ^ (x * l.splat_u(0x0552_6C56));
    x ^ (x * l.splat_u(0x53A2_2864))
}

/// Computes the second Sobol coordinate from the first. It is the product with Pascal's triangle modulo 2, which is a
/// Kronecker power and therefore takes five steps.
#[inline(always)]
pub fn pascal<L: Lanes>(l: L, u: L::U) -> L::U {
    let u = u ^ (u << 16);
    let u = u ^ ((u & l.splat_u(0x00FF_00FF)) << 8);
    let u = u ^ ((u & l.splat_u(0x0F0F_0F0F)) << 4);
    let u = u ^ ((u & l.splat_u(0x3333_3333)) << 2);
    u ^ ((u & l.splat_u(0x5555_5555)) << 1)
}

/// A pair of Sobol coordinates from a shuffled index. Each even `rearrangement` gives another order of the same net, in
/// which each bit is flipped or kept depending on the bits below it. Pairs with different ones form a point of more
/// dimensions.
#[inline(always)]
pub fn sobol_pair<L: Lanes>(l: L, index: L::U, rearrangement: L::U) -> [L::U; 2] {
    let u = index ^ (index * rearrangement);
    [u, pascal(l, u)]
}

/// The key that separates a pixel's scramblings: 0 for the sampler that hashes the pixel itself.
#[inline(always)]
pub fn sampler_key<L: Lanes>(l: L, half_key: HalfKey, pixel: L::U) -> L::U {
    match half_key.bits() {
        Some(half_key) => mix32(l, pixel ^ l.splat_u(half_key)),
        None => l.splat_u(0),
    }
}

/// Two pairs of numbers for a path's next ray; the second pair, which matters only `with_lens`, is the point in the pixel
/// of a camera ray. `counter` selects the sample, `key` the pixel and half, and `stream`, which is `key` plus the number of
/// bounces so far, the ray too.
#[inline(always)]
pub fn numbers<L: Lanes>(
    l: L,
    settings: &RenderSettings,
    pixel: L::U,
    counter: L::U,
    key: L::U,
    stream: L::U,
    with_lens: bool,
) -> [[L::U; 2]; 2] {
    match settings.sampler {
        SamplerKind::Independent => {
            let [a, b, c, d] = pcg4d(l, [pixel, counter, stream, l.splat_u(settings.seed)]);
            [[a, b], [c, d]]
        }
        SamplerKind::Sobol => {
            let bounce = stream - key;
            let shared = stream - bounce.min(l.splat_u(LAST_TOGETHER));
            let index = laine_karras(l, counter, mix32(l, shared));
            let factor = bounce * l.splat_u(REARRANGEMENT_SQUARE) + l.splat_u(REARRANGEMENT);
            let first = sobol_pair(l, index, bounce * factor);
            let second = if with_lens { sobol_pair(l, index, l.splat_u(PIXEL_REARRANGEMENT)) } else { first };
            [first, second]
        }
    }
}
