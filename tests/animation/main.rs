//! Animations: camera paths, keyframes of scene files, frames and animated PNG.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod frames;
mod paths;
#[path = "../program_common/mod.rs"]
mod program_common;
mod refused;
mod scene_file;
