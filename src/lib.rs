//! Weekender: the path tracer of *Ray Tracing in One Weekend* as a viewer, a headless renderer and a lesson.

pub mod app;
pub mod backends;
pub mod batch;
pub mod bench;
pub mod chart;
pub mod cli;
pub mod describe;
pub mod diff;
pub mod failure;
pub mod film;
pub mod interrupt;
pub mod output;
pub mod progressive;
pub mod recipe;
pub mod record;
pub mod render;
pub mod render_cpu;
pub mod render_gpu;
pub mod sampling;
pub mod scene;
pub mod stages;
pub mod tables;
