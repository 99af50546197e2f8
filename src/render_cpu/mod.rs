//! The CPU backends: SIMD packets, scalar code and the `f64` reference, all from one width-generic source.

pub mod broadcast;
pub mod bvh;
pub mod camera;
mod isa;
mod kernels;
pub mod lanes;
pub mod material;
mod options;
mod pass;
pub mod path;
mod priority;
mod rebuild;
mod record;
mod renderer;
pub mod rng;
pub mod sphere;
mod tiles;
pub mod work;

pub use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
pub use isa::Isa;
pub use options::{CpuError, CpuOptions};
pub use priority::give_way;
pub use record::PathRecorder;
pub use renderer::CpuRenderer;
