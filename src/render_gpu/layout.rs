//! How the device's records are filled. They are declared in [`crate::kernel::records`].

pub use crate::kernel::{
    ASIDE_STRIDE, GpuBlock, GpuCounters, GpuCwbvhNode, GpuDispatch, GpuDispatchCounters, GpuJob, GpuPixelSum,
    WORKGROUP_SIZE,
};
use crate::kernel::{AnchoredSphere, UNIFORM_ANCHORED, UNIFORM_SPHERES};
use crate::render::RenderSettings;
use crate::tables::Tables;
use crate::tables::cwbvh::CwBvhNode;

impl GpuJob {
    /// What the shaders know of a job whose hierarchy has `node_count` nodes.
    pub fn new(tables: &Tables<f32>, node_count: u32) -> Self {
        let RenderSettings { width, height, max_depth, seed, .. } = tables.settings;
        let mut few_spheres = [[0.0; 4]; UNIFORM_SPHERES];
        for (to, from) in few_spheres.iter_mut().zip(tables.opaque.iter().chain(&tables.two_root)) {
            *to = *from;
        }
        let mut few_anchored = [AnchoredSphere::default(); UNIFORM_ANCHORED];
        for (to, from) in few_anchored.iter_mut().zip(&tables.anchored) {
            *to = *from;
        }
        GpuJob {
            camera: tables.camera,
            sky_middle: tables.sky_middle,
            extent: tables.hierarchy.as_ref().map_or(0.0, |h| h.extent),
            sky_slope: tables.sky_slope,
            max_depth,
            seed,
            opaque_count: tables.opaque.len() as u32,
            two_root_count: tables.two_root.len() as u32,
            anchored_count: tables.anchored.len() as u32,
            width,
            height,
            tile_width: tile_size(width, height)[0],
            node_count,
            few_spheres,
            few_anchored,
        }
    }
}

/// Pixels across and down that a workgroup has: square, unless the picture is too narrow or low for that.
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
