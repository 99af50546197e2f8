//! The program with what is not ours: a display, a browser. Tests that lack these say so.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a helper of a test may fail like the test"
)]

#[path = "../common/mod.rs"]
mod common;

mod window_xvfb;
