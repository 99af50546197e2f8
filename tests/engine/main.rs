//! The library without the program: arithmetic, films, scene files, the tracers against each other and against closed forms.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a helper of a test may fail like the test"
)]

#[path = "../common/mod.rs"]
mod common;

mod boundaries;
mod charts;
mod denoise;
mod explain;
mod film;
mod fireflies;
mod golden;
mod numerics;
mod progressive;
mod random_scenes;
mod scene_files;
mod stages;
