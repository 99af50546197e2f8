//! The film's sums on their way from the device into the film on the host.

use super::failed;
use crate::film::Film;
use crate::job::render::RenderError;
use rayon::prelude::*;

/// 64-bit words per pixel, one per channel.
pub(super) const PIXEL_WORDS: usize = 3;

/// Pixels that a host thread adds at a time.
const PIXELS_AT_ONCE: usize = 4096;

/// The bytes of a staging buffer that is mapped.
pub(super) fn view(staging: &wgpu::Buffer) -> Result<wgpu::BufferView, RenderError> {
    staging.get_mapped_range(..).map_err(|error| failed(format!("reading results: {error}")))
}

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
        let mut film = Film::new(3, 4, 2);
        for half in film.halves_mut() {
            half.iter_mut().for_each(|sum| *sum = PixelSum([1000; 3]));
        }
        let sums: Vec<u64> = (0..36).collect();
        add_rows(&mut film, 1, &sums);
        for (half, begin) in film.halves().iter().zip([0, 18]) {
            for (pixel, sum) in half.iter().enumerate() {
                let first = 1000 + begin + 3 * (pixel as u64).saturating_sub(3);
                let expected =
                    if (3..9).contains(&pixel) { [first, first + 1, first + 2] } else { [1000; 3] };
                assert_eq!(sum.0, expected, "pixel {pixel}");
            }
        }
    }

    #[test]
    fn words_beyond_the_last_pixel_are_left_out() {
        let mut film = Film::new(1, 2, 1);
        add_rows(&mut film, 1, &[1, 2, 3, 99]);
        assert_eq!(film.halves()[0], [PixelSum([0; 3]), PixelSum([1, 2, 3])]);
        // More pixels than a thread takes at a time.
        let mut film = Film::new(5000, 1, 1);
        add_rows(&mut film, 0, &(0..15_000).collect::<Vec<u64>>());
        let expected = |pixel: u64| [3 * pixel, 3 * pixel + 1, 3 * pixel + 2];
        assert!((0..).zip(&film.halves()[0]).all(|(pixel, sum)| sum.0 == expected(pixel)));
    }
}
