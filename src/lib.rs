//! Weekender: the path tracer of *Ray Tracing in One Weekend* as a viewer, a headless renderer and a lesson.

// See clippy.toml. Tests and examples may print.
#![warn(clippy::disallowed_macros)]

pub mod about;
pub mod animation;
#[cfg(feature = "window")]
pub mod app;
pub mod backends;
pub mod baseline;
pub mod batch;
pub mod bench;
pub mod chart;
pub mod check;
pub mod cli;
pub mod companion;
pub mod compare;
pub mod console;
pub mod describe;
pub mod diff;
pub mod explain;
pub mod failure;
pub mod files;
pub mod film;
pub mod gallery;
pub mod heat;
pub mod info;
pub mod interrupt;
pub mod journal;
#[cfg(test)]
#[path = "../tests/golden/kept.rs"]
mod kept;
pub mod kernel;
pub mod layers;
pub mod memory;
pub mod merge;
mod number;
pub mod output;
pub mod plan;
pub mod prepared;
pub mod progressive;
pub mod recipe;
pub mod record;
pub mod render;
pub mod render_cpu;
pub mod render_gpu;
pub mod report;
pub mod sampling;
pub mod saved;
pub mod scene;
pub mod shell;
pub mod stages;
pub mod statistics;
pub mod stress;
mod suggest;
pub mod terminal;
mod threads;
pub mod web;
