//! Helpers that the test programs share.
#![allow(dead_code, reason = "each program uses some of it")]

pub mod gpu;
pub mod noisy_scenes;
pub mod oracle;
pub mod program;
pub mod skip;
