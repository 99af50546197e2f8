//! The film's sums on their way from the device into the film on the host.

use super::failed;
use crate::film::Film;
use crate::render::RenderError;
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
