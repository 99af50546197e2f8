//! Helpers that the test programs share.
#![allow(dead_code, clippy::unwrap_used, reason = "each program uses some of it")]

pub mod films;
pub mod gpu;
pub mod noisy_scenes;
pub mod oracle;
pub mod program;
pub mod random;
pub mod skip;
