//! Declarations that the CPU and GPU tracers share.
//!
//! - [`records`]: the structs that a prepared scene holds and shaders read. One declaration generates the Rust
//!   types for `f32` and `f64`, the named loads of the CPU's packets and the WGSL structs.
//! - [`packed`]: the record that shaders read and write word by word.
//! - [`constants`] and [`tags`]: numbers, and enumerations that shaders represent as numbers.
//! - [`features`]: properties of a job that need code in a kernel. They select the variant on the CPU and the pipeline
//!   overrides on the GPU, and name the kernel's parts in summaries.
//!
//! [`wgsl`] passes all of these declarations to the shaders as text.

pub mod path_record;
pub mod sampling;

pub mod constants;
pub mod features;
pub mod packed;
pub mod real;
pub mod record;
pub mod records;
pub mod tags;

pub use constants::*;
pub use features::{Features, SortedSpheres, parts};
pub use packed::GpuSuspendedPath;
pub use real::Real;
pub use record::{Columns, Field, Record, Shared, words_of};
pub use records::*;
pub use tags::{Roots, Tag};

/// All shared declarations in WGSL: constants, tags, overrides and structs.
pub fn wgsl() -> String {
    let constants = constants::wgsl() + &tags::wgsl() + &packed::wgsl();
    let overrides = Features::default().wgsl();
    let structs = records::wgsl();
    [constants, overrides, structs].join("\n")
}
