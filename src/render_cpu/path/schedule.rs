//! Keeps the lanes full and lets packets take turns.
//!
//! Each lane traces one pixel at a time. When a path ends, the lane starts the pixel's next sample immediately. When
//! its block of samples is done, the lane is refilled with the next (block, pixel) of the tile, so a packet never waits
//! for its longest path. A lane's sums stay in 32-bit registers until its block is done.
//!
//! Several packets take turns in each phase, so that the latency of one hides behind the others; in small kernels with
//! one lane, shading and scattering are a single phase. A processor looks only a few hundred instructions ahead, so a
//! phase is fast if it is short and consists of several chains that do not wait for each other. That is why hit points
//! and random numbers are found together in one phase, and sines and the angles of glass in another.

use super::context::Context;
use super::intersect::intersect;
use super::packet::{Packet, is_small};
use super::scatter::spawn_ray;
use super::shade::{Shaded, shade};
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::bvh::EMPTY_STACK;
use crate::render_cpu::lanes::{Lanes, is_wide};
use crate::render_cpu::work::{TileStats, Work};

/// Maximum number of packets that take turns. On an AVX-512 Xeon, with three of them 16 lanes are 2 to 3 % slower, and
/// six gain nothing.
const PACKETS: usize = 4;

/// Packets that take turns where a packet is a single ray and the kernel is small. On the same processor, one takes 1.3
/// times as long, and three 1.05 times.
const SINGLE_RAYS: usize = 2;

/// Traces all of `work` with the code that `PARTS` selects, which must include everything the job needs.
#[inline(always)]
pub fn trace<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    work: &mut Work,
) -> TileStats {
    let context = Context::<L, PARTS> { l, broadcast };
    let mut packets: [Packet<L>; PACKETS] =
        [Packet::idle(l), Packet::idle(l), Packet::idle(l), Packet::idle(l)];
    let packets = if is_small::<L, PARTS>() { &mut packets[..SINGLE_RAYS] } else { &mut packets[..] };
    let mut shaded = [Shaded::nothing(l); PACKETS];
    let mut stats = TileStats::default();
    let mut stack = EMPTY_STACK;
    continue_paths(context, packets, &mut shaded, work, true, &mut stats);
    let pause = if is_wide::<L>() { work.pause() } else { 0 };
    let mut steps_to_refill = pause;
    loop {
        let mut busy = 0;
        for packet in &mut *packets {
            intersect(context, packet, &mut stack, &mut stats);
            busy |= packet.busy;
        }
        if busy == 0 {
            return stats;
        }
        stats.offered_lanes += (packets.len() * L::WIDTH) as u64;
        let refills = steps_to_refill == 0;
        steps_to_refill = if refills { pause } else { steps_to_refill - 1 };
        continue_paths(context, packets, &mut shaded, work, refills, &mut stats);
    }
}

/// Shades the hits of all packets and spawns their next rays.
#[inline(always)]
pub(super) fn continue_paths<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packets: &mut [Packet<L>],
    shaded: &mut [Shaded<L>],
    work: &mut Work,
    refills: bool,
    stats: &mut TileStats,
) {
    if is_small::<L, PARTS>() {
        for packet in packets {
            let mut shaded = Shaded::nothing(context.l);
            shade(context, packet, work, stats, refills, &mut shaded);
            spawn_ray(context, packet, &shaded);
        }
        return;
    }
    for (packet, shaded) in packets.iter_mut().zip(&mut *shaded) {
        shade(context, packet, work, stats, refills, shaded);
    }
    for (packet, shaded) in packets.iter_mut().zip(shaded) {
        spawn_ray(context, packet, shaded);
    }
}
