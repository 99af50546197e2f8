//! Plans: parts of a picture rendered by separate commands, and their merged film.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod info;
mod merging;
mod parts;
#[path = "../program_common/mod.rs"]
mod program_common;
mod refused;
mod scripts;
#[path = "../skip_common/mod.rs"]
mod skip_common;
