//! What the CPU's tracer and the GPU's share, each thing declared once.
//!
//! - [`records`]: the structs that a prepared scene holds and shaders read. The Rust types for `f32` and `f64`, the named loads
//!   of the CPU's packets and the structs of WGSL come from one declaration.
//! - [`constants`] and [`tags`]: numbers, and enumerations that shaders know by numbers.
//! - [`features`]: what a job needs of a kernel. The CPU chooses its variant by them, the GPU its pipeline overrides,
//!   and summaries are worded by them.
//!
//! Everything here reaches the shaders as text: [`wgsl`].

pub mod constants;
pub mod features;
pub mod real;
pub mod record;
pub mod records;
pub mod tags;

pub use constants::*;
pub use features::{Features, SortedSpheres, parts};
pub use real::Real;
pub use record::{Columns, Field, Record, Shared, words_of};
pub use records::*;
pub use tags::{Roots, Tag};

/// All that is declared here, in WGSL: constants, tags, overrides, structs.
pub fn wgsl() -> String {
    let constants = constants::wgsl() + &tags::wgsl();
    let overrides = Features::default().wgsl();
    let structs = records::wgsl();
    [constants, overrides, structs].join("\n")
}
