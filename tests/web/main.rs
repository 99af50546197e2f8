//! Live figures: what the script writes is what the program would, and a browser renders the same films.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod browser;
mod bytes;
#[path = "../common/mod.rs"]
mod common;
mod page;
mod session;

fn skip(reason: &str) {
    crate::common::gpu::skip("BROWSER", reason);
}
