//! Where rays meet the surfaces that they have hit.

use super::records::HitRecords;
use super::{Packet, hit_point, pixel_position};
use crate::kernel::{LoadShading, parts};
use crate::prepared::PreparedScene;
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::lanes::{Float, Lanes, Unsigned, V3};
use crate::stages::SurfaceRule;

/// What was hit, where, and from which side; meaningless for lanes without a hit.
#[derive(Clone, Copy)]
pub(super) struct Arrival<L: Lanes> {
    /// The hit point.
    pub position: V3<L::F>,
    /// Unit normal on the side that the ray came from.
    pub normal: V3<L::F>,
    /// Cosine between the ray's direction and the outward normal.
    pub outward_cosine: L::F,
    /// Whether the ray came from outside.
    pub front: L::M,
}

/// Finds where and from which side the rays meet what they have hit.
#[inline(always)]
pub(super) fn arrive<L: Lanes, const PARTS: u32>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    packet: &Packet<L>,
    record: &HitRecords<L>,
) -> Arrival<L> {
    let features = &broadcast.prepared.features;
    let point = hit_point::<L, PARTS>(l, broadcast, packet, record);
    let outward_cosine = packet.rays.direction.dot(point.outward);
    let mut front = outward_cosine.lt(l.constant(0.0));
    if PARTS & parts::RULES == 0 || features.surface == SurfaceRule::Exact {
        front = front & !packet.rays.inside.eq(packet.nearest.sphere);
    }
    if PARTS & parts::EXTREMES != 0 && features.cavity {
        front = front & !l.constant(1.0).lt(record.anchoring());
    }
    let normal = point.outward.negate_where(l, !front);
    Arrival { position: point.position, normal, outward_cosine, front }
}

/// The reflectance of what was hit.
#[inline(always)]
pub(super) fn albedo_of<L: Lanes, const PARTS: u32>(
    l: L,
    prepared: &PreparedScene<L::Real>,
    record: &HitRecords<L>,
    pixel: L::U,
) -> V3<L::F> {
    if PARTS & parts::RULES != 0 && prepared.features.reflectance_strips {
        let reflectance = strip_reflectance(l, prepared, pixel);
        return V3 { x: reflectance, y: reflectance, z: reflectance };
    }
    record.albedo()
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
