//! The film's sums on their way from the device into the film on the host.

use crate::film::Film;
use rayon::prelude::*;

/// 64-bit words per pixel, one per channel.
pub(super) const PIXEL_WORDS: usize = 3;

/// Pixels that a host thread adds at a time.
const PIXELS_AT_ONCE: usize = 4096;

/// Adds a slab's sums, half by half, to the film, starting at row `first_row`.
pub(super) fn add_rows(film: &mut Film, first_row: u32, sums: &[u64]) {
    let start = first_row as usize * film.width() as usize;
    let halves = film.halves_mut();
    // Buffer sizes are rounded up to 16 bytes.
    let words = sums.len() / halves.len() / PIXEL_WORDS * PIXEL_WORDS;
    for (half, sums) in halves.iter_mut().zip(sums.chunks_exact(words)) {
        let pixels = &mut half[start..start + words / PIXEL_WORDS];
        let parts = pixels.par_chunks_mut(PIXELS_AT_ONCE);
        parts.zip(sums.par_chunks(PIXELS_AT_ONCE * PIXEL_WORDS)).for_each(|(pixels, sums)| {
            for (pixel, sum) in pixels.iter_mut().zip(sums.as_chunks::<PIXEL_WORDS>().0) {
                for (mine, theirs) in pixel.0.iter_mut().zip(sum) {
                    *mine += theirs;
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PixelSum;

    #[test]
    fn sums_are_added_to_their_rows_half_by_half() {
        // The last has more pixels than a thread takes at a time.
        for (width, height, halves, first_row, rows) in [(3, 4, 2, 1, 2), (1, 2, 1, 1, 1), (5000, 1, 1, 0, 1)]
        {
            let mut film = Film::new(width, height, halves);
            film.halves_mut().iter_mut().flatten().for_each(|sum| *sum = PixelSum([1000; 3]));
            let (width, of_half) = (width as usize, (width * rows) as usize);
            // Words beyond the last pixel are left out.
            let sums: Vec<u64> = (0..(3 * of_half * halves) as u64 + 1).collect();
            add_rows(&mut film, first_row, &sums);
            for (number, half) in film.halves().iter().enumerate() {
                for (pixel, sum) in half.iter().enumerate() {
                    let place =
                        pixel.checked_sub(first_row as usize * width).filter(|place| *place < of_half);
                    let first = place.map(|place| 3 * (number * of_half + place));
                    let added = first.map_or([0; 3], |first| [0, 1, 2].map(|channel| sums[first + channel]));
                    assert_eq!(sum.0, added.map(|added| 1000 + added), "pixel {pixel} of {width}x{height}");
                }
            }
        }
    }
}
