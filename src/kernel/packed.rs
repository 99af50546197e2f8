//! The record that shaders read and write in an array of words. Its fields are packed without alignment, so a shader has
//! no struct for it but a constant per field with its first word: `SUSPENDED_STATE` for `state`. `SUSPENDED_WORDS` is the
//! number of words.

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

pub(super) fn wgsl() -> String {
    let word = size_of::<u32>();
    let mut text = format!("const SUSPENDED_WORDS = {}u;\n", size_of::<GpuSuspendedPath>() / word);
    for Field { name, offset, .. } in GpuSuspendedPath::fields() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const SUSPENDED_{} = {}u;", name.to_uppercase(), offset / word);
    }
    text
}
