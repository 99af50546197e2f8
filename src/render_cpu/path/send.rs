//! Continues paths: from the surface that was hit, or from the camera where a path has ended.

use super::arrive::Arrival;
use super::collect::Collected;
use super::draw::{Draw, has_lens};
use super::records::{HitRecords, is_permuted};
use super::{Packet, is_small};
use crate::kernel::{EYE, NEAR_ZERO, NONE, parts};
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::camera::{CameraRays, lens_ray, pinhole_ray};
use crate::render_cpu::lanes::{Float, Lanes, Mask, Unsigned, V3, is_idle, is_wide};
use crate::render_cpu::material::{
    Incidence, Scatter, Surface, hemisphere, incidence_of, incidence_of_sine2, refracted, scatter, surface_of,
};
use crate::render_cpu::sphere::Rays;
use crate::stages::DielectricLaws;

/// Continues paths from their hits, and starts new ones at the camera where a path has ended.
#[inline(always)]
pub(super) fn send_on<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    collected: &Collected<L>,
) {
    let (hit, &Collected { ended, draw, arrival, .. }) = (packet.nearest.sphere, collected);
    // A ray from a pinhole needs no direction on the sphere.
    let needs_direction =
        !is_idle::<L>(!ended) || !is_small::<L, PARTS>() || has_lens::<L, PARTS>(&broadcast.prepared);
    let [u0, u1] = draw.pair;
    let (sine, cosine) = if needs_direction { l.sin_cos_turns(u1) } else { (u0, u0) };
    let bounced = if is_idle::<L>(!ended) {
        Bounced::nowhere(l)
    } else {
        scatter_path::<L, PARTS>(l, broadcast, packet, collected, sine, cosine)
    };
    let camera = if is_idle::<L>(ended) {
        CameraRays { origin: arrival.position, direction: bounced.direction }
    } else {
        generate_camera_ray::<L, PARTS>(l, broadcast, packet.screen, &draw, sine, cosine)
    };
    let direction = ended.select(camera.direction, bounced.direction);
    let (direction, length2) = with_length2_or(l, direction, arrival.normal);
    // Metal absorbs a fuzzy reflection that points into the surface.
    let absorbed = bounced.is_metal & !l.constant(0.0).lt(direction.dot(arrival.normal)) & !ended;
    packet.absorbed = if is_wide::<L>() { absorbed | collected.waiting } else { absorbed };
    let none = l.splat_u(NONE);
    let hit = l.fill(ended, hit);
    let mut left = bounced.outward.select(hit, none);
    if PARTS & parts::EXTREMES != 0 && broadcast.prepared.features.eye_on_surface {
        left = ended.select(l.splat_u(EYE), left);
    }
    packet.rays = Rays {
        origin: ended.select(camera.origin, arrival.position),
        direction: direction.scale(l.constant(1.0) / length2.sqrt()),
        left,
        inside: bounced.outward.select(none, hit),
    };
}

/// `v` and its squared length, or the unit vector `substitute` and 1 where `v` is too short to have a direction.
#[inline(always)]
fn with_length2_or<L: Lanes>(l: L, v: V3<L::F>, substitute: V3<L::F>) -> (V3<L::F>, L::F) {
    let length2 = v.dot(v);
    let vanishes = length2.lt(l.constant(NEAR_ZERO));
    // So rare that a jump costs less than a selection.
    if vanishes.bits() == 0 {
        return (v, length2);
    }
    (vanishes.select(substitute, v), vanishes.select(l.constant(1.0), length2))
}

/// The camera rays of new paths.
#[inline(always)]
fn generate_camera_ray<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    screen: [L::F; 2],
    draw: &Draw<L>,
    sine: L::F,
    cosine: L::F,
) -> CameraRays<L> {
    let antialiasing = PARTS & parts::RULES == 0 || broadcast.prepared.features.antialiasing;
    let with_lens = has_lens::<L, PARTS>(&broadcast.prepared);
    let jitter = match (antialiasing, with_lens) {
        (false, _) => [l.constant(0.5); 2],
        (true, false) => draw.pair,
        (true, true) => draw.jitter,
    };
    if with_lens {
        let lens_radius = draw.pair[0].sqrt();
        lens_ray(l, &broadcast.camera, screen, jitter, [lens_radius * cosine, lens_radius * sine])
    } else {
        pinhole_ray(l, &broadcast.camera, screen, jitter)
    }
}

