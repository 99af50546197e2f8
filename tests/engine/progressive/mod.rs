//! Progressive rendering with a renderer that fails on request: no samples are lost, whatever happens.

mod common;
mod failures;
mod handover;
mod stopping;
