//! The first phase: finds the nearest hits, and the points where they are.

use super::context::Context;
use super::packet::Packet;
use super::records::ShadingRecords;
use super::rules;
use crate::kernel::{LoadShading, parts};
use crate::render_cpu::bvh::{Stack, traverse};
use crate::render_cpu::lanes::{Lanes, Mask};
use crate::render_cpu::sphere::{
    Nearest, Rays, Spheres, SurfacePoint, anchored_root, anchored_surface_point, near_root, nearest_root,
    speck_surface_point, surface_point,
};
use crate::render_cpu::work::TileStats;

/// Finds the nearest hit of each ray in a packet.
#[inline(always)]
pub(super) fn intersect<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &mut Packet<L>,
    stack: &mut Stack,
    stats: &mut TileStats,
) {
    if packet.busy == 0 {
        return;
    }
    let active = packet.busy & !packet.absorbed.bits();
    stats.rays += u64::from(active.count_ones());
    let Context { l, broadcast } = context;
    let rays = &packet.rays;
    if let Some(nearest) = rules::book_nearest(context, rays) {
        packet.nearest = nearest;
        return;
    }
    let mut nearest = Nearest::nothing(l);
    for sphere in &broadcast.opaque {
        let sphere = Spheres::load(l, sphere);
        nearest.take(l, near_root(l, rays, &sphere), sphere.number);
    }
    // A list can be empty. Kernels without the part for it have no code to search it.
    match &broadcast.prepared.hierarchy {
        Some(hierarchy) if parts::include(PARTS, parts::HIERARCHY) => {
            // A hit of the ground rules out the boxes behind it.
            take_anchored(context, rays, &mut nearest);
            let spheres = &broadcast.prepared.two_root;
            traverse(l, hierarchy, spheres, rays, l.mask(active), stack, &mut nearest);
        }
        _ => {
            if parts::include(PARTS, parts::GLASS) {
                for sphere in &broadcast.two_root {
                    let sphere = Spheres::load(l, sphere);
                    nearest.take(l, nearest_root(l, rays, &sphere), sphere.number);
                }
            }
            take_anchored(context, rays, &mut nearest);
        }
    }
    packet.nearest = nearest;
}

/// Takes the hits of the anchored spheres, where they are nearer.
#[inline(always)]
fn take_anchored<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    rays: &Rays<L>,
    nearest: &mut Nearest<L>,
) {
    if !parts::include(PARTS, parts::EXTREMES) {
        return;
    }
    let (l, prepared) = (context.l, &context.broadcast.prepared);
    let one = l.splat_u(1);
    let mut number = l.splat_u((prepared.opaque.len() + prepared.two_root.len()) as u32);
    for sphere in &prepared.anchored {
        nearest.take(l, anchored_root(l, rays, sphere, number), number);
        number = number + one;
    }
}

/// The points of the hits; meaningless for lanes without one.
#[inline(always)]
pub(super) fn hit_point<L: Lanes, const PARTS: u32>(
    context: Context<L, PARTS>,
    packet: &Packet<L>,
    record: &ShadingRecords<L>,
) -> SurfacePoint<L> {
    let (l, features) = (context.l, context.features());
    let (rays, t) = (&packet.rays, packet.nearest.distance());
    if let Some(point) = rules::book_hit_point(context, rays, t, record) {
        return point;
    }
    let (reference, curvature, radius) = (record.reference(), record.curvature(), record.radius());
    let mut point = if features.specks() {
        speck_surface_point(l, rays, t, reference, curvature, radius)
    } else {
        surface_point(l, rays, t, reference, curvature, radius)
    };
    if features.anchored() {
        let far = anchored_surface_point(l, rays, t, reference, record.inward(), curvature);
        let is_anchored = record.is_anchored(l);
        point.position = is_anchored.select(far.position, point.position);
        point.outward = is_anchored.select(far.outward, point.outward);
    }
    point
}
