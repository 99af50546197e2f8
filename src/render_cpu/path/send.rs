//! Continues paths: from the surface that was hit, or from the camera where a path has ended.

use super::draw::has_lens;
use super::{HitRecords, Packet, hit_point, pixel_position};
use crate::kernel::{EYE, LoadShading, NEAR_ZERO, parts};
use crate::prepared::PreparedScene;
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::camera::{CameraRays, lens_ray, pinhole_ray};
use crate::render_cpu::lanes::{Float, Lanes, Mask, Unsigned, V3, is_idle};
use crate::render_cpu::material::{
    Incidence, Scatter, Surface, hemisphere, incidence_of, incidence_of_sine2, refracted, scatter, surface_of,
};
use crate::render_cpu::sphere::Rays;
use crate::stages::{DielectricLaws, SurfaceRule};

/// Continues paths from their hits, and starts new ones at the camera where a path has ended.
#[inline(always)]
pub(super) fn send_on<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
) {
    let one = l.constant(1.0);
    let (hit, ended) = (packet.nearest.sphere, packet.ended);
    let bounced = if is_idle::<L>(!ended) {
        Bounced::nowhere(l)
    } else {
        scatter_path::<L, PARTS>(l, broadcast, packet)
    };
    let camera = if is_idle::<L>(ended) {
        CameraRays { origin: bounced.origin, direction: bounced.direction }
    } else {
        generate_camera_ray::<L, PARTS>(l, broadcast, packet)
    };
    let next = ended.select(camera.direction, bounced.direction);
    let next = normalised_or(l, next, bounced.normal);
    // Metal absorbs a fuzzy reflection that points into the surface.
    packet.absorbed = bounced.is_metal & !l.constant(0.0).lt(next.dot(bounced.normal)) & !ended;
    let mut left = l.fill(ended | bounced.inward, hit);
    if PARTS & parts::EXTREMES != 0 && broadcast.prepared.features.eye_on_surface {
        left = ended.select(l.splat_u(EYE), left);
    }
    packet.rays = Rays {
        origin: ended.select(camera.origin, bounced.origin),
        direction: next,
        left,
        inside: l.fill(ended | !bounced.inward, hit),
    };
    let throughput = packet.throughput.times(bounced.albedo);
    packet.throughput = ended.select(V3 { x: one, y: one, z: one }, throughput);
}

/// The direction of `v` with length 1, or `substitute` where `v` is too short to have a direction.
#[inline(always)]
fn normalised_or<L: Lanes>(l: L, v: V3<L::F>, substitute: V3<L::F>) -> V3<L::F> {
    let length2 = v.dot(v);
    let unit = v.scale(l.constant(1.0) / length2.sqrt());
    let vanishes = length2.lt(l.constant(NEAR_ZERO));
    // So rare that a jump costs less than a selection.
    if vanishes.bits() == 0 { unit } else { vanishes.select(substitute, unit) }
}

/// The camera rays of new paths.
#[inline(always)]
fn generate_camera_ray<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &Packet<L>,
) -> CameraRays<L> {
    let with_lens = has_lens::<L, PARTS>(&broadcast.prepared);
    let [u0, u1] = packet.draw.pair;
    let antialiasing = PARTS & parts::RULES == 0 || broadcast.prepared.features.antialiasing;
    let jitter = match (antialiasing, with_lens) {
        (false, _) => [l.constant(0.5); 2],
        (true, false) => [u0, u1],
        (true, true) => packet.draw.jitter,
    };
    if with_lens {
        let lens_radius = u0.sqrt();
        let on_lens = [lens_radius * packet.draw.cosine, lens_radius * packet.draw.sine];
        lens_ray(l, &broadcast.camera, packet.screen, jitter, on_lens)
    } else {
        pinhole_ray(l, &broadcast.camera, packet.screen, jitter)
    }
}

/// How paths leave the surfaces that they have hit.
struct Bounced<L: Lanes> {
    origin: V3<L::F>,
    /// The outgoing direction, not normalised.
    direction: V3<L::F>,
    /// Unit normal on the side that the ray came from.
    normal: V3<L::F>,
    /// The factor for the throughput.
    albedo: V3<L::F>,
    is_metal: L::M,
    /// Whether the path continues inside the sphere.
    inward: L::M,
}

