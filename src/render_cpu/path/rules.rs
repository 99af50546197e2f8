//! The rules of the stages: what early pictures of the book show in place of the finished renderer. Kernels without the
//! part `RULES` contain none of this code.
//!
//! Twin: shaders/rules.wgsl

use super::context::Context;
use super::packet::{Packet, pixel_position};
use super::records::ShadingRecords;
use crate::film::FIXED_POINT_SCALE;
use crate::job::render::RenderSettings;
use crate::kernel::LoadShading;
use crate::render_cpu::lanes::{Float, Lanes, Mask, V3};
use crate::render_cpu::material::{Material, hemisphere};
use crate::render_cpu::sphere::{Nearest, Rays, Spheres, SurfacePoint, book_point, book_root};
use crate::stages::{Shading, SurfaceRule};

/// The nearest hits by the book's own quadratic, if the stage uses it.
#[inline(always)]
pub(super) fn book_nearest<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    rays: &Rays<L>,
) -> Option<Nearest<L>> {
    let Context { l, broadcast } = context;
    let t_min = l.constant(context.features().surface().smallest_distance()?);
    let mut nearest = Nearest::nothing(l);
    for sphere in broadcast.opaque.iter().chain(&broadcast.two_root) {
        let sphere = Spheres::load(l, sphere);
        nearest.take(l, book_root(l, rays, &sphere, t_min), sphere.number);
    }
    Some(nearest)
}

/// The hit points by the book's own arithmetic, if the stage uses it.
#[inline(always)]
pub(super) fn book_hit_point<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    rays: &Rays<L>,
    t: L::F,
    record: &ShadingRecords<L>,
) -> Option<SurfacePoint<L>> {
    let is_exact = context.features().surface() == SurfaceRule::Exact;
    (!is_exact).then(|| book_point(rays, t, record.reference(), record.curvature()))
}

/// The colour that a stage shows in place of light, in units of the film: `sky` where the ray misses. `None` for stages
/// with light. `outward` finds the outward normals.
#[inline(always)]
pub(super) fn shown_colour<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &Packet<L>,
    miss: L::M,
    sky: V3<L::F>,
    outward: impl FnOnce() -> V3<L::F>,
) -> Option<V3<L::F>> {
    let l = context.l;
    let (zero, full) = (l.constant(0.0), l.constant(FIXED_POINT_SCALE));
    let shown = match context.features().shading() {
        Shading::Path => return None,
        Shading::ImageGradient => {
            let position = pixel_position(l, packet.blocks.pixel);
            // A single column or row has no far end, so its share is 0.
            let share = |position: L::F, pixels: u32| {
                position / l.constant(f64::from(pixels.saturating_sub(1).max(1))) * full
            };
            let RenderSettings { width, height, .. } = context.broadcast.prepared.settings;
            return Some(V3 { x: share(position[0], width), y: share(position[1], height), z: zero });
        }
        Shading::FirstHitRed => V3 { x: full, y: zero, z: zero },
        Shading::Normals => {
            let half = l.constant(0.5 * FIXED_POINT_SCALE);
            let shade = |n: L::F| zero.max(n.mul_add(half, half));
            let outward = outward();
            V3 { x: shade(outward.x), y: shade(outward.y), z: shade(outward.z) }
        }
    };
    Some(miss.select(sky, shown))
}

/// The reflectance of the picture strip that contains a pixel: 10, 30, 50, 70 or 90 %.
#[inline(always)]
pub(super) fn strip_reflectance<L: Lanes>(l: L, width: u32, pixel: L::U) -> L::F {
    let [x, _] = pixel_position(l, pixel);
    let strips = l.constant(5.0 / f64::from(width));
    let strip = (x + l.constant(0.5)) * strips - l.constant(0.5);
    let strip = L::float_of(l.fixed_point(l.constant(0.0).max(strip)));
    strip.mul_add(l.constant(0.2), l.constant(0.1))
}

/// The scattered direction, or one in the hemisphere of the normal where a Lambertian surface scatters so.
#[inline(always)]
pub(super) fn diffuse_direction<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    material: &Material<L>,
    scattered: V3<L::F>,
    normal: V3<L::F>,
    unit: V3<L::F>,
) -> V3<L::F> {
    let l = context.l;
    if !context.features().hemisphere() {
        return scattered;
    }
    material.is_lambertian(l).select(hemisphere(l, normal, unit), scattered)
}
