//! Live figures: what the script writes is what the program would, and a browser renders the same films.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod browser;
mod bytes;
#[path = "../gpu_common/mod.rs"]
mod gpu_common;
mod page;
mod session;

fn skip(reason: &str) {
    gpu_common::skip("BROWSER", reason);
}
