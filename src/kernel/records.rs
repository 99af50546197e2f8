//! The records that a prepared scene holds and shaders read.
//!
//! Rust lays out a struct without gaps if each `vec3f` and `vec4f` begins at a multiple of 16 bytes, as WGSL requires.
//! A test compares the two layouts.

use super::record::{Columns, Field, Record, Shape, Shared, column_of, last, loads, record, single};
use super::{COUNT_MASK, ORDER_SHIFT, Real, Roots, UNDER_EYE, UNIFORM_ANCHORED, UNIFORM_SPHERES};
use bytemuck::{Pod, Zeroable};

record! {
    /// The data of a sphere for shading.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct ShadingRecord<R> as "ShadingRecord", loaded by LoadShading {
        /// Centre, or anchor of an anchored sphere.
        pub reference: [R; 3],
        /// 1 / radius.
        pub curvature: R,
        /// Reflectance, linear RGB.
        pub albedo: [R; 3],
        /// Radius of the sphere.
        pub radius: R,
        /// Weight of the random unit vector in the scattered direction; a negative sign (also on 0) marks a reflection.
        pub weight: R,
        /// Refraction index; 0 if not glass.
        pub refraction_index: R,
        /// 1 / refraction index; 0 if not glass.
        pub inverse_index: R,
        /// Schlick's reflectance at normal incidence.
        pub f0: R,
        /// Unit vector from the anchor to the centre; 0 if not anchored.
        pub inward: [R; 3],
        /// 0 if not anchored, 1 if anchored, 2 for a cavity: an anchored sphere that every ray is inside of.
        pub anchoring: R,
    }
}

/// Number of columns in a [`ShadingRecord`].
pub const SHADING_COLUMNS: usize = size_of::<ShadingRecord<f32>>() / size_of::<f32>();

/// The number of columns rounded up to whole groups of [`GROUP`]: the stride of a record.
pub const RECORD_COLUMNS: usize = SHADING_COLUMNS.next_multiple_of(GROUP);

/// Number of columns that are gathered at once.
pub const GROUP: usize = 4;

/// The group of columns that only anchored spheres need.
pub const ANCHORED_GROUP: usize = column_of!(ShadingRecord, inward) / GROUP;

const _: () = assert!(column_of!(ShadingRecord, inward) % GROUP == 0);
const _: () = assert!(column_of!(ShadingRecord, anchoring) / GROUP == ANCHORED_GROUP);

/// A [`ShadingRecord`] as numbers, gathered by column. In `f32` it is aligned to a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RecordColumns<R>(pub [R; RECORD_COLUMNS]);

impl<R: Real> Default for RecordColumns<R> {
    fn default() -> Self {
        RecordColumns([R::default(); RECORD_COLUMNS])
    }
}

impl<R: Real> From<ShadingRecord<R>> for RecordColumns<R> {
    fn from(record: ShadingRecord<R>) -> Self {
        let mut row = RecordColumns::default();
        record.store(&mut row.0);
        row
    }
}

impl<R: Real> Columns<R> for RecordColumns<R> {
    type Number = R;
    type Vector = [R; 3];

    fn number(&self, column: usize) -> R {
        self.0[column]
    }

    fn vector(&self, column: usize) -> [R; 3] {
        [0, 1, 2].map(|axis| self.0[column + axis])
    }
}

record! {
    /// A sphere described relative to a point on its surface.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct AnchoredSphere<R> as "AnchoredSphere" {
        /// The anchor: a point on the surface near the region of interest.
        pub anchor: [R; 3],
        /// 1 / radius.
        pub curvature: R,
        /// Unit vector from the anchor to the centre.
        pub inward: [R; 3],
        /// A `ROOTS_` tag, plus `UNDER_EYE` if the eye is on the surface, on its outer side: rays that start there and
        /// point outwards leave the sphere; the others meet it where they start.
        pub flags: u32,
    }
}

