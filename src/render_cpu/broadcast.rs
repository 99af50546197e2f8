//! A job's prepared scene as packets read it: values that every lane needs are broadcast in memory, so that an
//! instruction can use them as a memory operand.

use super::lanes::{MAX_LANES, Wide, WideU};
use super::sphere::BroadcastSphere;
use crate::kernel::{CameraTable, RECORD_COLUMNS, Real};
use crate::prepared::PreparedScene;

/// A prepared scene, with broadcast copies of the parts that are read in every step.
#[derive(Clone, Debug)]
pub struct BroadcastScene<R> {
    /// The prepared scene itself.
    pub prepared: PreparedScene<R>,
    /// `PreparedScene::opaque`, broadcast.
    pub opaque: Vec<BroadcastSphere<R>>,
    /// `PreparedScene::two_root`, broadcast; empty if a hierarchy holds these spheres.
    pub two_root: Vec<BroadcastSphere<R>>,
    /// `PreparedScene::camera`, broadcast.
    pub camera: CameraTable<Wide<R>>,
    /// `PreparedScene::sky_middle`, broadcast.
    pub sky_middle: [Wide<R>; 3],
    /// `PreparedScene::sky_slope`, broadcast.
    pub sky_slope: [Wide<R>; 3],
    /// The bounce at which a path's last ray starts.
    pub last_bounce: WideU,
    /// The first of `PreparedScene::records` by column, for kernels that hold a column in a register.
    pub columns: Box<[Wide<R>; RECORD_COLUMNS]>,
}

impl<R: Real> BroadcastScene<R> {
    /// Broadcasts the parts of `prepared` that every step reads.
    pub fn new(prepared: PreparedScene<R>) -> Self {
        let numbered = |spheres: &[[R; 4]], first: usize| {
            let broadcast =
                |(index, sphere): (usize, &[R; 4])| BroadcastSphere::new(*sphere, (first + index) as u32);
            spheres.iter().enumerate().map(broadcast).collect()
        };
        let listed = if prepared.hierarchy.is_some() { &[][..] } else { &prepared.two_root };
        let mut columns = Box::new([Wide::default(); RECORD_COLUMNS]);
        for (index, row) in prepared.records.iter().take(MAX_LANES).enumerate() {
            for (column, number) in columns.iter_mut().zip(row.0) {
                column.0[index] = number;
            }
        }
        BroadcastScene {
            last_bounce: Wide::splat(prepared.settings.max_depth - 1),
            opaque: numbered(&prepared.opaque, 0),
            two_root: numbered(listed, prepared.opaque.len()),
            camera: prepared.camera.map(Wide::splat),
            sky_middle: prepared.sky_middle.map(Wide::splat),
            sky_slope: prepared.sky_slope.map(Wide::splat),
            columns,
            prepared,
        }
    }
}
