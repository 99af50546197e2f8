//! The path loop at every level and lane count, and the choice among the variants.
//!
//! Each variant costs compile time, so there are few: the loop is specialised for what scenes commonly need, with one lane
//! and at old levels less so, and the reference has only the general variant. All variants render the same bits; tests
//! check this.

use super::Isa;
use super::broadcast::BroadcastScene;
#[cfg(not(target_arch = "wasm32"))]
use super::lanes::Lanes8;
#[cfg(target_arch = "x86_64")]
use super::lanes::Lanes16;
use super::lanes::{Lanes, Lanes4, Reference, Scalar};
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
    let variants: &[u32] = match isa {
        Isa::Avx2 | Isa::Avx512 | Isa::Neon if lanes > 1 => &[OPAQUE, GLASS, FINISHED],
        _ => &[GLASS],
    };
    variants.iter().copied().find(|variant| parts::include(*variant, needed)).unwrap_or(GENERAL)
}

/// Returns a kernel of a level and lane count that has at least the parts `needed`, or `None` if the processor lacks
/// the level or the level does not support the lane count.
pub fn kernel(isa: Isa, lanes: usize, needed: u32) -> Option<Kernel<f32>> {
    let level = Level::new();
    let offered = offered(isa, lanes, needed);
    Some(match (isa, lanes) {
        // With one lane, code for SSE4.2 would be 4 % faster.
        (Isa::Portable | Isa::Sse42 | Isa::Simd128, 1) if offered == GLASS => {
            Box::new(|broadcast, work| trace::<_, GLASS>(Scalar::<false>, broadcast, work))
        }
        (Isa::Portable | Isa::Sse42 | Isa::Simd128, 1) => {
            Box::new(|broadcast, work| trace::<_, GENERAL>(Scalar::<false>, broadcast, work))
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Sse42, 4) => {
            let simd = level.as_sse4_2()?;
            with_glass(simd, Lanes4(simd), offered)
        }
        #[cfg(target_arch = "wasm32")]
        (Isa::Simd128, 4) => {
            let simd = level.as_wasm_simd128()?;
            with_glass(simd, Lanes4(simd), offered)
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx2 | Isa::Avx512, 1) => with_glass(level.as_avx2()?, Scalar::<true>, offered),
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx2, 8) => {
            let simd = level.as_avx2()?;
            specialised(simd, Lanes8(simd), offered)
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx512, 16) => {
            let simd = level.as_avx512()?;
            specialised(simd, Lanes16(simd), offered)
        }
        #[cfg(target_arch = "aarch64")]
        (Isa::Neon, _) => {
            let simd = level.as_neon()?;
            match lanes {
                1 => with_glass(simd, Scalar::<true>, offered),
                4 => specialised(simd, Lanes4(simd), offered),
                8 => specialised(simd, Lanes8(simd), offered),
                _ => return None,
            }
        }
        _ => return None,
    })
}

/// Returns the reference's kernel.
pub fn reference_kernel() -> Kernel<f64> {
    Box::new(|broadcast, work| trace::<_, GENERAL>(Reference, broadcast, work))
}

/// The general variant and the one with glass.
fn with_glass<S: Simd, L: Lanes<Real = f32>>(simd: S, lanes: L, offered: u32) -> Kernel<f32> {
    match offered {
        GLASS => compiled::<_, _, GLASS>(simd, lanes),
        _ => compiled::<_, _, GENERAL>(simd, lanes),
    }
}

/// All variants.
#[cfg(not(target_arch = "wasm32"))]
fn specialised<S: Simd, L: Lanes<Real = f32>>(simd: S, lanes: L, offered: u32) -> Kernel<f32> {
    match offered {
        OPAQUE => compiled::<_, _, OPAQUE>(simd, lanes),
        FINISHED => compiled::<_, _, FINISHED>(simd, lanes),
        _ => with_glass(simd, lanes, offered),
    }
}

/// The path loop, compiled for the instructions of `simd`.
fn compiled<S: Simd, L: Lanes<Real = f32>, const PARTS: u32>(simd: S, lanes: L) -> Kernel<f32> {
    Box::new(move |broadcast, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, PARTS>(lanes, broadcast, work),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_sufficient_kernel_is_offered() {
        let needs = [OPAQUE, GLASS, parts::LENS, FINISHED, parts::RULES];
        for (isa, lanes, expected) in [
            (Isa::Portable, 1, [GLASS, GLASS, GENERAL, GENERAL, GENERAL]),
            (Isa::Sse42, 4, [GLASS, GLASS, GENERAL, GENERAL, GENERAL]),
            (Isa::Neon, 8, [OPAQUE, GLASS, FINISHED, FINISHED, GENERAL]),
            (Isa::Avx512, 1, [GLASS, GLASS, GENERAL, GENERAL, GENERAL]),
            (Isa::Avx512, 16, [OPAQUE, GLASS, FINISHED, FINISHED, GENERAL]),
        ] {
            assert_eq!(needs.map(|needed| offered(isa, lanes, needed)), expected, "{isa}, {lanes} lanes");
        }
    }
}
