#![allow(clippy::unwrap_used)]
#![allow(dead_code)]
mod common;
mod right;
mod scratch;
mod sights;
mod tone;
