//! The third phase: spawns the next rays, from the surface that was hit, or from the camera where a path has ended.

use super::context::Context;
use super::draw::{Drawn, has_lens};
use super::packet::{Packet, is_small};
use super::records::{ShadingRecords, is_permuted};
use super::rules::diffuse_direction;
use super::shade::{Shaded, SurfaceInteraction};
use crate::kernel::{EYE, NEAR_ZERO, NONE, parts};
use crate::render_cpu::camera::{CameraRays, lens_ray, pinhole_ray};
use crate::render_cpu::lanes::{Float, Lanes, Mask, Unsigned, V3, is_idle, is_wide};
use crate::render_cpu::material::{
    Incidence, Material, Scattered, incidence_of, incidence_of_sine2, material_of, refracted, scatter,
};
use crate::render_cpu::sphere::Rays;
use crate::stages::DielectricLaws;

/// Spawns the next ray of each lane.
#[inline(always)]
pub(super) fn spawn_ray<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &mut Packet<L>,
    shaded: &Shaded<L>,
) {
    let l = context.l;
    let &Shaded { ended, drawn, interaction, .. } = shaded;

    // Both kinds of rays share the sine and cosine. A ray from a pinhole needs neither, so any numbers do.
    let [u0, u1] = drawn.pair;
    let is_pinhole = is_idle::<L>(!ended) && is_small::<L, PARTS>() && !has_lens(context);
    let sine_cosine = if is_pinhole { (u0, u0) } else { l.sin_cos_turns(u1) };

    // Scatter where paths continue, and start at the camera where they have ended.
    let (scattered, continues_outside) = if is_idle::<L>(!ended) {
        (Scattered::unused(l), l.mask(0))
    } else {
        let scattered = scatter_path(context, packet, shaded, sine_cosine);
        let continues_outside = interaction.front_face ^ scattered.refracts;
        (scattered, continues_outside)
    };
    let camera = if is_idle::<L>(ended) {
        // Equal alternatives make the selections below disappear.
        CameraRays { origin: interaction.position, direction: scattered.direction }
    } else {
        generate_camera_ray(context, packet.corner, &drawn, sine_cosine)
    };
    let direction = ended.select(camera.direction, scattered.direction);
    let (direction, length2) = with_length2_or(l, direction, interaction.normal);

    // Metal absorbs a fuzzy reflection that points into the surface.
    let absorbed = scattered.is_metal & !l.constant(0.0).lt(direction.dot(interaction.normal)) & !ended;
    packet.absorbed = if is_wide::<L>() { absorbed | shaded.waiting } else { absorbed };

    // Remember the sphere that a ray leaves or is inside of.
    let none = l.splat_u(NONE);
    let hit = l.fill(ended, packet.nearest.sphere);
    let mut left = continues_outside.select(hit, none);
    if context.features().eye_on_surface() {
        left = ended.select(l.splat_u(EYE), left);
    }
    packet.rays = Rays {
        origin: ended.select(camera.origin, interaction.position),
        direction: direction.scale(l.constant(1.0) / length2.sqrt()),
        left,
        inside: continues_outside.select(none, hit),
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
    context: Context<L, PARTS>,
    corner: [L::F; 2],
    drawn: &Drawn<L>,
    (sine, cosine): (L::F, L::F),
) -> CameraRays<L> {
    let (l, camera, with_lens) = (context.l, &context.broadcast.camera, has_lens(context));
    let jitter = match (context.features().antialiasing(), with_lens) {
        (false, _) => [l.constant(0.5); 2],
        (true, false) => drawn.pair,
        (true, true) => drawn.jitter,
    };
    if !with_lens {
        return pinhole_ray(l, camera, corner, jitter);
    }
    let radius = drawn.pair[0].sqrt();
    lens_ray(l, camera, corner, jitter, [radius * cosine, radius * sine])
}

/// Scatters paths at the surfaces that they have hit.
#[inline(always)]
fn scatter_path<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &mut Packet<L>,
    shaded: &Shaded<L>,
    (sine, cosine): (L::F, L::F),
) -> Scattered<L> {
    let (l, features) = (context.l, context.features());
    let one = l.constant(1.0);
    let direction = packet.rays.direction;
    let SurfaceInteraction { normal, outward_cosine, front_face, .. } = shaded.interaction;
    let material = if is_permuted(context) {
        material_of(&ShadingRecords::load(context, packet))
    } else {
        shaded.material
    };

    // A uniform unit vector. Its pole is vertical, like that of the sky and of the ground, which scatters most of the
    // light. Evenly spaced numbers then give evenly spaced heights.
    let [u0, _] = shaded.drawn.pair;
    let rho = (u0 * (one - u0)).sqrt();
    let rho = rho + rho;
    let unit = V3 { x: rho * cosine, y: one - (u0 + u0), z: rho * sine };

    let incidence = incidence_of(l, outward_cosine);
    let laws = features.dielectric_laws();
    let mut scattered = if PARTS & parts::GLASS == 0 {
        scatter::<L, false>(l, &material, laws, direction, normal, &incidence, front_face, unit, u0)
    } else if features.steep_glass() {
        scatter_steeply(l, laws, packet, &material, normal, &incidence, front_face, unit, u0)
    } else {
        scatter::<L, true>(l, &material, laws, direction, normal, &incidence, front_face, unit, u0)
    };
    scattered.direction = diffuse_direction(context, &material, scattered.direction, normal, unit);
    scattered
}

/// Scatters where the rounded cosine does not give the angle of incidence precisely enough. A ray inside glass
/// arrives at the same angle at which it started. The angle is stored, so that total reflection persists.
#[inline(always)]
fn scatter_steeply<L: Lanes>(
    l: L,
    laws: DielectricLaws,
    packet: &mut Packet<L>,
    material: &Material<L>,
    normal: V3<L::F>,
    incidence: &Incidence<L>,
    front_face: L::M,
    unit: V3<L::F>,
    coin: L::F,
) -> Scattered<L> {
    let direction = packet.rays.direction;
    let across = normal.mul_add(incidence.cosine, direction);
    let runs_own_chord = packet.rays.inside.eq(packet.nearest.sphere);
    let is_known = runs_own_chord & material.is_glass(l);
    let incidence = incidence_of_sine2(l, is_known.select(packet.sine2, across.dot(across)));
    let mut scattered =
        scatter::<L, true>(l, material, laws, direction, normal, &incidence, front_face, unit, coin);
    let through = refracted(l, across, normal, scattered.ratio, incidence.sine2);
    scattered.direction = scattered.refracts.select(through, scattered.direction);
    let refracted_sine2 = scattered.ratio * scattered.ratio * incidence.sine2;
    packet.sine2 = scattered.refracts.select(refracted_sine2, incidence.sine2);
    scattered
}
