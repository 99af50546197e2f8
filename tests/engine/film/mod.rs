//! The film: exact sums, sample ranges, the resolved picture, the error estimate, film files and merging.

#![allow(clippy::single_range_in_vec_init, reason = "films of one range")]

mod common;
mod error_estimate;
mod files;
mod merging;
mod ranges;
mod sums;
