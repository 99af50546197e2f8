//! Records that shaders read and write in an array of words. Fields are packed without alignment, so a shader has no
//! struct for them but a constant per field with its first word: `SUSPENDED_STATE` for `state` in [`GpuSuspendedPath`].
//! `SUSPENDED_WORDS` is the number of words.

use super::record::{Field, Record, Shared, last, record};
use bytemuck::{Pod, Zeroable};
use std::fmt::Write;

record! {
    /// A path that a thread has suspended: see shaders/suspend.wgsl.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuSuspendedPath as "SUSPENDED" {
        /// Origin of the ray.
        pub origin: [f32; 3],
        /// The sphere that the ray left outwards.
        pub left: u32,
        /// Direction of the ray.
        pub direction: [f32; 3],
        /// The sphere that the ray is inside of.
        pub inside: u32,
        /// Throughput of the path.
        pub throughput: [f32; 3],
        /// Bounce, samples left and whether the path is absorbed; 0 if no path was suspended.
        pub state: u32,
        /// Number of the block among those of the tile.
        pub block: u32,
        /// Sums of the block.
        pub sums: [u32; 3],
        /// Squared sine of the angle of incidence inside steep glass.
        pub sine2: f32,
        /// In the first thread of a workgroup: number of the next block that no thread has begun.
        pub next_block: u32,
    }
}

record! {
    /// The start of a recorded path.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuRecordHead as "RECORD_HEAD" {
        /// Column of the pixel.
        pub column: u32,
        /// Row of the pixel.
        pub row: u32,
        /// Number of rays recorded so far.
        pub ray_count: u32,
        /// Sums that the path added to the film, low words.
        pub sums: [u32; 3],
    }
}

record! {
    /// A ray of a recorded path.
    #[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
    pub struct GpuRecordedRay as "RECORDED_RAY" {
        /// Origin of the ray.
        pub origin: [f32; 3],
        /// Direction of the ray.
        pub direction: [f32; 3],
        /// Throughput before the hit.
        pub throughput: [f32; 3],
        /// The sphere that is hit, or `NONE`.
        pub sphere: u32,
        /// Distance to the hit.
        pub distance: f32,
    }
}

/// Words in a record.
pub const fn word_count<T: Pod>() -> usize {
    size_of::<T>() / size_of::<u32>()
}

pub(super) fn wgsl() -> String {
    constants::<GpuSuspendedPath>() + &constants::<GpuRecordHead>() + &constants::<GpuRecordedRay>()
}

fn constants<T: Record + Pod>() -> String {
    let prefix = T::wgsl();
    let mut text = format!("const {prefix}_WORDS = {}u;\n", word_count::<T>());
    for Field { name, offset, .. } in T::fields() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const {prefix}_{} = {}u;", name.to_uppercase(), offset / size_of::<u32>());
    }
    text
}
