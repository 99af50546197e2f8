//! The records: what a prepared scene holds and shaders read.
//!
//! Rust lays a struct out without gaps where each `vec3f` and `vec4f` begins at a multiple of 16 bytes, as WGSL asks for;
//! a test holds both layouts against each other.

use super::record::{Columns, Field, Record, Shape, Shared, column_of, loads, named, record, single};
use super::{Real, Roots, UNDER_EYE, UNIFORM_ANCHORED, UNIFORM_SPHERES};
use bytemuck::{Pod, Zeroable};

record! {
    /// What shading needs to know of a sphere.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct ShadingRecord<R> as "ShadingRecord", loaded by LoadShading {
        /// Centre, or anchor.
        pub reference: [R; 3],
        /// 1 / radius.
        pub curvature: R,
        /// Reflected share of each colour.
        pub albedo: [R; 3],
        /// Length of the unit vector's part in the scattered direction; with a minus sign (also on 0) that is a reflection.
        pub weight: R,
        /// Radius.
        pub radius: R,
        /// Refraction index; 0 if not glass.
        pub refraction_index: R,
        /// 1 / refraction index; 0 if not glass.
        pub inverse_index: R,
        /// Schlick's share at normal incidence.
        pub f0: R,
        /// Unit vector from the anchor to the centre; 0 if not anchored.
        pub inward: [R; 3],
        /// 0 if not anchored, 1 if anchored, 2 if every ray is inside.
        pub anchoring: R,
    }
}

/// Numbers of a [`ShadingRecord`].
pub const SHADING_COLUMNS: usize = size_of::<ShadingRecord<f32>>() / size_of::<f32>();

/// The same, filled up to whole groups of [`GROUP`]: a record's stride.
pub const RECORD_COLUMNS: usize = SHADING_COLUMNS.next_multiple_of(GROUP);

/// Columns that are gathered at once.
pub const GROUP: usize = 4;

/// A [`ShadingRecord`] as numbers, which lanes gather by column: in `f32` it begins with a cache line.
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
    /// A sphere as seen from a point of its surface.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct AnchoredSphere<R> as "AnchoredSphere" {
        /// That point, near what is looked at.
        pub anchor: [R; 3],
        /// 1 / radius.
        pub curvature: R,
        /// Unit vector from the anchor to the centre.
        pub inward: [R; 3],
        /// A `ROOTS_` tag, and `UNDER_EYE` where the eye is a point of the surface, and on its outer side: rays that
        /// start there and go outwards leave the sphere, the others meet it where they start.
        pub flags: u32,
    }
}

impl<R> AnchoredSphere<R> {
    /// Which of the distances to it count.
    #[inline(always)]
    pub fn roots(&self) -> Roots {
        Roots::of_flags(self.flags)
    }

    /// Whether the eye is a point of the surface.
    #[inline(always)]
    pub fn is_under_eye(&self) -> bool {
        self.flags & UNDER_EYE != 0
    }
}

record! {
    /// The camera in the form that gives a ray with a few multiplications and no difference of far points.
    ///
    /// A pixel position `p` (with the point in the pixel) lies at `s = p scale + offset` on the plane at distance 1.
    /// With a point `xi` of the unit disk on the lens, the direction is
    /// `(s.x - tau xi.x) u + (s.y - tau xi.y) v - w`, the origin `eye + lens_radius (xi.x u + xi.y v)`.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct CameraTable<R> as "Camera" {
        /// The eye.
        pub eye: [R; 3],
        /// Tangent of half the defocus angle; 0 without a lens.
        pub tau: R,
        /// Right.
        pub u: [R; 3],
        /// Radius of the lens.
        pub lens_radius: R,
        /// Up.
        pub v: [R; 3],
        /// Width of a pixel on the plane at distance 1.
        pub scale_x: R,
        /// Against the view.
        pub w: [R; 3],
        /// Height of a pixel there, negative.
        pub scale_y: R,
        /// Left and upper edge of the picture.
        pub offset: [R; 2],
        /// Pixels across and down.
        pub size: [R; 2],
    }
}

