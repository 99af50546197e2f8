//! The program as a user runs it: files, messages and exit codes.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod ending;
mod films;
mod outputs;
#[path = "../program_common/mod.rs"]
mod program_common;
mod values;