impl<R> AnchoredSphere<R> {
    /// Which roots count.
    #[inline(always)]
    pub fn roots(&self) -> Roots {
        Roots::of_flags(self.flags)
    }

    /// Whether the eye is on the surface.
    #[inline(always)]
    pub fn is_under_eye(&self) -> bool {
        self.flags & UNDER_EYE != 0
    }
}

record! {
    /// The camera in a form that gives a ray with a few multiplications and no differences between distant points.
    ///
    /// A pixel position `p`, which includes the offset in the pixel, maps to `s = p scale + offset` on the plane at
    /// distance 1. With a point `xi` of the unit disk for the lens, the ray has the direction
    /// `(s.x - tau xi.x) u + (s.y - tau xi.y) v - w` and the origin `eye + lens_radius (xi.x u + xi.y v)`.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct CameraTable<R> as "Camera" {
        /// Position of the eye.
        pub eye: [R; 3],
        /// Tangent of half the defocus angle; 0 for a pinhole.
        pub tau: R,
        /// Unit vector to the right.
        pub u: [R; 3],
        /// Radius of the lens.
        pub lens_radius: R,
        /// Unit vector upwards.
        pub v: [R; 3],
        /// Width of a pixel on the plane at distance 1.
        pub scale_x: R,
        /// Unit vector backwards, against the viewing direction.
        pub w: [R; 3],
        /// Height of a pixel on that plane, negative.
        pub scale_y: R,
        /// Left and upper edge of the picture on that plane.
        pub offset: [R; 2],
        /// Picture size in pixels: width and height.
        pub size: [R; 2],
    }
}

impl<R: Copy> CameraTable<R> {
    /// Applies `f` to every number.
    pub fn map<T>(&self, f: impl Fn(R) -> T) -> CameraTable<T> {
        CameraTable {
            eye: self.eye.map(&f),
            tau: f(self.tau),
            u: self.u.map(&f),
            lens_radius: f(self.lens_radius),
            v: self.v.map(&f),
            scale_x: f(self.scale_x),
            w: self.w.map(&f),
            scale_y: f(self.scale_y),
            offset: self.offset.map(&f),
            size: self.size.map(&f),
        }
    }
}

/// A node of the CPU's hierarchy: a box and its contents.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Node<R> {
    /// Lowest corner of the box.
    pub low: [R; 3],
    /// First sphere of a leaf, or first of two adjacent children.
    pub first: u32,
    /// Highest corner of the box.
    pub high: [R; 3],
    /// For a leaf, the number of spheres in the bits of `COUNT_MASK`. For an inner node these bits are 0; bits 30 and 31
    /// hold the axis that separates the children, and bit 29 is set if the second child comes before the first.
    pub count: u32,
}

impl<R> Node<R> {
    /// Number of spheres in a leaf; 0 for an inner node.
    #[inline(always)]
    pub fn sphere_count(&self) -> u32 {
        self.count & COUNT_MASK
    }

    /// The child that comes first, 0 or 1. `near_children` has a bit for each order of children that a node can have.
    #[inline(always)]
    pub fn nearer_child(&self, near_children: u32) -> u32 {
        let order = self.count >> ORDER_SHIFT;
        (near_children >> order) & 1
    }
}

record! {
    /// The parameters of a job, the same for all its dispatches.
    #[derive(Clone, Copy, Debug)]
    pub struct GpuJob as "Job" {
        /// The camera in single precision.
        pub camera: CameraTable<f32>,
        /// Sky radiance at the horizon, in units of the film.
        pub sky_middle: [f32; 3],
        /// Largest absolute coordinate of any box of the hierarchy.
        pub extent: f32,
        /// Growth of the sky radiance with the direction's y, in units of the film.
        pub sky_slope: [f32; 3],
        /// Maximum number of rays per path.
        pub max_depth: u32,
        /// Seed of the sampler.
        pub seed: u32,
        /// Number of spheres with one root.
        pub opaque_count: u32,
        /// Number of spheres with two roots.
        pub two_root_count: u32,
        /// Number of anchored spheres.
        pub anchored_count: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// Width of a workgroup's tile in pixels.
        pub tile_width: u32,
        /// Number of nodes in the hierarchy; a traversal visits each at most once.
        pub node_count: u32,
        /// The spheres, if there are few: all threads read the same one at a time, which suits constant memory.
        pub few_spheres: [[f32; 4]; UNIFORM_SPHERES],
        /// The anchored spheres, if there are few.
        pub few_anchored: [AnchoredSphere<f32>; UNIFORM_ANCHORED],
    }
}

