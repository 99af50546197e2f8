//! What to do when a test lacks a tool or an adapter.
#![allow(dead_code, reason = "each test uses some of it")]

use std::io::Write;

/// Reports that something was not tested, and lets the test pass. Fails if the environment variable
/// `WEEKENDER_REQUIRE_<what>` is 1.
pub fn skip(what: &str, reason: &str) {
    let is_required = std::env::var(format!("WEEKENDER_REQUIRE_{what}")).as_deref() == Ok("1");
    assert!(!is_required, "{reason}");
    report_untested(reason);
}

/// Prints that something was not tested, bypassing the test harness, which hides the output of passing tests.
pub fn report_untested(reason: &str) {
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    let line = format!("\nNOT TESTED: {test}: {reason}\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}
