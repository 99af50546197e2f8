//! What the program says, writes and computes for fixed small inputs, beside the kept texts in `tests/golden/*.txt`.
//!
//! A change of a word, a number, an order or a sample shows as a difference of text. `UPDATE_SNAPSHOTS=1` writes the
//! texts anew; whoever does so reads what `git diff` shows.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod charts;
mod common;
mod compared;
mod extremes;
mod films;
mod flags;
mod kept;
mod paths;
mod pictures;
#[path = "../program_common/mod.rs"]
mod program_common;
mod refusals;
mod scenes;
mod sessions;
mod tables;
