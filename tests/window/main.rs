//! Tests the window through its real state, as a person would use it: every command, key and control.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod animation;
mod commands;
#[path = "../common/mod.rs"]
mod common;
mod compare;
mod device;
mod edits;
mod extreme;
mod files;
mod harness;
mod kept;
mod moving;
mod objects;
mod own;
mod palette;
mod panels;
mod paths;
mod pictures;
mod present;
mod preview;
mod questions;
mod readout;
mod recent;
mod recovered;
mod resuming;
mod right;
mod sights;
mod size;
mod stages;
mod thumbnails;
mod tone;
mod viewport;
mod wipe;
