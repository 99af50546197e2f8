//! Scene files: they round-trip to the bit, and errors name the line.

mod common;
mod random;
mod reading;
mod refused;
mod round_trip;
mod tables;
