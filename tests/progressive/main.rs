//! Progressive rendering with a renderer that fails on request: no samples are lost, whatever happens.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod common;
mod failures;
mod handover;
mod stopping;
mod together;
