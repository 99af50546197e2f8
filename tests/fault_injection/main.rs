//! Drills: the program under kills, full disks, limits, closed pipes and other runs on the same film. What it had
//! rendered must be there afterwards, to the bit.
//!
//! Each runs a few rounds. For long series by hand, WEEKENDER_FAULT_ROUNDS is the number of rounds:
//! `WEEKENDER_FAULT_ROUNDS=150 cargo test --release --test fault_injection -- --nocapture`.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod limits;
mod outputs;
mod signals;
