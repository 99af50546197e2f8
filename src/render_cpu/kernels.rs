//! The path loop at every level and lane count, and the choice among the variants.
//!
//! Each variant costs compile time, so there are few. At a level's native lane count (at both of NEON) and with one lane,
//! the loop is specialised for what scenes commonly need. Other lane counts and the reference have only the general variant. All
//! variants render the same bits; tests check this.

use super::Isa;
use super::broadcast::BroadcastScene;
use super::lanes::{Instructions, Lanes4, Lanes8, Lanes16, Reference, Scalar};
use super::path::trace;
use super::work::{TileStats, Work};
use crate::kernel::parts;
use fearless_simd::{Level, Simd};

/// A function that traces one tile.
pub type Kernel<R> = Box<dyn Fn(&BroadcastScene<R>, &mut Work) -> TileStats + Send + Sync>;

/// Opaque spheres and a pinhole camera.
const OPAQUE: u32 = parts::NONE;
/// The same with glass, for the three spheres.
const GLASS: u32 = parts::GLASS;
/// Everything that finished pictures need, such as the book's final render.
const FINISHED: u32 = parts::GLASS | parts::LENS | parts::EXTREMES | parts::HIERARCHY;
/// Every part.
const GENERAL: u32 = parts::ALL;

/// Returns the parts of the smallest kernel that has those `needed`.
pub fn offered(isa: Isa, lanes: usize, needed: u32) -> u32 {
    let variants: &[u32] = match (isa, lanes == isa.native_lanes()) {
        _ if lanes == 1 => &[GLASS],
        (Isa::Sse42, true) => &[GLASS],
        // Which of NEON's counts is faster depends on the processor.
        (Isa::Avx2 | Isa::Avx512, true) | (Isa::Neon, _) => &[OPAQUE, GLASS, FINISHED],
        _ => &[],
    };
    variants.iter().copied().find(|variant| within(needed, *variant)).unwrap_or(GENERAL)
}

/// Returns a kernel of a level and lane count that has at least the parts `needed`, or `None` if the processor lacks
/// the level or the level does not support the lane count.
pub fn kernel(isa: Isa, lanes: usize, needed: u32) -> Option<Kernel<f32>> {
    let level = Level::new();
    let offered = offered(isa, lanes, needed);
    match (isa, lanes) {
        (Isa::Portable, 1) if offered == GLASS => {
            Some(Box::new(|prepared, work| trace::<_, GLASS>(Scalar::<false>, prepared, work)))
        }
        (Isa::Portable, 1) => {
            Some(Box::new(|prepared, work| trace::<_, GENERAL>(Scalar::<false>, prepared, work)))
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Sse42, _) => {
            let simd = level.as_sse4_2()?;
            match lanes {
                1 if offered == GLASS => Some(scalar::<_, false, GLASS>(simd)),
                1 => Some(scalar::<_, false, GENERAL>(simd)),
                4 if offered == GLASS => Some(four::<_, GLASS>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx2, _) | (Isa::Avx512, 1 | 4 | 8) => {
            let simd = level.as_avx2()?;
            match lanes {
                1 if offered == GLASS => Some(scalar::<_, true, GLASS>(simd)),
                1 => Some(scalar::<_, true, GENERAL>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 if offered == OPAQUE => Some(eight::<_, OPAQUE>(simd)),
                8 if offered == GLASS => Some(eight::<_, GLASS>(simd)),
                8 if offered == FINISHED => Some(eight::<_, FINISHED>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                16 => Some(sixteen::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx512, 16) => {
            let simd = level.as_avx512()?;
            Some(match offered {
                OPAQUE => sixteen::<_, OPAQUE>(simd),
                GLASS => sixteen::<_, GLASS>(simd),
                FINISHED => sixteen::<_, FINISHED>(simd),
                _ => sixteen::<_, GENERAL>(simd),
            })
        }
        #[cfg(target_arch = "aarch64")]
        (Isa::Neon, _) => {
            let simd = level.as_neon()?;
            match lanes {
                1 if offered == GLASS => Some(scalar::<_, true, GLASS>(simd)),
                1 => Some(scalar::<_, true, GENERAL>(simd)),
                4 if offered == OPAQUE => Some(four::<_, OPAQUE>(simd)),
                4 if offered == GLASS => Some(four::<_, GLASS>(simd)),
                4 if offered == FINISHED => Some(four::<_, FINISHED>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 if offered == OPAQUE => Some(eight::<_, OPAQUE>(simd)),
                8 if offered == GLASS => Some(eight::<_, GLASS>(simd)),
                8 if offered == FINISHED => Some(eight::<_, FINISHED>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Returns the reference's kernel.
pub fn reference_kernel() -> Kernel<f64> {
    Box::new(|prepared, work| trace::<_, GENERAL>(Reference, prepared, work))
}

fn within(needed: u32, offered: u32) -> bool {
    needed & !offered == 0
}

fn scalar<S: Simd, const FUSED: bool, const PARTS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |prepared, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, PARTS>(Scalar::<FUSED>, prepared, work),
        )
    })
}

fn four<S: Instructions, const PARTS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |prepared, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, PARTS>(Lanes4(simd), prepared, work),
        )
    })
}

fn eight<S: Instructions, const PARTS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |prepared, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, PARTS>(Lanes8(simd), prepared, work),
        )
    })
}

#[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "only x86-64 has 16 lanes"))]
fn sixteen<S: Instructions, const PARTS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |prepared, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, PARTS>(Lanes16(simd), prepared, work),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_kernel_that_suffices_is_offered() {
        let needs = [OPAQUE, GLASS, parts::LENS, FINISHED, parts::RULES];
        for (isa, lanes, expected) in [
            (Isa::Portable, 1, [GLASS, GLASS, GENERAL, GENERAL, GENERAL]),
            (Isa::Sse42, 4, [GLASS, GLASS, GENERAL, GENERAL, GENERAL]),
            (Isa::Sse42, 8, [GENERAL; 5]),
            (Isa::Neon, 8, [OPAQUE, GLASS, FINISHED, FINISHED, GENERAL]),
            (Isa::Avx512, 8, [GENERAL; 5]),
            (Isa::Avx512, 16, [OPAQUE, GLASS, FINISHED, FINISHED, GENERAL]),
        ] {
            assert_eq!(needs.map(|needed| offered(isa, lanes, needed)), expected, "{isa}, {lanes} lanes");
        }
        assert!(within(GLASS, FINISHED) && within(OPAQUE, OPAQUE) && !within(FINISHED, GLASS));
    }
}
