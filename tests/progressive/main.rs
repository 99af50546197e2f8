//! Progressive rendering with a renderer that fails on request: no samples are lost, whatever happens.

#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod breakdowns;
mod commands;
mod common;
mod failures;
mod handover;
mod preview;
mod requests;
mod stopping;
mod together;
mod told;
