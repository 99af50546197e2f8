//! Limits on the size of pictures that are read.

use crate::memory;
use std::io;

/// Largest number of pixels that is read.
pub(super) const PIXEL_LIMIT: u64 = 1 << 28;

/// Number of pixels, or an error if the size is out of range.
pub(super) fn pixel_count(width: u32, height: u32) -> io::Result<usize> {
    let count = u64::from(width) * u64::from(height);
    if !(1..=PIXEL_LIMIT).contains(&count) {
        let reason = format!("its size is {width}x{height}; only 1 to {PIXEL_LIMIT} pixels can be read");
        return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
    }
    Ok(count as usize)
}

/// Most memory per pixel while a picture is read: for the file's data, the decoded data, and the numbers with their
/// quantisation steps.
const BYTES_PER_PIXEL: u64 = 80;

/// Returns an error if the picture would not fit into memory.
pub(super) fn check_memory(width: u32, height: u32) -> io::Result<()> {
    let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL;
    memory::check(
        || format!("a picture of {width}x{height} pixels"),
        bytes,
        "close other programs or make it smaller",
    )
    .map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_some_pixels_and_not_too_many() {
        for (width, height, count) in
            [(1, 1, Some(1)), (13, 7, Some(91)), (16_384, 16_384, Some(1 << 28)), (0, 5, None), (5, 0, None)]
        {
            assert_eq!(pixel_count(width, height).ok(), count, "{width}x{height}");
        }
        for [width, height] in [[16_385, 16_384], [(1 << 28) + 1, 1], [u32::MAX, u32::MAX]] {
            let told = pixel_count(width, height).unwrap_err().to_string();
            let words = format!("its size is {width}x{height}; only 1 to 268435456 pixels can be read");
            assert_eq!(told, words);
        }
    }
}
