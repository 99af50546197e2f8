//! The numbers that paths are made from.

use super::{Packet, needs};
use crate::render::SamplerKind;
use crate::render_cpu::lanes::{Lanes, unit_float};
use crate::render_cpu::rng::{lens_stream_of, pcg4d, sobol_pair};
use crate::sampling::GOLDEN_RATIO;
use crate::tables::Tables;

/// The numbers for a packet's next rays.
#[derive(Clone, Copy)]
pub(super) struct Draw<L: Lanes> {
    /// For a direction or a point on the lens.
    pub pair: [L::F; 2],
    /// Sine of the second of the pair, in turns.
    pub sine: L::F,
    /// Its cosine.
    pub cosine: L::F,
    /// For a point in the pixel where the pair is for the lens.
    pub jitter: [L::F; 2],
}

/// By how much a path's stream grows with each ray, and by how much in all up to its last.
#[inline(always)]
pub(super) fn strides<R>(tables: &Tables<R>) -> (u32, u32) {
    let stride = match tables.settings.sampler {
        SamplerKind::Independent => 1,
        SamplerKind::Sobol => GOLDEN_RATIO,
    };
    (stride, stride.wrapping_mul(tables.settings.max_depth - 1))
}

/// Whether rays start on a lens.
#[inline(always)]
pub(super) fn has_lens<L: Lanes, const NEEDS: u32>(tables: &Tables<L::Real>) -> bool {
    NEEDS & needs::LENS != 0 && tables.camera.tau > L::Real::default()
}

/// Draws the numbers for the next rays.
#[inline(always)]
pub(super) fn draw<L: Lanes, const NEEDS: u32>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &Packet<L>,
) -> Draw<L> {
    let (first, second) = match tables.settings.sampler {
        SamplerKind::Independent => {
            let (pixel, seed) = (l.load_u(&packet.blocks.pixel), l.splat_u(tables.settings.seed));
            let [a, b, c, d] = pcg4d(l, [pixel, packet.counter, packet.stream, seed]);
            ([a, b], [c, d])
        }
        SamplerKind::Sobol => {
            let first = sobol_pair(l, packet.counter, packet.stream);
            let second = if has_lens::<L, NEEDS>(tables) {
                sobol_pair(l, packet.counter, lens_stream_of(l, packet.stream))
            } else {
                first
            };
            (first, second)
        }
    };
    let unit = |u: [L::U; 2]| [unit_float(l, u[0]), unit_float(l, u[1])];
    let pair = unit(first);
    let (sine, cosine) = l.sin_cos_turns(pair[1]);
    let jitter = if has_lens::<L, NEEDS>(tables) { unit(second) } else { packet.draw.jitter };
    Draw { pair, sine, cosine, jitter }
}
