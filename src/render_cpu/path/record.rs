//! One path, ray by ray, traced by the packets' code.

use super::context::Context;
use super::intersect::intersect;
use super::packet::Packet;
use super::schedule::continue_paths;
use super::shade::Shaded;
use crate::film::PixelSum;
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::kernel::{NONE, Real, parts};
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::bvh::EMPTY_STACK;
use crate::render_cpu::lanes::{Lanes, Mask, V3, Wide, WideU};
use crate::render_cpu::work::{RefillBlock, RefillOrder, TileStats, Work};
use glam::DVec3;

/// Records sample `index` of a pixel with one lane.
#[inline(always)]
pub fn record<L: Lanes>(
    l: L,
    broadcast: &BroadcastScene<L::Real>,
    pixel: [u32; 2],
    index: u64,
) -> PathRecord {
    let (context, prepared) = (Context::<L, { parts::ALL }> { l, broadcast }, &broadcast.prepared);
    let blocks = RefillBlock::of_range(index..index + 1, &prepared.settings, 1);
    let mut sums = [PixelSum::default(); 2];
    let rows = sums.iter_mut().map(std::slice::from_mut).collect();
    let order = RefillOrder::new(1, 1);
    let mut work = Work::new(&blocks, &order, pixel, rows);
    let (mut packets, mut shaded) = ([Packet::idle(l)], [Shaded::nothing(l)]);
    let (mut stack, mut stats) = (EMPTY_STACK, TileStats::default());
    let in_scene = |position: V3<L::F>| (DVec3::from(vector::<L>(position)) + prepared.origin).to_array();
    let mut rays: Vec<RecordedRay> = Vec::new();
    loop {
        continue_paths(context, &mut packets, &mut shaded, &mut work, true, &mut stats);
        let packet = &mut packets[0];
        // The last step of an absorbed path would add nothing.
        if packet.busy == 0 || packet.absorbed.bits() != 0 {
            break;
        }
        if let Some(hit) = rays.last_mut().and_then(|ray| ray.hit.as_mut()) {
            hit.position = Some(in_scene(packet.rays.origin));
        }
        let origin = in_scene(packet.rays.origin);
        let [direction, throughput] = [packet.rays.direction, packet.throughput].map(vector::<L>);
        intersect(context, packet, &mut stack, &mut stats);
        let mut sphere = WideU::default();
        L::store_u(packet.nearest.sphere, &mut sphere);
        let hit = (sphere.0[0] != NONE).then(|| RecordedHit {
            sphere: prepared.scene_index[sphere.0[0] as usize] as usize,
            distance: number::<L>(packet.nearest.distance()),
            position: None,
        });
        rays.push(RecordedRay { origin, direction, throughput, hit });
    }
    let mut total = PixelSum::default();
    sums.iter().for_each(|sum| total.add(*sum));
    PathRecord { rays, radiance: total.radiance() }
}

#[inline(always)]
fn vector<L: Lanes>(v: V3<L::F>) -> [f64; 3] {
    [v.x, v.y, v.z].map(number::<L>)
}

#[inline(always)]
fn number<L: Lanes>(row: L::F) -> f64 {
    let mut buffer = Wide::default();
    L::store(row, &mut buffer);
    buffer.0[0].to_f64()
}
