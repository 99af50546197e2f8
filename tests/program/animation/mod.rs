//! Animations: camera paths, keyframes of scene files, frames and animated PNG.

mod common;
mod frames;
mod paths;
mod refused;
mod scene_file;
