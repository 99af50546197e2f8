//! The program as a user starts it: files, messages and exit codes.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a helper of a test may fail like the test"
)]

#[path = "../common/mod.rs"]
mod common;

mod animation;
mod check;
mod cli;
mod compare;
mod fault_injection;
mod limits;
mod log;
mod measure;
mod output_files;
mod packaging;
mod panics;
mod pictures;
mod ranges;
mod stress;
