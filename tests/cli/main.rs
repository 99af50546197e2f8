//! The program from outside: what it writes, says and returns.

#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod common;
mod ending;
mod films;
mod outputs;
mod values;
