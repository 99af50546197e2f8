//! What is checked before a picture is read.

use crate::system::memory;
use anyhow::{Result, ensure};

/// Largest number of pixels that is read.
pub(super) const PIXEL_LIMIT: u64 = 1 << 28;

/// Number of pixels, or an error if the size is out of range.
pub(super) fn pixel_count(width: u32, height: u32) -> Result<usize> {
    let count = u64::from(width) * u64::from(height);
    ensure!(
        (1..=PIXEL_LIMIT).contains(&count),
        "its size is {width}x{height}; only 1 to {PIXEL_LIMIT} pixels can be read"
    );
    Ok(count as usize)
}

/// Most memory per pixel while a picture is read: for the file's data, the decoded data, and the numbers with their
/// quantisation steps.
const BYTES_PER_PIXEL: u64 = 80;

/// Returns an error if the picture would not fit into memory, with `more` bytes for each pixel than usual.
pub(super) fn check_memory(width: u32, height: u32, more: u64) -> Result<()> {
    let bytes = u64::from(width) * u64::from(height) * (BYTES_PER_PIXEL + more);
    let what = || format!("a picture of {width}x{height} pixels");
    Ok(memory::check(what, bytes, "close other programs or make it smaller")?)
}
