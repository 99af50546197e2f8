//! What the host and the shaders share, byte for byte. Nothing else is here.
//!
//! Twin: shaders/bindings.wgsl. A test holds the offsets against the shaders' own.

use crate::render::RenderSettings;
use crate::tables::cwbvh::CwBvhNode;
use crate::tables::hierarchy;
use crate::tables::{AnchoredSphere, CameraTable, Row, Tables};
use bytemuck::{Pod, Zeroable};

/// Spheres that fit the uniform buffer: as long as there are no more, all threads read them from there.
pub const UNIFORM_SPHERES: usize = 32;

/// The same for anchored spheres.
pub const UNIFORM_ANCHORED: usize = 4;

/// Words in which a thread puts its path aside. Twin: shaders/aside.wgsl.
pub const ASIDE_STRIDE: u32 = 17;

/// The bits of [`GpuAnchoredSphere::flags`] that tell which roots count.
pub const ROOTS_MASK: u32 = 3;

/// The bit of [`GpuAnchoredSphere::flags`] that says that the eye is on the surface.
pub const UNDER_EYE: u32 = 4;

/// Threads of a workgroup.
pub const WORKGROUP_SIZE: u32 = 64;

/// Twin: `Camera` in camera.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuCamera {
    /// The eye.
    pub eye: [f32; 3],
    /// Tangent of half the defocus angle.
    pub tau: f32,
    /// Right.
    pub u: [f32; 3],
    /// Radius of the lens.
    pub focus_tau: f32,
    /// Up.
    pub v: [f32; 3],
    /// Width of a pixel on the plane at distance 1.
    pub scale_x: f32,
    /// Against the view.
    pub w: [f32; 3],
    /// Height of a pixel, negative.
    pub scale_y: f32,
    /// The picture's left and upper edge.
    pub offset: [f32; 2],
    /// Pixels across and down.
    pub size: [f32; 2],
}

impl GpuCamera {
    /// The camera of a picture of `width` by `height` pixels.
    pub fn new(camera: &CameraTable<f32>, width: u32, height: u32) -> Self {
        GpuCamera {
            eye: camera.eye,
            tau: camera.tau,
            u: camera.u,
            focus_tau: camera.focus_tau,
            v: camera.v,
            scale_x: camera.scale[0],
            w: camera.w,
            scale_y: camera.scale[1],
            offset: camera.offset,
            size: [width as f32, height as f32],
        }
    }
}

/// Twin: `AnchoredSphere` in sphere.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuAnchoredSphere {
    /// A point of the surface.
    pub anchor: [f32; 3],
    /// 1 / radius.
    pub curvature: f32,
    /// Unit vector from the anchor to the centre.
    pub inward: [f32; 3],
    /// Which roots count, and [`UNDER_EYE`].
    pub flags: u32,
}

impl From<&AnchoredSphere<f32>> for GpuAnchoredSphere {
    fn from(sphere: &AnchoredSphere<f32>) -> Self {
        GpuAnchoredSphere {
            anchor: sphere.anchor,
            curvature: sphere.curvature,
            inward: sphere.inward,
            flags: sphere.roots as u32 | if sphere.under_eye { UNDER_EYE } else { 0 },
        }
    }
}

/// Twin: `Job` in bindings.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuJob {
    /// The camera.
    pub camera: GpuCamera,
    /// Sky radiance at the horizon times `2^24`.
    pub sky_middle: [f32; 3],
    /// Largest coordinate of any box.
    pub extent: f32,
    /// Growth of the sky radiance with the direction's y, times `2^24`.
    pub sky_slope: [f32; 3],
    /// Most rays of a path.
    pub max_depth: u32,
    /// The sampler's seed.
    pub seed: u32,
    /// Spheres of one root.
    pub opaque_count: u32,
    /// Spheres of two.
    pub two_root_count: u32,
    /// Spheres that are seen from a point on their surface.
    pub anchored_count: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Pixels across a workgroup's tile.
    pub tile_width: u32,
    /// Nodes of the hierarchy.
    pub node_count: u32,
    /// The spheres, where they are few.
    pub few_spheres: [[f32; 4]; UNIFORM_SPHERES],
    /// The anchored spheres, where they are few.
    pub few_anchored: [GpuAnchoredSphere; UNIFORM_ANCHORED],
}

