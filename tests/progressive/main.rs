//! The progressive render with a renderer that can be told to fail: nothing is lost, whatever happens to it.

#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod common;
mod failures;
mod handover;
mod stopping;
