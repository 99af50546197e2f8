//! The path loop: packets of rays that are always full.
//!
//! Each lane traces one pixel at a time. When a path ends, the lane starts the pixel's next sample immediately. When
//! its block of samples is done, the lane is refilled with the next (block, pixel) of the tile, so a packet never waits
//! for its longest path. A lane's sums stay in 32-bit registers until its block is done.
//!
//! Several packets take turns in three phases (intersect, collect, send on), so that the latency of one hides behind the
//! others; in small kernels with one lane, the last two phases are one. A processor looks only a few hundred instructions
//! ahead, so a phase is fast if it is short and consists of several chains that do not wait for each other. That is why
//! hit points and random numbers are found together in one phase, and sines and the angles of glass in another.
//!
//! Twin: shaders/path.wgsl

mod arrive;
mod collect;
mod draw;
mod record;
mod records;
mod send;

pub use record::record;

use super::broadcast::BroadcastScene;
use super::bvh::{EMPTY_STACK, Stack, traverse};
use super::lanes::{Float, Lanes, Mask, V3, is_wide};
use super::sphere::{
    NONE, Nearest, Rays, Spheres, SurfacePoint, anchored_root, anchored_surface_point, book_point, book_root,
    near_root, nearest_root, speck_surface_point, surface_point,
};
use super::work::{LaneBlocks, TileStats, Work};
use crate::kernel::{LoadShading, parts};
use crate::prepared::PreparedScene;
use crate::stages::SurfaceRule;
use collect::{Collected, collect};
use records::HitRecords;
use send::send_on;

/// Packets that take turns, at most. On an AVX-512 Xeon, with three of them 16 lanes are 2 to 3 % slower, and six gain
/// nothing.
const PACKETS: usize = 4;

/// Packets that take turns where a packet is a single ray and the kernel is small. On the same processor, one takes 1.3
/// times as long, and three 1.05 times.
const SINGLE_RAYS: usize = 2;

struct Packet<L: Lanes> {
    rays: Rays<L>,
    nearest: Nearest<L>,
    throughput: V3<L::F>,
    /// Squared sine of the angle between a ray inside steep glass and the normal where it starts; it is the same where
    /// the ray ends.
    sine2: L::F,
    /// The sampler's stream, which selects the ray of the sample.
    stream: L::U,
    screen: [L::F; 2],
    /// Lanes whose path was absorbed, or which wait to be refilled. It ends at its next shading, adds nothing and does not
    /// count as a ray.
    absorbed: L::M,
    blocks: LaneBlocks<L>,
    /// Lanes that have a block, as bits. The others go on tracing, but nobody looks at what they do.
    busy: u32,
}

impl<L: Lanes> Packet<L> {
    /// All lanes at the end of an empty block, so that the first shading refills them.
    #[inline(always)]
    fn idle(l: L) -> Self {
        let zero = l.constant(0.0);
        let nowhere = V3 { x: zero, y: zero, z: zero };
        let none = l.splat_u(NONE);
        let nought = l.splat_u(0);
        Packet {
            rays: Rays { origin: nowhere, direction: nowhere, left: none, inside: none },
            nearest: Nearest::nothing(l),
            throughput: nowhere,
            sine2: zero,
            stream: nought,
            screen: [zero; 2],
            absorbed: l.mask(0),
            blocks: LaneBlocks::none(l),
            busy: 0,
        }
    }
}

/// Traces all of `work` with the code that `PARTS` selects, which must include everything the job needs.
#[inline(always)]
pub fn trace<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    work: &mut Work,
) -> TileStats {
    let mut packets: [Packet<L>; PACKETS] =
        [Packet::idle(l), Packet::idle(l), Packet::idle(l), Packet::idle(l)];
    let packets = if is_small::<L, PARTS>() { &mut packets[..SINGLE_RAYS] } else { &mut packets[..] };
    let mut collected = [Collected::nothing(l); PACKETS];
    let mut stats = TileStats::default();
    let mut stack = EMPTY_STACK;
    shade::<L, PARTS>(l, broadcast, packets, &mut collected, work, true, &mut stats);
    let pause = if is_wide::<L>() { work.pause() } else { 0 };
    let mut steps_left = pause;
    loop {
        let mut busy = 0;
        for packet in &mut *packets {
            intersect::<L, PARTS>(l, broadcast, packet, &mut stack, &mut stats);
            busy |= packet.busy;
        }
        if busy == 0 {
            return stats;
        }
        stats.offered_lanes += (packets.len() * L::WIDTH) as u64;
        let refills = steps_left == 0;
        steps_left = if refills { pause } else { steps_left - 1 };
        shade::<L, PARTS>(l, broadcast, packets, &mut collected, work, refills, &mut stats);
    }
}

/// Whether a step is short enough that the processor looks ahead to the next packet by itself. On the book with one lane,
/// the general kernel is 1.1 times as fast with four packets and three phases.
const fn is_small<L: Lanes, const PARTS: u32>() -> bool {
    L::WIDTH == 1 && PARTS & parts::HIERARCHY == 0
}