record! {
    /// The parameters of one dispatch.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuDispatch as "Dispatch" {
        /// First tile of the film.
        pub first_tile: u32,
        /// Number of tiles.
        pub tile_count: u32,
        /// Number of blocks of samples.
        pub block_count: u32,
        /// Loop iterations after which a thread suspends its path.
        pub iteration_limit: u32,
        /// First picture row in the film buffer.
        pub first_row: u32,
        /// Number of rows in the film buffer.
        pub row_count: u32,
        /// For resolve: number of samples in the film.
        pub sample_count: u32,
        /// For resolve: a `TRANSFER_` tag.
        pub transfer: u32,
        /// 1 if threads resume suspended paths, 0 if they start new ones.
        pub resumes: u32,
        /// First scratch word for suspended paths.
        pub first_suspended: u32,
    }
}

record! {
    /// A block of samples in one half of the film.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
    pub struct GpuBlock as "Block" {
        /// Index of the half.
        pub half: u32,
        /// The sampler's counter for the first sample.
        pub counter: u32,
        /// Increment of the counter per sample.
        pub step: u32,
        /// Number of samples.
        pub count: u32,
    }
}

record! {
    /// Counters since the last readback of the film.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuCounters as "Counters" {
        /// Rays traced, low word.
        pub rays: u32 as "atomic<u32>",
        /// Rays traced, high word.
        pub rays_high: u32 as "atomic<u32>",
        /// Samples rejected, low word.
        pub rejected: u32 as "atomic<u32>",
        /// Samples rejected, high word.
        pub rejected_high: u32 as "atomic<u32>",
        /// Counters of the current dispatch.
        pub dispatch: GpuDispatchCounters,
    }
}

record! {
    /// Counters of a single dispatch.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
    pub struct GpuDispatchCounters as "DispatchCounters" {
        /// Samples whose sums are in the film, low word.
        pub finished: u32 as "atomic<u32>",
        /// Samples whose sums are in the film, high word.
        pub finished_high: u32 as "atomic<u32>",
        /// Threads that have suspended a path.
        pub unfinished: u32 as "atomic<u32>",
        /// Threads among them that could not trace a single ray to its end.
        pub stuck: u32 as "atomic<u32>",
    }
}

/// A record's WGSL name, its size in bytes as an array element, and its fields.
pub type Layout = (String, usize, Vec<Field>);

/// Lists all records.
macro_rules! all {
    ($($record:ty = $size:expr),* $(,)?) => {
        /// All records as the host lays them out.
        pub fn layouts() -> Vec<Layout> {
            vec![$((<$record>::wgsl(), $size, <$record>::fields())),*]
        }

        /// All records in WGSL.
        pub fn wgsl() -> String {
            [$(<$record>::declaration()),*].join("\n")
        }
    };
}

all! {
    ShadingRecord<f32> = RECORD_COLUMNS * size_of::<f32>(),
    AnchoredSphere<f32> = size_of::<AnchoredSphere<f32>>(),
    CameraTable<f32> = size_of::<CameraTable<f32>>(),
    GpuJob = size_of::<GpuJob>(),
    GpuDispatch = size_of::<GpuDispatch>(),
    GpuBlock = size_of::<GpuBlock>(),
    GpuCounters = size_of::<GpuCounters>(),
    GpuDispatchCounters = size_of::<GpuDispatchCounters>(),
}
