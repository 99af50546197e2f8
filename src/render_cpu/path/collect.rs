//! What a ray contributes, where it arrives, and the next sample where its path has ended.

use super::arrive::{Arrival, albedo_of, arrive};
use super::draw::{Draw, draw, last_stream, next_stream};
use super::records::{HitRecords, is_permuted};
use super::{Packet, hit_point, pixel_position};
use crate::film::FIXED_POINT_SCALE;
use crate::kernel::{NONE, RADIANCE_TOTAL_LIMIT, parts};
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::camera::screen;
use crate::render_cpu::lanes::{Float, Lanes, Mask, Unsigned, V3, is_idle, is_wide};
use crate::render_cpu::material::{Surface, surface_of};
use crate::render_cpu::work::{TileStats, Work};
use crate::stages::Shading;

/// What [`collect`] finds out for [`super::send_on`].
#[derive(Clone, Copy)]
pub(super) struct Collected<L: Lanes> {
    /// Lanes whose path ends here; their next ray starts at the camera.
    pub ended: L::M,
    /// Lanes whose block is done and which wait to be refilled.
    pub waiting: L::M,
    /// The numbers for the next rays.
    pub draw: Draw<L>,
    /// Where the other lanes go on.
    pub arrival: Arrival<L>,
    /// The materials there, unless [`is_permuted`].
    pub surface: Surface<L>,
}

impl<L: Lanes> Collected<L> {
    /// The state before anything is collected.
    #[inline(always)]
    pub fn nothing(l: L) -> Self {
        let zero = l.constant(0.0);
        let nowhere = V3 { x: zero, y: zero, z: zero };
        Collected {
            ended: l.mask(0),
            waiting: l.mask(0),
            draw: Draw { pair: [zero; 2], jitter: [zero; 2] },
            arrival: Arrival { position: nowhere, normal: nowhere, outward_cosine: zero, front: l.mask(0) },
            surface: Surface { weight: zero, refraction_index: zero, inverse_index: zero, f0: zero },
        }
    }
}

/// Adds the arriving light, ends paths, finds the hit points of the others, starts the next sample where a path has
/// ended, and draws the numbers for the next rays. Lanes whose block is done are refilled only if `refills`; otherwise
/// they wait.
///
/// The hit points do not depend on the numbers. Found here, they occupy the processor while it waits for these.
#[inline(always)]
pub(super) fn collect<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    work: &mut Work,
    stats: &mut TileStats,
    refills: bool,
    collected: &mut Collected<L>,
) {
    let prepared = &broadcast.prepared;
    let miss = packet.nearest.sphere.eq(l.splat_u(NONE));
    let is_last = packet.stream.eq(last_stream(l, broadcast, packet));
    let mut ended = miss | is_last | packet.absorbed;
    let mut lit = miss & !packet.absorbed;
    let mut light = if is_idle::<L>(lit) {
        V3 { x: l.constant(0.0), y: l.constant(0.0), z: l.constant(0.0) }
    } else {
        shade_miss(l, broadcast, packet.rays.direction.y)
    };
    if PARTS & parts::RULES != 0 && prepared.features.shading != Shading::Path {
        light = shade_hit::<L, PARTS>(l, broadcast, packet, miss, light);
        lit = if is_wide::<L>() { !packet.absorbed } else { l.mask(u32::MAX) };
        ended = l.mask(u32::MAX);
    }
    if !is_idle::<L>(lit) {
        add_radiance(l, packet, lit, light, stats);
    }

    let one = l.constant(1.0);
    let full = V3 { x: one, y: one, z: one };
    if is_idle::<L>(!ended) {
        packet.throughput = full;
    } else {
        let record = HitRecords::load::<PARTS>(l, broadcast, packet);
        if !is_permuted::<L, PARTS>(&broadcast.prepared) {
            collected.surface = surface_of(&record);
        }
        collected.arrival = arrive::<L, PARTS>(l, broadcast, packet, &record);
        let albedo = albedo_of::<L, PARTS>(l, prepared, &record, packet.blocks.pixel);
        packet.throughput = ended.select(full, packet.throughput.times(albedo));
    }

    // Lanes whose path has ended go on to the next sample or the next block.
    let next = packet.blocks.counter + packet.blocks.step;
    if is_wide::<L>() {
        let at_end = ended & next.eq(packet.blocks.end);
        packet.blocks.counter = (ended & !at_end).select(next, packet.blocks.counter);
        collected.waiting = at_end;
        let done = at_end.bits();
        if refills && done != 0 {
            enter_block(l, broadcast, packet, work, done);
            collected.waiting = l.mask(0);
        }
    } else {
        packet.blocks.counter = ended.select(next, packet.blocks.counter);
        let done = (ended & packet.blocks.counter.eq(packet.blocks.end)).bits();
        if done != 0 {
            enter_block(l, broadcast, packet, work, done);
        }
    }
    packet.stream = ended.select(packet.blocks.key, next_stream(l, broadcast, packet));
    collected.ended = ended;
    draw::<L, PARTS>(l, prepared, packet, &mut collected.draw);
}