/// Ends the paths of packets or continues them.
#[inline(always)]
fn shade<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packets: &mut [Packet<L>],
    collected: &mut [Collected<L>],
    work: &mut Work,
    refills: bool,
    stats: &mut TileStats,
) {
    if is_small::<L, PARTS>() {
        for packet in packets {
            let mut collected = Collected::nothing(l);
            collect::<L, PARTS>(l, broadcast, packet, work, stats, refills, &mut collected);
            send_on::<L, PARTS>(l, broadcast, packet, &collected);
        }
        return;
    }
    for (packet, collected) in packets.iter_mut().zip(&mut *collected) {
        collect::<L, PARTS>(l, broadcast, packet, work, stats, refills, collected);
    }
    for (packet, collected) in packets.iter_mut().zip(collected) {
        send_on::<L, PARTS>(l, broadcast, packet, collected);
    }
}

/// Finds the nearest hit of each ray in a packet.
#[inline(always)]
fn intersect<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    stack: &mut Stack,
    stats: &mut TileStats,
) {
    if packet.busy == 0 {
        return;
    }
    let active = packet.busy & !packet.absorbed.bits();
    stats.rays += u64::from(active.count_ones());
    let (rays, prepared) = (&packet.rays, &broadcast.prepared);
    let mut nearest = Nearest::nothing(l);
    let book_t_min =
        if PARTS & parts::RULES != 0 { prepared.features.surface.smallest_distance() } else { None };
    if let Some(t_min) = book_t_min {
        let t_min = l.constant(t_min);
        for sphere in broadcast.opaque.iter().chain(&broadcast.two_root) {
            let sphere = Spheres::load(l, sphere);
            nearest.take(l, book_root(l, rays, &sphere, t_min), sphere.number);
        }
    } else {
        for sphere in &broadcast.opaque {
            let sphere = Spheres::load(l, sphere);
            nearest.take(l, near_root(l, rays, &sphere), sphere.number);
        }
        match &prepared.hierarchy {
            Some(hierarchy) if PARTS & parts::HIERARCHY != 0 => {
                // A hit of the ground rules out the boxes behind it.
                take_anchored::<L, PARTS>(l, prepared, rays, &mut nearest);
                traverse(l, hierarchy, &prepared.two_root, rays, l.mask(active), stack, &mut nearest);
            }
            _ if PARTS & parts::GLASS != 0 => {
                for sphere in &broadcast.two_root {
                    let sphere = Spheres::load(l, sphere);
                    nearest.take(l, nearest_root(l, rays, &sphere), sphere.number);
                }
                take_anchored::<L, PARTS>(l, prepared, rays, &mut nearest);
            }
            _ => take_anchored::<L, PARTS>(l, prepared, rays, &mut nearest),
        }
    }
    packet.nearest = nearest;
}

/// Takes the hits of the anchored spheres, where they are nearer.
#[inline(always)]
fn take_anchored<L: Lanes, const PARTS: u32>(
    l: L,
    prepared: &PreparedScene<L::Real>,
    rays: &Rays<L>,
    nearest: &mut Nearest<L>,
) {
    if PARTS & parts::EXTREMES == 0 {
        return;
    }
    let one = l.splat_u(1);
    let mut number = l.splat_u((prepared.opaque.len() + prepared.two_root.len()) as u32);
    for sphere in &prepared.anchored {
        nearest.take(l, anchored_root(l, rays, sphere, number), number);
        number = number + one;
    }
}

/// The points of the hits; meaningless for lanes without one.
#[inline(always)]
fn hit_point<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &Packet<L>,
    record: &HitRecords<L>,
) -> SurfacePoint<L> {
    let (rays, features) = (&packet.rays, &broadcast.prepared.features);
    let t = packet.nearest.distance();
    let (reference, curvature) = (record.reference(), record.curvature());
    if PARTS & parts::RULES != 0 && features.surface != SurfaceRule::Exact {
        return book_point(rays, t, reference, curvature);
    }
    let radius = record.radius();
    let mut point = if PARTS & parts::EXTREMES != 0 && features.specks {
        speck_surface_point(l, rays, t, reference, curvature, radius)
    } else {
        surface_point(l, rays, t, reference, curvature, radius)
    };
    if PARTS & parts::EXTREMES != 0 && features.anchored {
        let far = anchored_surface_point(l, rays, t, reference, record.inward(), curvature);
        let is_anchored = l.constant(0.0).lt(record.anchoring());
        point.position = is_anchored.select(far.position, point.position);
        point.outward = is_anchored.select(far.outward, point.outward);
    }
    point
}

/// Splits `x | y << 16` into column and row.
#[inline(always)]
fn pixel_position<L: Lanes>(l: L, pixel: L::U) -> [L::F; 2] {
    [L::float_of(pixel & l.splat_u(0xFFFF)), L::float_of(pixel >> 16)]
}
