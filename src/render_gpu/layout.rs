//! Fills the device's records, which are declared in [`crate::kernel::records`].

use crate::kernel::{AnchoredSphere, UNIFORM_ANCHORED, UNIFORM_SPHERES};
pub use crate::kernel::{
    GpuAside, GpuBlock, GpuCounters, GpuCwbvhNode, GpuDispatch, GpuDispatchCounters, GpuJob, GpuPixelSum,
    WORKGROUP_SIZE,
};
use crate::prepared::PreparedScene;
use crate::prepared::cwbvh::CwBvhNode;
use crate::render::RenderSettings;

impl GpuJob {
    /// The parameters of a job whose hierarchy has `node_count` nodes.
    pub fn new(prepared: &PreparedScene<f32>, node_count: u32) -> Self {
        let RenderSettings { width, height, max_depth, seed, .. } = prepared.settings;
        let mut few_spheres = [[0.0; 4]; UNIFORM_SPHERES];
        for (to, from) in few_spheres.iter_mut().zip(prepared.opaque.iter().chain(&prepared.two_root)) {
            *to = *from;
        }
        let mut few_anchored = [AnchoredSphere::default(); UNIFORM_ANCHORED];
        for (to, from) in few_anchored.iter_mut().zip(&prepared.anchored) {
            *to = *from;
        }
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
            few_spheres,
            few_anchored,
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

impl From<&CwBvhNode> for GpuCwbvhNode {
    fn from(node: &CwBvhNode) -> Self {
        bytemuck::cast(*node)
    }
}
