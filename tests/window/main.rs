//! Tests the window through its real state, as a person would use it: every command, key and control.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod cards;
mod commands;
mod common;
mod crop;
mod device;
// Keys have other names on macOS.
#[cfg(not(target_os = "macos"))]
mod drawings;
#[cfg(not(target_os = "macos"))]
mod drawings_views;
#[cfg(not(target_os = "macos"))]
mod drawn;
mod edits;
mod extreme;
mod faults;
mod files;
mod first_steps;
mod flights;
mod frame;
mod framing;
#[path = "../golden/kept.rs"]
mod golden;
mod help;
mod kept;
mod menus;
mod moving;
mod numbers;
mod objects;
mod palette;
mod panels;
mod paths;
mod pictures;
mod plot;
mod present;
mod preview;
mod recent;
mod recovered;
mod remembered;
mod resuming;
mod session;
mod shown_slots;
mod sights;
mod size;
mod sizes;
mod slot_files;
mod slots;
mod snapshots;
mod stages;
mod surfaces;
mod thumbnails;
mod tips;
mod title_bar;
mod tone;
mod viewport;
mod wipe;