impl<R: Copy> CameraTable<R> {
    /// The same in another form of number.
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

record! {
    /// A box of the hierarchy and what it holds.
    #[derive(Clone, Copy, Debug, Default, PartialEq)]
    pub struct Node<R> as "Node" {
        /// Lowest corner.
        pub low: [R; 3],
        /// First sphere of a leaf, or the first of two children that stand side by side.
        pub first: u32,
        /// Highest corner.
        pub high: [R; 3],
        /// Spheres of a leaf in the bits of `COUNT_MASK`; else 0 there, the axis that parts the children in bits 30 and
        /// 31, and bit 29 set where the second child lies before the first.
        pub count: u32,
    }
}

record! {
    /// Eight boxes, compressed: the bytes of obvhs' node. (Ylitie, Karras and Laine 2017.)
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuCwbvhNode as "CwbvhNode" {
        /// Lowest corner, from which the children's boxes are measured.
        pub low: [f32; 3],
        /// By axis, 8 bits: the exponent of the unit of their bounds. In the highest 8 bits, which children are nodes.
        pub units: u32,
        /// Its children that are nodes stand side by side from here on.
        pub first_child: u32,
        /// The spheres of the others stand side by side from here on.
        pub first_sphere: u32,
        /// By child, 8 bits: what it adds to a mask of hits, in the upper 3, at the bit that the lower 5 tell.
        pub marks: [u32; 2],
        /// By axis, 8 bits a child: lower bounds of children 0 .. 3 and 4 .. 7, then upper bounds.
        pub x: [u32; 4],
        /// Along y.
        pub y: [u32; 4],
        /// Along z.
        pub z: [u32; 4],
    }
}

record! {
    /// What a job is, the same for all its dispatches.
    #[derive(Clone, Copy, Debug)]
    pub struct GpuJob as "Job" {
        /// The camera.
        pub camera: CameraTable<f32>,
        /// Sky radiance at the horizon in units of the film.
        pub sky_middle: [f32; 3],
        /// Largest coordinate of any box of the hierarchy.
        pub extent: f32,
        /// Growth of the sky radiance with the direction's y, in units of the film.
        pub sky_slope: [f32; 3],
        /// Most rays of a path.
        pub max_depth: u32,
        /// The sampler's seed.
        pub seed: u32,
        /// Spheres of one root.
        pub opaque_count: u32,
        /// Spheres of two.
        pub two_root_count: u32,
        /// Spheres that are seen from a point of their surface.
        pub anchored_count: u32,
        /// Pixels across.
        pub width: u32,
        /// Pixels down.
        pub height: u32,
        /// Pixels across a workgroup's tile.
        pub tile_width: u32,
        /// Nodes of the hierarchy: a traversal visits each once at most.
        pub node_count: u32,
        /// The spheres where they are few: all threads read one at a time, which constant memory is made for.
        pub few_spheres: [[f32; 4]; UNIFORM_SPHERES],
        /// The anchored spheres where they are few.
        pub few_anchored: [AnchoredSphere<f32>; UNIFORM_ANCHORED],
    }
}

record! {
    /// What one dispatch is to do.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuDispatch as "Dispatch" {
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
}

record! {
    /// A block of samples of a half of the film.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
    pub struct GpuBlock as "Block" {
        /// Half of the film.
        pub half: u32,
        /// The sampler's counter of the first sample.
        pub counter: u32,
        /// What it grows by.
        pub step: u32,
        /// Samples.
        pub count: u32,
    }
}

record! {
    /// A pixel's sums in units of 2^-24: the bytes of a [`crate::film::PixelSum`].
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuPixelSum as "PixelSum" {
        /// Low and high word.
        pub red: [u32; 2],
        /// Low and high word.
        pub green: [u32; 2],
        /// Low and high word.
        pub blue: [u32; 2],
    }
}

record! {
    /// What was counted since the film was last sent for.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuCounters as "Counters" {
        /// Rays traced, low word.
        pub rays: u32 as "atomic<u32>",
        /// High word.
        pub rays_high: u32 as "atomic<u32>",
        /// Samples left out, low word.
        pub rejected: u32 as "atomic<u32>",
        /// High word.
        pub rejected_high: u32 as "atomic<u32>",
        /// What one dispatch counted.
        pub dispatch: GpuDispatchCounters,
    }
}

record! {
    /// What was counted in one dispatch alone.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
    pub struct GpuDispatchCounters as "DispatchCounters" {
        /// Samples whose sums are in the film, low word.
        pub finished: u32 as "atomic<u32>",
        /// High word.
        pub finished_high: u32 as "atomic<u32>",
        /// Threads that have put a path aside.
        pub unfinished: u32 as "atomic<u32>",
        /// Those of them that could not trace one ray to its end.
        pub stuck: u32 as "atomic<u32>",
    }
}

/// A record's name in WGSL, its size in bytes as an element of an array, and its fields.
pub type Layout = (String, usize, Vec<Field>);

/// Makes the list of all records.
macro_rules! all {
    ($($record:ty = $size:expr),* $(,)?) => {
        /// All records, as the host lays them out.
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
    Node<f32> = size_of::<Node<f32>>(),
    GpuCwbvhNode = size_of::<GpuCwbvhNode>(),
    GpuJob = size_of::<GpuJob>(),
    GpuDispatch = size_of::<GpuDispatch>(),
    GpuBlock = size_of::<GpuBlock>(),
    GpuPixelSum = size_of::<GpuPixelSum>(),
    GpuCounters = size_of::<GpuCounters>(),
    GpuDispatchCounters = size_of::<GpuDispatchCounters>(),
}
