//! The second phase: adds light, ends paths, and finds the hit points and random numbers of the next rays.

use super::context::Context;
use super::draw::{Drawn, draw};
use super::intersect::hit_point;
use super::packet::{Packet, pixel_position};
use super::records::{ShadingRecords, is_permuted};
use super::rules::{shown_colour, strip_reflectance};
use crate::kernel::{LoadShading, NONE, RADIANCE_TOTAL_LIMIT};
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::camera::screen;
use crate::render_cpu::lanes::{Float, Lanes, Mask, Unsigned, V3, is_idle};
use crate::render_cpu::material::{Material, material_of};
use crate::render_cpu::work::{TileStats, Work};
use crate::stages::SurfaceRule;

/// The result of [`shade`], from which [`super::scatter::spawn_ray`] continues.
#[derive(Clone, Copy)]
pub(super) struct Shaded<L: Lanes> {
    /// Lanes whose path ends here; their next ray starts at the camera.
    pub ended: L::M,
    /// Lanes whose block is done and which wait to be refilled; none in a packet of few lanes.
    pub waiting: L::M,
    /// The random numbers of the next rays.
    pub drawn: Drawn<L>,
    /// Where the other lanes continue.
    pub interaction: SurfaceInteraction<L>,
    /// The materials there, unless [`is_permuted`].
    pub material: Material<L>,
}

/// Where a ray meets the surface that it has hit, and from which side; meaningless for lanes without a hit.
#[derive(Clone, Copy)]
pub(super) struct SurfaceInteraction<L: Lanes> {
    /// The hit point.
    pub position: V3<L::F>,
    /// Unit normal on the side that the ray came from.
    pub normal: V3<L::F>,
    /// Cosine between the ray's direction and the outward normal.
    pub outward_cosine: L::F,
    /// Whether the ray came from outside.
    pub front_face: L::M,
}

impl<L: Lanes> Shaded<L> {
    /// The state before the first packet is shaded.
    #[inline(always)]
    pub fn nothing(l: L) -> Self {
        let zero = l.constant(0.0);
        let position = V3::splat(zero);
        Shaded {
            ended: l.mask(0),
            waiting: l.mask(0),
            drawn: Drawn { pair: [zero; 2], jitter: [zero; 2] },
            interaction: SurfaceInteraction {
                position,
                normal: position,
                outward_cosine: zero,
                front_face: l.mask(0),
            },
            material: Material { weight: zero, refraction_index: zero, inverse_index: zero, f0: zero },
        }
    }
}

/// Shades the hits of a packet and sets what [`super::scatter::spawn_ray`] needs. Lanes whose block is done are refilled
/// only if `refills`; otherwise they wait.
///
/// The hit points do not depend on the random numbers. Found here, they occupy the processor while it waits for these.
#[inline(always)]
pub(super) fn shade<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &mut Packet<L>,
    work: &mut Work,
    stats: &mut TileStats,
    refills: bool,
    shaded: &mut Shaded<L>,
) {
    let Context { l, broadcast } = context;
    let (zero, one) = (l.constant(0.0), l.constant(1.0));

    // End paths that miss, that were absorbed, or that have all their rays.
    let miss = packet.nearest.sphere.eq(l.splat_u(NONE));
    let is_last = packet.stream.eq(packet.blocks.key + l.load_u(&broadcast.last_bounce));
    let mut ended = miss | is_last | packet.absorbed;

    // Add the light of the sky where rays miss, or what the stage shows in its place.
    let mut lit = miss & !packet.absorbed;
    let mut light =
        if is_idle::<L>(lit) { V3::splat(zero) } else { sky_light(l, broadcast, packet.rays.direction.y) };
    let outward = || {
        let record = ShadingRecords::load(context, packet);
        hit_point(context, packet, &record).outward
    };
    if let Some(shown) = shown_colour(context, packet, miss, light, outward) {
        (light, lit, ended) = (shown, !packet.absorbed, l.mask(u32::MAX));
    }
    if !is_idle::<L>(lit) {
        add_radiance(l, packet, lit, light, stats);
    }

    // Find where the other paths continue, and what the surface leaves of their light.
    let full = V3::splat(one);
    if is_idle::<L>(!ended) {
        packet.throughput = full;
    } else {
        let record = ShadingRecords::load(context, packet);
        if !is_permuted(context) {
            shaded.material = material_of(&record);
        }
        shaded.interaction = surface_interaction(context, packet, &record);
        let albedo = albedo_of(context, &record, packet.blocks.pixel);
        packet.throughput = ended.select(full, packet.throughput.times(albedo));
    }

    // Start the next sample where a path has ended.
    shaded.waiting = next_sample(l, broadcast, packet, work, ended, refills);
    packet.stream = ended.select(packet.blocks.key, packet.stream + l.splat_u(1));
    shaded.ended = ended;

    // Draw the random numbers of the next rays.
    draw(context, packet, &mut shaded.drawn);
}

/// The sky's radiance in a direction with this y component, in units of the film.
#[inline(always)]
fn sky_light<L: Lanes>(l: L, broadcast: &BroadcastScene<L::Real>, height: L::F) -> V3<L::F> {
    let zero = l.constant(0.0);
    let channel = |channel: usize| {
        let (middle, slope) = (l.load(&broadcast.sky_middle[channel]), l.load(&broadcast.sky_slope[channel]));
        zero.max(slope.mul_add(height, middle))
    };
    V3 { x: channel(0), y: channel(1), z: channel(2) }
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

/// Moves lanes whose path has ended to the next sample of their block. Those at its end are refilled together, if
/// `refills`; otherwise they are returned, and wait.
#[inline(always)]
fn next_sample<L: Lanes>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    work: &mut Work,
    ended: L::M,
    refills: bool,
) -> L::M {
    let next = packet.blocks.counter + packet.blocks.step;
    let at_end = ended & next.eq(packet.blocks.end);
    packet.blocks.counter = (ended & !at_end).select(next, packet.blocks.counter);
    let done = at_end.bits();
    if !refills || done == 0 {
        return at_end;
    }
    enter_block(l, broadcast, packet, work, done);
    l.mask(0)
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
    packet.corner = screen(l, &broadcast.camera, x, y);
}

/// Finds where and from which side the rays meet the surfaces that they have hit.
#[inline(always)]
fn surface_interaction<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &Packet<L>,
    record: &ShadingRecords<L>,
) -> SurfaceInteraction<L> {
    let (l, features) = (context.l, context.features());
    let point = hit_point(context, packet, record);
    let outward_cosine = packet.rays.direction.dot(point.outward);
    let mut front_face = outward_cosine.lt(l.constant(0.0));
    if features.surface() == SurfaceRule::Exact {
        front_face = front_face & !packet.rays.inside.eq(packet.nearest.sphere);
    }
    if features.cavity() {
        front_face = front_face & !record.is_cavity(l);
    }
    let normal = point.outward.negate_where(l, !front_face);
    SurfaceInteraction { position: point.position, normal, outward_cosine, front_face }
}

/// The reflectance of the surfaces that were hit.
#[inline(always)]
fn albedo_of<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    record: &ShadingRecords<L>,
    pixel: L::U,
) -> V3<L::F> {
    if context.features().reflectance_strips() {
        let width = context.broadcast.prepared.settings.width;
        let reflectance = strip_reflectance(context.l, width, pixel);
        return V3::splat(reflectance);
    }
    record.albedo()
}
