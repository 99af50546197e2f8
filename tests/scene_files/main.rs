//! Scene files: what is written is read back to the bit, and errors name the line.

mod common;
mod random;
mod reading;
mod refused;
mod round_trip;