/// The sky's radiance in a direction with this y component, in units of the film.
#[inline(always)]
fn shade_miss<L: Lanes>(l: L, broadcast: &BroadcastScene<L::Real>, height: L::F) -> V3<L::F> {
    let zero = l.constant(0.0);
    let channel = |channel: usize| {
        let (middle, slope) = (l.load(&broadcast.sky_middle[channel]), l.load(&broadcast.sky_slope[channel]));
        zero.max(slope.mul_add(height, middle))
    };
    V3 { x: channel(0), y: channel(1), z: channel(2) }
}

/// A ray's contribution in stages that show something simpler than light; `light` where the ray misses.
#[inline(always)]
fn shade_hit<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &Packet<L>,
    miss: L::M,
    light: V3<L::F>,
) -> V3<L::F> {
    let prepared = &broadcast.prepared;
    let (zero, full) = (l.constant(0.0), l.constant(FIXED_POINT_SCALE));
    let shown = match prepared.features.shading {
        Shading::ImageGradient => {
            let position = pixel_position(l, packet.blocks.pixel);
            // A single column or row has no far end, so its share is 0.
            let share = |position: L::F, pixels: u32| {
                position / l.constant(f64::from(pixels.saturating_sub(1).max(1))) * full
            };
            let settings = &prepared.settings;
            return V3 {
                x: share(position[0], settings.width),
                y: share(position[1], settings.height),
                z: zero,
            };
        }
        Shading::FirstHitRed => V3 { x: full, y: zero, z: zero },
        Shading::Normals | Shading::Path => {
            let half = l.constant(0.5 * FIXED_POINT_SCALE);
            let record = HitRecords::load::<PARTS>(l, broadcast, packet);
            let outward = hit_point::<L, PARTS>(l, broadcast, packet, &record).outward;
            let shade = |n: L::F| zero.max(n.mul_add(half, half));
            V3 { x: shade(outward.x), y: shade(outward.y), z: shade(outward.z) }
        }
    };
    miss.select(light, shown)
}

/// Adds the radiance of a finished path to the sums of the lanes in `lit`, or counts it as rejected if it is not a
/// number that can be added.
#[inline(always)]
fn add_radiance<L: Lanes>(l: L, packet: &mut Packet<L>, lit: L::M, light: V3<L::F>, stats: &mut TileStats) {
    let radiance = light.times(packet.throughput);
    let total = radiance.x + radiance.y + radiance.z;
    let is_invalid = lit & !total.lt(l.constant(RADIANCE_TOTAL_LIMIT));
    let mut added = lit;
    let invalid = is_invalid.bits();
    if invalid != 0 {
        stats.rejected += u64::from((invalid & packet.busy).count_ones());
        added = lit & !is_invalid;
    }
    let mut add = |channel: usize, x: L::F| {
        let sum = &mut packet.blocks.sums[channel];
        *sum = *sum + l.keep(added, l.fixed_point(x));
    };
    add(0, radiance.x);
    add(1, radiance.y);
    add(2, radiance.z);
}

/// Refills the lanes `done` with their next blocks of samples.
#[inline(always)]
fn enter_block<L: Lanes>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    work: &mut Work,
    done: u32,
) {
    let (blocks, busy) = work.refill(l, done, packet.busy, packet.blocks);
    (packet.blocks, packet.busy) = (blocks, busy);
    let [x, y] = pixel_position(l, blocks.pixel);
    packet.screen = screen(l, &broadcast.camera, x, y);
}