impl<L: Lanes> Bounced<L> {
    /// What stands for the bounces of lanes whose paths have all ended.
    #[inline(always)]
    fn nowhere(l: L) -> Self {
        let zero = l.constant(0.0);
        let none = V3 { x: zero, y: zero, z: zero };
        Bounced {
            origin: none,
            direction: none,
            normal: none,
            albedo: none,
            is_metal: l.mask(0),
            inward: l.mask(0),
        }
    }
}

/// Scatters at the hit.
#[inline(always)]
fn scatter_path<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &mut Packet<L>,
) -> Bounced<L> {
    let (zero, one) = (l.constant(0.0), l.constant(1.0));
    let with_rules = PARTS & parts::RULES != 0;
    let (prepared, features) = (&broadcast.prepared, &broadcast.prepared.features);
    let (hit, direction) = (packet.nearest.sphere, packet.rays.direction);

    // What was hit, where, and from which side.
    let record = HitRecords::load::<PARTS>(l, broadcast, packet);
    let point = hit_point::<L, PARTS>(l, broadcast, packet, &record);
    let outward_cosine = direction.dot(point.outward);
    let mut front = outward_cosine.lt(zero);
    if !with_rules || features.surface == SurfaceRule::Exact {
        front = front & !packet.rays.inside.eq(hit);
    }
    if PARTS & parts::EXTREMES != 0 && features.cavity {
        front = front & !one.lt(record.anchoring());
    }
    let normal = point.outward.scale(front.select(one, l.constant(-1.0)));

    let [u0, _] = packet.draw.pair;
    let (sine, cosine) = (packet.draw.sine, packet.draw.cosine);
    let rho = (u0 * (one - u0)).sqrt();
    let rho = rho + rho;
    let unit = V3 { x: rho * cosine, y: one - (u0 + u0), z: rho * sine };

    let incidence = incidence_of(l, outward_cosine);
    let surface = surface_of(&record);
    let laws = if with_rules { features.dielectric_laws } else { DielectricLaws::Schlick };
    let mut bounced = if PARTS & parts::GLASS == 0 {
        scatter::<L, false>(l, &surface, laws, direction, normal, &incidence, front, unit, u0)
    } else if PARTS & parts::EXTREMES != 0 && features.steep_glass {
        scatter_steeply(l, laws, packet, &surface, normal, &incidence, front, unit)
    } else {
        scatter::<L, true>(l, &surface, laws, direction, normal, &incidence, front, unit, u0)
    };
    let mut albedo = record.albedo();
    if with_rules {
        if features.hemisphere {
            let is_lambertian = zero.lt(surface.weight);
            bounced.direction = is_lambertian.select(hemisphere(l, normal, unit), bounced.direction);
        }
        if features.reflectance_strips {
            let reflectance = strip_reflectance(l, prepared, packet.blocks.pixel);
            albedo = V3 { x: reflectance, y: reflectance, z: reflectance };
        }
    }
    let inward = (front & bounced.refracts) | !(front | bounced.refracts);
    let Scatter { direction, is_metal, .. } = bounced;
    Bounced { origin: point.position, direction, normal, albedo, is_metal, inward }
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
) -> Scatter<L> {
    let direction = packet.rays.direction;
    let across = normal.mul_add(incidence.cosine, direction);
    let runs_own_chord = packet.rays.inside.eq(packet.nearest.sphere);
    let is_known = runs_own_chord & l.constant(0.0).lt(surface.refraction_index);
    let incidence = incidence_of_sine2(l, is_known.select(packet.sine2, across.dot(across)));
    let coin = packet.draw.pair[0];
    let mut bounced = scatter::<L, true>(l, surface, laws, direction, normal, &incidence, front, unit, coin);
    let through = refracted(l, across, normal, bounced.ratio, incidence.sine2);
    bounced.direction = bounced.refracts.select(through, bounced.direction);
    let refracted_sine2 = bounced.ratio * bounced.ratio * incidence.sine2;
    packet.sine2 = bounced.refracts.select(refracted_sine2, incidence.sine2);
    bounced
}

/// The reflectance of the picture strip that contains a pixel: 10, 30, 50, 70 or 90 %.
#[inline(always)]
fn strip_reflectance<L: Lanes>(l: L, prepared: &PreparedScene<L::Real>, pixel: L::U) -> L::F {
    let [x, _] = pixel_position(l, pixel);
    let strips = l.constant(5.0 / f64::from(prepared.settings.width));
    let strip = (x + l.constant(0.5)) * strips - l.constant(0.5);
    let strip = L::float_of(l.fixed_point(l.constant(0.0).max(strip)));
    strip.mul_add(l.constant(0.2), l.constant(0.1))
}