/// How paths leave the surfaces that they have hit.
struct Bounced<L: Lanes> {
    /// The outgoing direction, not normalised.
    direction: V3<L::F>,
    is_metal: L::M,
    /// Whether the path continues outside the sphere.
    outward: L::M,
}

impl<L: Lanes> Bounced<L> {
    /// Stands for the bounces of lanes whose paths have all ended.
    #[inline(always)]
    fn nowhere(l: L) -> Self {
        let zero = l.constant(0.0);
        Bounced { direction: V3 { x: zero, y: zero, z: zero }, is_metal: l.mask(0), outward: l.mask(0) }
    }
}

/// Scatters at the hit.
#[inline(always)]
fn scatter_path<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
    collected: &Collected<L>,
    sine: L::F,
    cosine: L::F,
) -> Bounced<L> {
    let one = l.constant(1.0);
    let with_rules = PARTS & parts::RULES != 0;
    let features = &broadcast.prepared.features;
    let direction = packet.rays.direction;
    let Arrival { normal, outward_cosine, front, .. } = collected.arrival;
    let surface = if is_permuted::<L, PARTS>(&broadcast.prepared) {
        surface_of(&HitRecords::load::<PARTS>(l, broadcast, packet))
    } else {
        collected.surface
    };
    let [u0, _] = collected.draw.pair;
    let rho = (u0 * (one - u0)).sqrt();
    let rho = rho + rho;
    // The pole is vertical, like that of the sky and of the ground, which scatters most of the light. Evenly spaced
    // numbers then give evenly spaced heights.
    let unit = V3 { x: rho * cosine, y: one - (u0 + u0), z: rho * sine };
    let incidence = incidence_of(l, outward_cosine);
    let laws = if with_rules { features.dielectric_laws } else { DielectricLaws::Schlick };
    let mut bounced = if PARTS & parts::GLASS == 0 {
        scatter::<L, false>(l, &surface, laws, direction, normal, &incidence, front, unit, u0)
    } else if PARTS & parts::EXTREMES != 0 && features.steep_glass {
        scatter_steeply(l, laws, packet, &surface, normal, &incidence, front, unit, u0)
    } else {
        scatter::<L, true>(l, &surface, laws, direction, normal, &incidence, front, unit, u0)
    };
    if with_rules && features.hemisphere {
        let is_lambertian = l.constant(0.0).lt(surface.weight);
        bounced.direction = is_lambertian.select(hemisphere(l, normal, unit), bounced.direction);
    }
    Bounced { direction: bounced.direction, is_metal: bounced.is_metal, outward: front ^ bounced.refracts }
}

/// Scatters where the rounded cosine does not give the angle of incidence precisely enough. A ray inside glass
/// arrives at the same angle at which it started. The angle is stored, so that total reflection persists.
#[inline(always)]
fn scatter_steeply<L: Lanes>(
    l: L,
    laws: DielectricLaws,
    packet: &mut Packet<L>,
    surface: &Surface<L>,
    normal: V3<L::F>,
    incidence: &Incidence<L>,
    front: L::M,
    unit: V3<L::F>,
    coin: L::F,
) -> Scatter<L> {
    let direction = packet.rays.direction;
    let across = normal.mul_add(incidence.cosine, direction);
    let runs_own_chord = packet.rays.inside.eq(packet.nearest.sphere);
    let is_known = runs_own_chord & l.constant(0.0).lt(surface.refraction_index);
    let incidence = incidence_of_sine2(l, is_known.select(packet.sine2, across.dot(across)));
    let mut bounced = scatter::<L, true>(l, surface, laws, direction, normal, &incidence, front, unit, coin);
    let through = refracted(l, across, normal, bounced.ratio, incidence.sine2);
    bounced.direction = bounced.refracts.select(through, bounced.direction);
    let refracted_sine2 = bounced.ratio * bounced.ratio * incidence.sine2;
    packet.sine2 = bounced.refracts.select(refracted_sine2, incidence.sine2);
    bounced
}
