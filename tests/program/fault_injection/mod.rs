//! Fault drills: kills, full disks, resource limits, closed pipes, and other runs on the same film. All rendered
//! samples must survive to the bit.
//!
//! Each test runs a few rounds. For a long series, set WEEKENDER_FAULT_ROUNDS to the number of rounds:
//! `WEEKENDER_FAULT_ROUNDS=150 cargo test --release --test program fault_injection -- --nocapture`.

#![cfg(target_os = "linux")]
mod common;
mod limits;
mod outputs;
mod signals;
