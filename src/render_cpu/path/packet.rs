//! A packet: the state of a path in each lane, from ray to ray.

use crate::kernel::parts;
use crate::render_cpu::lanes::{Lanes, V3};
use crate::render_cpu::sphere::{NONE, Nearest, Rays};
use crate::render_cpu::work::LaneBlocks;

pub(super) struct Packet<L: Lanes> {
    pub rays: Rays<L>,
    pub nearest: Nearest<L>,
    pub throughput: V3<L::F>,
    /// Squared sine of the angle between a ray inside steep glass and the normal where it starts; it is the same where
    /// the ray ends.
    pub sine2: L::F,
    /// The sampler's stream: its key plus the number of bounces so far.
    pub stream: L::U,
    /// Left and upper edge of the pixel on the plane at distance 1.
    pub corner: [L::F; 2],
    /// Lanes whose path was absorbed, or which wait to be refilled. They end at the next step, add nothing and are not
    /// counted as rays.
    pub absorbed: L::M,
    pub blocks: LaneBlocks<L>,
    /// Bit mask of the lanes that have a block. The others keep tracing; their results are discarded.
    pub busy: u32,
}

impl<L: Lanes> Packet<L> {
    /// All lanes at the end of an empty block, so that the first [`super::shade::shade`] refills them.
    #[inline(always)]
    pub fn idle(l: L) -> Self {
        let zero = l.constant(0.0);
        let origin = V3::splat(zero);
        let none = l.splat_u(NONE);
        Packet {
            rays: Rays { origin, direction: origin, left: none, inside: none },
            nearest: Nearest::nothing(l),
            throughput: origin,
            sine2: zero,
            stream: l.splat_u(0),
            corner: [zero; 2],
            absorbed: l.mask(0),
            blocks: LaneBlocks::none(l),
            busy: 0,
        }
    }
}

/// Whether a step is so short that the processor looks ahead to the next packet on its own. With one lane on the book,
/// the general kernel is 1.1 times as fast with four packets and three phases.
pub(super) const fn is_small<L: Lanes, const PARTS: u32>() -> bool {
    L::WIDTH == 1 && PARTS & parts::HIERARCHY == 0
}

/// Splits `x | y << 16` into column and row.
#[inline(always)]
pub(super) fn pixel_position<L: Lanes>(l: L, pixel: L::U) -> [L::F; 2] {
    [L::float_of(pixel & l.splat_u(0xFFFF)), L::float_of(pixel >> 16)]
}
