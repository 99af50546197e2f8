//! Statistics, charts and heat maps.

pub mod chart;
pub mod heat;
pub mod statistics;
