//! How many threads read or write a film file.

use std::thread;

/// More gain little: they wait for memory and disk.
const MOST: usize = 8;

/// Threads that read or write a film file.
pub(super) fn threads() -> usize {
    thread::available_parallelism().map_or(1, usize::from).min(MOST)
}
