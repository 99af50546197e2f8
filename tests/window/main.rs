//! Tests the window through its real state, as a person would use it: every command, key and control.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod commands;
mod common;
mod crop;
mod device;
mod edits;
mod extreme;
mod faults;
mod files;
mod first_steps;
mod flights;
mod moving;
mod numbers;
mod objects;
mod panels;
mod pictures;
mod plot;
mod present;
mod preview;
mod recent;
mod remembered;
mod resuming;
mod session;
mod sights;
mod size;
mod slots;
mod snapshots;
mod stages;
mod surfaces;
mod thumbnails;
mod tone;
mod viewport;
mod wipe;
