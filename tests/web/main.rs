//! Live figures: what the script writes is what the program would, and a browser renders the same films.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod browser;
mod bytes;
#[path = "../gpu_common/mod.rs"]
mod gpu_common;
mod page;
mod session;

/// Says that something was not tested, or fails where `WEEKENDER_REQUIRE_BROWSER=1` is set.
fn skip(reason: &str) {
    let is_required = std::env::var("WEEKENDER_REQUIRE_BROWSER").as_deref() == Ok("1");
    assert!(!is_required, "{reason}");
    gpu_common::say_loudly(reason);
}
