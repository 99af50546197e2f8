//! How large a picture may be that is read.

use crate::memory;
use std::io;

/// Most pixels of a picture that is read.
pub(super) const PIXEL_LIMIT: u64 = 1 << 28;

/// Pixels of a picture of this size.
pub(super) fn pixel_count(width: u32, height: u32) -> io::Result<usize> {
    let count = u64::from(width) * u64::from(height);
    if !(1..=PIXEL_LIMIT).contains(&count) {
        let reason = format!("it has {width}x{height} pixels, where 1 to {PIXEL_LIMIT} can be read");
        return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
    }
    Ok(count as usize)
}

/// What a pixel takes at most while a picture is read: as it is in the file, as it is decoded, and as numbers with
/// their steps.
const BYTES_PER_PIXEL: u64 = 80;

/// Refuses a picture that does not fit into memory.
pub(super) fn check_memory(width: u32, height: u32) -> io::Result<()> {
    let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL;
    memory::check(
        || format!("a picture of {width}x{height}"),
        bytes,
        "close other programs, or make it smaller",
    )
    .map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))
}
