//! Scene files: what is written is read back to the bit, and what is wrong is named with its line.

mod common;
mod random;
mod reading;
mod refused;
mod round_trip;
