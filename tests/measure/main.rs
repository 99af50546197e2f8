//! `weekender bench` and `report`, and the plain C program that they compare with.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a helper may fail like the test")]

mod bench;
#[path = "../program_common/mod.rs"]
mod program_common;
mod reference_c;
mod report;
