//! One path, ray by ray, traced by the packets' code.

use super::{Collected, Packet, intersect, parts, shade};
use crate::kernel::Real;
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::bvh::{EMPTY_STACK, Stack};
use crate::render_cpu::lanes::{Lanes, Mask, V3, Wide, WideU};
use crate::render_cpu::work::{TileStats, Work};

/// A packet of one lane, used to record what a path does.
pub struct SinglePath<L: Lanes> {
    packet: Packet<L>,
    stack: Stack,
}

impl<L: Lanes> SinglePath<L> {
    /// Starts with the first sample of `work`.
    #[inline(always)]
    pub fn start(l: L, broadcast: &BroadcastScene<L::Real>, work: &mut Work) -> Self {
        let mut packet = Packet::idle(l);
        shade::<L, { parts::ALL }>(
            l,
            broadcast,
            std::slice::from_mut(&mut packet),
            &mut [Collected::nothing(l)],
            work,
            true,
            &mut TileStats::default(),
        );
        SinglePath { packet, stack: EMPTY_STACK }
    }

    /// Whether there is a ray left to trace.
    pub fn is_alive(&self) -> bool {
        self.packet.busy != 0
    }

    /// Whether the path was absorbed at its last hit.
    pub fn is_absorbed(&self) -> bool {
        self.packet.absorbed.bits() != 0
    }

    /// Start of the current ray.
    pub fn origin(&self) -> V3<L::F> {
        self.packet.rays.origin
    }

    /// Unit direction of the current ray.
    pub fn direction(&self) -> V3<L::F> {
        self.packet.rays.direction
    }

    /// Factor by which light that arrives along the ray is multiplied.
    pub fn throughput(&self) -> V3<L::F> {
        self.packet.throughput
    }

    /// Traces the ray and continues the path. Returns the number of the sphere that it hit and the distance.
    #[inline(always)]
    pub fn advance(&mut self, l: L, broadcast: &BroadcastScene<L::Real>, work: &mut Work) -> (u32, f64) {
        let mut stats = TileStats::default();
        intersect::<L, { parts::ALL }>(l, broadcast, &mut self.packet, &mut self.stack, &mut stats);
        let (mut sphere, mut distance) = (WideU::default(), Wide::default());
        L::store_u(self.packet.nearest.sphere, &mut sphere);
        L::store(self.packet.nearest.distance(), &mut distance);
        let packets = std::slice::from_mut(&mut self.packet);
        shade::<L, { parts::ALL }>(
            l,
            broadcast,
            packets,
            &mut [Collected::nothing(l)],
            work,
            true,
            &mut stats,
        );
        (sphere.0[0], distance.0[0].to_f64())
    }
}
