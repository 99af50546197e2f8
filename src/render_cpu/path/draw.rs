//! The random numbers of a path.

use super::context::Context;
use super::packet::Packet;
use crate::kernel::parts;
use crate::render_cpu::lanes::{Lanes, unit_float};
use crate::render_cpu::rng::numbers;

/// The numbers for a packet's next rays.
#[derive(Clone, Copy)]
pub(super) struct Drawn<L: Lanes> {
    /// For a direction, or for a point on the lens.
    pub pair: [L::F; 2],
    /// For the point in the pixel when the pair is used for the lens; otherwise not set.
    pub jitter: [L::F; 2],
}

/// Draws the numbers for the next rays.
#[inline(always)]
pub(super) fn draw<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &Packet<L>,
    drawn: &mut Drawn<L>,
) {
    let (l, with_lens) = (context.l, has_lens(context));
    let (blocks, settings) = (&packet.blocks, &context.broadcast.prepared.settings);
    let [first, second] =
        numbers(l, settings, blocks.pixel, blocks.counter, blocks.key, packet.stream, with_lens);
    let unit = |u: [L::U; 2]| [unit_float(l, u[0]), unit_float(l, u[1])];
    drawn.pair = unit(first);
    if with_lens {
        drawn.jitter = unit(second);
    }
}

/// Whether rays start on a lens.
#[inline(always)]
pub(super) fn has_lens<L: Lanes, const PARTS: u32>(context: Context<L, PARTS>) -> bool {
    PARTS & parts::LENS != 0 && context.broadcast.prepared.camera.tau > L::Real::default()
}
