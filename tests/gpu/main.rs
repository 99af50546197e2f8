//! The GPU renderer: its shaders, its films against the CPU's, and the program that uses it. The tests run on any adapter,
//! even a software one.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

#[path = "../common/mod.rs"]
mod common;
mod complete;
mod driver;
mod faults;
mod pairs;
mod renderer;
mod shaders;
mod twins;
