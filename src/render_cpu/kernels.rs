//! The path loop at every level and lane count, and the choice among them.
//!
//! Each instance costs compile time, so there are few: at a level's own lane count the loop is specialised for
//! what scenes commonly need, at the other lane counts and for the reference there is the general one. All of
//! them render the same bits, which tests hold them to.

use super::Isa;
use super::lanes::{Lanes4, Lanes8, Lanes16, Permute, Reference, Scalar};
use super::path::{needs, trace};
use super::record::{PathRecord, record};
use super::work::{TileStats, Work};
use crate::render::Features;
use crate::tables::Tables;
use fearless_simd::{Level, Simd};

/// Traces a tile.
pub type Kernel<R> = Box<dyn Fn(&Tables<R>, &mut Work) -> TileStats + Send + Sync>;

/// Opaque spheres and a pinhole.
const OPAQUE: u32 = 0;
/// Glass besides: the three spheres.
const GLASS: u32 = needs::GLASS;
/// All that finished pictures need: the book's last.
const FINISHED: u32 = needs::GLASS | needs::LENS | needs::ANCHORED | needs::HIERARCHY;
/// Everything.
const GENERAL: u32 = needs::ALL;

/// The code that a job needs of a kernel.
pub fn needs_of<R>(features: &Features, tables: &Tables<R>) -> u32 {
    let bit = |needed: bool, bit: u32| if needed { bit } else { 0 };
    bit(!tables.two_root.is_empty() || features.dielectric, needs::GLASS)
        | bit(features.lens, needs::LENS)
        | bit(!tables.anchored.is_empty(), needs::ANCHORED)
        | bit(tables.hierarchy.is_some(), needs::HIERARCHY)
        | bit(features.stage_rules, needs::RULES)
}

/// A kernel of a level and lane count that has at least the code `needed`.
/// `None` if the processor lacks the level or the level has no such lane count.
pub fn kernel(isa: Isa, lanes: usize, needed: u32) -> Option<Kernel<f32>> {
    let level = Level::new();
    match (isa, lanes) {
        (Isa::Baseline, 1) => {
            Some(Box::new(|tables, work| trace::<_, GENERAL>(Scalar::<false>, tables, work)))
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Sse42, _) => {
            let simd = level.as_sse4_2()?;
            match lanes {
                1 => Some(scalar::<_, false>(simd)),
                4 if within(needed, GLASS) => Some(four::<_, GLASS>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx2, _) | (Isa::Avx512, 1 | 4 | 8) => {
            let simd = level.as_avx2()?;
            match lanes {
                1 => Some(scalar::<_, true>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 if within(needed, OPAQUE) => Some(eight::<_, OPAQUE>(simd)),
                8 if within(needed, GLASS) => Some(eight::<_, GLASS>(simd)),
                8 if within(needed, FINISHED) => Some(eight::<_, FINISHED>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                16 => Some(sixteen::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        #[cfg(target_arch = "x86_64")]
        (Isa::Avx512, 16) => {
            let simd = level.as_avx512()?;
            Some(match needed {
                n if within(n, OPAQUE) => sixteen::<_, OPAQUE>(simd),
                n if within(n, GLASS) => sixteen::<_, GLASS>(simd),
                n if within(n, FINISHED) => sixteen::<_, FINISHED>(simd),
                _ => sixteen::<_, GENERAL>(simd),
            })
        }
        #[cfg(target_arch = "aarch64")]
        (Isa::Neon, _) => {
            let simd = level.as_neon()?;
            match lanes {
                1 => Some(scalar::<_, true>(simd)),
                4 if within(needed, GLASS) => Some(four::<_, GLASS>(simd)),
                4 => Some(four::<_, GENERAL>(simd)),
                8 => Some(eight::<_, GENERAL>(simd)),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Records one path.
pub type Recorder = Box<dyn Fn(&Tables<f32>, [u32; 2], u64) -> PathRecord>;

/// A recorder that computes the same bits as the kernels of `isa`.
pub fn recorder(isa: Isa) -> Recorder {
    let level = Level::new();
    #[cfg(target_arch = "x86_64")]
    let fused = level.as_avx2();
    #[cfg(target_arch = "aarch64")]
    let fused = level.as_neon();
    match fused {
        Some(simd) if isa.is_fused() => Box::new(move |tables, pixel, index| {
            simd.vectorize(
                #[inline(always)]
                || record(Scalar::<true>, tables, pixel, index),
            )
        }),
        _ => Box::new(|tables, pixel, index| record(Scalar::<false>, tables, pixel, index)),
    }
}

/// The reference's kernel.
pub fn reference_kernel() -> Kernel<f64> {
    Box::new(|tables, work| trace::<_, GENERAL>(Reference, tables, work))
}

fn within(needed: u32, offered: u32) -> bool {
    needed & !offered == 0
}

fn scalar<S: Simd, const FUSED: bool>(simd: S) -> Kernel<f32> {
    Box::new(move |tables, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, GENERAL>(Scalar::<FUSED>, tables, work),
        )
    })
}

fn four<S: Permute, const NEEDS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |tables, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, NEEDS>(Lanes4(simd), tables, work),
        )
    })
}

fn eight<S: Permute, const NEEDS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |tables, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, NEEDS>(Lanes8(simd), tables, work),
        )
    })
}

fn sixteen<S: Permute, const NEEDS: u32>(simd: S) -> Kernel<f32> {
    Box::new(move |tables, work| {
        simd.vectorize(
            #[inline(always)]
            || trace::<_, NEEDS>(Lanes16(simd), tables, work),
        )
    })
}
