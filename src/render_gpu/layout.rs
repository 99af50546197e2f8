//! Fills the device's records, which are declared in [`crate::kernel::records`].

use crate::job::render::RenderSettings;
pub use crate::kernel::{
    GpuBlock, GpuCounters, GpuDispatch, GpuDispatchCounters, GpuJob, GpuSuspendedPath, WORKGROUP_SIZE,
};
use crate::prepared::PreparedScene;
use std::array::from_fn;

impl GpuJob {
    /// The parameters of a job whose hierarchy has `node_count` nodes.
    pub fn new(prepared: &PreparedScene<f32>, node_count: u32) -> Self {
        let RenderSettings { width, height, max_depth, seed, .. } = prepared.settings;
        let mut spheres = prepared.opaque.iter().chain(&prepared.two_root).copied();
        let mut anchored = prepared.anchored.iter().copied();
        GpuJob {
            camera: prepared.camera,
            sky_middle: prepared.sky_middle,
            extent: prepared.hierarchy.as_ref().map_or(0.0, |h| h.extent),
            sky_slope: prepared.sky_slope,
            max_depth,
            seed,
            opaque_count: prepared.opaque.len() as u32,
            two_root_count: prepared.two_root.len() as u32,
            anchored_count: prepared.anchored.len() as u32,
            width,
            height,
            tile_width: tile_size(width, height)[0],
            node_count,
            few_spheres: from_fn(|_| spheres.next().unwrap_or_default()),
            few_anchored: from_fn(|_| anchored.next().unwrap_or_default()),
        }
    }
}

/// Width and height of a workgroup's tile in pixels: square, unless the picture is too narrow or too low.
pub fn tile_size(width: u32, height: u32) -> [u32; 2] {
    let mut tile_width = 8;
    while tile_width < WORKGROUP_SIZE && height * tile_width <= WORKGROUP_SIZE / 2 {
        tile_width *= 2;
    }
    while tile_width > 1 && width <= tile_width / 2 {
        tile_width /= 2;
    }
    [tile_width, WORKGROUP_SIZE / tile_width]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_square_where_the_picture_has_room() {
        for (width, height, expected) in [
            (100, 100, [8, 8]),
            (4, 100, [4, 16]),
            (1, 100, [1, 64]),
            (100, 3, [16, 4]),
            (33, 1, [64, 1]),
            (32, 1, [32, 2]),
            (1, 1, [1, 64]),
        ] {
            assert_eq!(tile_size(width, height), expected, "{width}x{height}");
        }
    }
}
