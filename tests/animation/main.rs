//! Animations: camera paths, keyframes of scene files, frames and animated PNG.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod frames;
mod paths;
mod refused;
mod scene_file;
