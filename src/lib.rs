//! Weekender: the path tracer of *Ray Tracing in One Weekend* as a viewer, a headless renderer and a lesson.
//!
//! The re-exports here are the library: a [`Recipe`] describes a picture, a [`RenderJob`] is a checked recipe, a
//! [`Renderer`] adds its samples to a [`Film`], and [`write_image`] writes it. The examples use nothing else. The rooms
//! are public for the program, its tests and its benchmarks only, and change without notice.

// See clippy.toml. Tests and examples may print.
#![warn(clippy::disallowed_macros)]

#[doc(hidden)]
#[cfg(feature = "window")]
pub mod app;
#[doc(hidden)]
pub mod backends;
#[doc(hidden)]
pub mod batch;
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod comparison;
#[doc(hidden)]
pub mod denoise;
#[doc(hidden)]
pub mod excerpt;
#[doc(hidden)]
pub mod film;
#[doc(hidden)]
pub mod job;
#[doc(hidden)]
pub mod kernel;
#[doc(hidden)]
#[cfg(not(target_family = "wasm"))]
pub mod measure;
#[doc(hidden)]
pub mod numbers;
#[doc(hidden)]
pub mod prepared;
#[doc(hidden)]
pub mod progressive;
#[doc(hidden)]
pub mod render_cpu;
#[doc(hidden)]
pub mod render_gpu;
#[doc(hidden)]
pub mod scene;
#[doc(hidden)]
pub mod stages;
#[doc(hidden)]
pub mod system;

pub use film::{ErrorEstimate, Film};
pub use job::output::write_image;
pub use job::recipe::{Recipe, file as scene_file};
pub use job::render::{RenderJob, RenderSettings, Renderer};
pub use progressive::Status;
pub use progressive::describe::describe;
pub use render_cpu::{CpuOptions, CpuRenderer};
pub use scene::{Camera, Material, Scene, Sky};
pub use stages::Rules;
pub use system::files::write_text;
