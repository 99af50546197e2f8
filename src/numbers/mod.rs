//! Statistics, charts and heat maps.

#[cfg(not(target_family = "wasm"))]
pub mod chart;
pub mod heat;
pub mod statistics;