impl GpuJob {
    /// What the shaders know of a job whose hierarchy has `node_count` nodes.
    pub fn new(tables: &Tables<f32>, node_count: u32) -> Self {
        let RenderSettings { width, height, max_depth, seed, .. } = tables.settings;
        let mut few_spheres = [[0.0; 4]; UNIFORM_SPHERES];
        for (to, from) in few_spheres.iter_mut().zip(tables.opaque.iter().chain(&tables.two_root)) {
            *to = *from;
        }
        let mut few_anchored = [GpuAnchoredSphere::zeroed(); UNIFORM_ANCHORED];
        for (to, from) in few_anchored.iter_mut().zip(&tables.anchored) {
            *to = from.into();
        }
        GpuJob {
            camera: GpuCamera::new(&tables.camera, width, height),
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

/// Twin: `Dispatch` in bindings.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct GpuDispatch {
    /// First tile of the film.
    pub first_tile: u32,
    /// Tiles.
    pub tile_count: u32,
    /// Blocks of samples.
    pub block_count: u32,
    /// Turns of its loops after which a thread puts its path aside.
    pub turn_limit: u32,
    /// First row of the picture that the film buffer holds.
    pub first_row: u32,
    /// Rows that it holds.
    pub row_count: u32,
    /// For resolve: samples in the film.
    pub sample_count: u32,
    /// For resolve: a `TRANSFER_` tag.
    pub transfer: u32,
    /// 1 where threads go on with what they put aside, 0 where they begin.
    pub resumes: u32,
    /// The first of the words in which paths are put aside.
    pub first_aside: u32,
}

/// Twin: `Block` in bindings.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct GpuBlock {
    /// Half of the film.
    pub half: u32,
    /// The sampler's counter of the first sample.
    pub counter: u32,
    /// What it grows by.
    pub step: u32,
    /// Samples.
    pub count: u32,
}

/// Twin: `Row` in bindings.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuRow {
    /// Centre, or anchor.
    pub reference: [f32; 3],
    /// 1 / radius.
    pub curvature: f32,
    /// Reflected share.
    pub albedo: [f32; 3],
    /// Of the unit vector; with a minus sign where the direction is a reflection.
    pub weight: f32,
    /// Radius.
    pub radius: f32,
    /// Refraction index; 0 if not glass.
    pub index: f32,
    /// 1 / refraction index.
    pub inverse_index: f32,
    /// Schlick's share at normal incidence.
    pub normal_share: f32,
    /// From the anchor to the centre.
    pub inward: [f32; 3],
    /// 1 if anchored, 2 if every ray is inside.
    pub is_anchored: f32,
}

impl From<&Row<f32>> for GpuRow {
    fn from(row: &Row<f32>) -> Self {
        bytemuck::cast(row.0)
    }
}

/// Twin: `Node` in bvh.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuNode {
    /// Lowest corner.
    pub low: [f32; 3],
    /// First sphere, or the first of two children.
    pub first: u32,
    /// Highest corner.
    pub high: [f32; 3],
    /// Spheres of a leaf.
    pub count: u32,
}

impl From<&hierarchy::Node<f32>> for GpuNode {
    fn from(node: &hierarchy::Node<f32>) -> Self {
        GpuNode {
            low: node.min,
            first: node.first,
            high: node.max,
            count: node.count & hierarchy::COUNT_MASK,
        }
    }
}

/// Twin: `CwbvhNode` in cwbvh.wgsl; the bytes of obvhs' node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct GpuCwbvhNode {
    /// Lowest corner.
    pub low: [f32; 3],
    /// Exponents of the unit by axis, and which children are nodes.
    pub units: u32,
    /// First child that is a node.
    pub first_child: u32,
    /// First sphere.
    pub first_sphere: u32,
    /// What each child adds to a mask of hits.
    pub marks: [u32; 2],
    /// Bounds along x.
    pub x: [u32; 4],
    /// Along y.
    pub y: [u32; 4],
    /// Along z.
    pub z: [u32; 4],
}

impl From<&CwBvhNode> for GpuCwbvhNode {
    fn from(node: &CwBvhNode) -> Self {
        bytemuck::cast(*node)
    }
}

/// Twin: `PixelSum` in bindings.wgsl; the bytes of a [`crate::film::PixelSum`].
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct GpuPixelSum {
    /// Low and high word.
    pub red: [u32; 2],
    /// Low and high word.
    pub green: [u32; 2],
    /// Low and high word.
    pub blue: [u32; 2],
}

/// Twin: `Counters` in bindings.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub struct GpuCounters {
    /// Rays traced, low word.
    pub rays: u32,
    /// High word.
    pub rays_high: u32,
    /// Samples left out, low word.
    pub rejected: u32,
    /// High word.
    pub rejected_high: u32,
    /// What one dispatch counted.
    pub dispatch: GpuDispatchCounters,
}

/// The counters of one dispatch alone: the last four of `Counters` in bindings.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct GpuDispatchCounters {
    /// Samples whose sums are in the film, low word.
    pub finished: u32,
    /// High word.
    pub finished_high: u32,
    /// Threads that have put a path aside.
    pub unfinished: u32,
    /// Those of them that could not trace one ray to its end.
    pub stuck: u32,
}
