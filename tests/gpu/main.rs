//! The GPU renderer: its shaders, its films, and the program that uses it. The tests run on any adapter, even a software
//! one.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod complete;
#[path = "../gpu_common/mod.rs"]
mod gpu_common;
mod pairs;
mod program;
#[path = "../program_common/mod.rs"]
mod program_common;
mod renderer;
mod shaders;
