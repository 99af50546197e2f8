//! The film: exact sums, sample ranges, the resolved picture, the error estimate, film files and merging.

mod common;
mod error_estimate;
mod files;
mod merging;
mod ranges;
mod sums;
