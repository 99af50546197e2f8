//! The program as a user runs it: files, messages and exit codes.

mod common;
mod ending;
mod films;
mod outputs;
mod values;
