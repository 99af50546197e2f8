//! Finds the path that differs most.

use super::compare::radiance_amount;
use super::side::Side;
use crate::render::{RenderError, RenderJob};

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Index of the sample.
    pub sample: u64,
    /// Number of samples per pixel that were searched.
    pub searched: u64,
    /// Number of samples, over all pixels, that differ by more than the tolerance.
    pub differing: u64,
}

/// Searches samples `0 .. samples` of all pixels for the one whose radiance differs most.
///
/// # Errors
/// [`RenderError`] of either side.
pub fn find(
    job: &RenderJob,
    sides: &mut [Side; 2],
    samples: u64,
    tolerance: f64,
) -> Result<Found, RenderError> {
    let mut found = Found { pixel: [0, 0], sample: 0, searched: samples, differing: 0 };
    let mut most = 0.0;
    for sample in 0..samples {
        let [a, b] = sides;
        let films = [a.film(job, sample)?, b.film(job, sample)?];
        let width = films[0].width() as usize;
        for pixel in 0..width * films[0].height() as usize {
            let [a, b] = [0, 1].map(|side| films[side].pixel_sum(pixel).radiance());
            found.differing += u64::from(radiance_amount(a, b) > tolerance);
            let by = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
            if by > most {
                most = by;
                (found.pixel, found.sample) = ([(pixel % width) as u32, (pixel / width) as u32], sample);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::SideChoice;
    use crate::recipe::Recipe;
    use crate::render_cpu::{CpuOptions, Isa};

    fn sides(choices: [SideChoice; 2]) -> [Side; 2] {
        choices.map(|choice| Side::open(&choice).unwrap())
    }

    fn portable() -> SideChoice {
        let isa = Some(Isa::Portable);
        SideChoice::Cpu(CpuOptions { isa, threads: Some(1), ..CpuOptions::default() })
    }

    fn job() -> RenderJob {
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (12, 7);
        recipe.job().unwrap()
    }

    /// Looks at each path by itself.
    #[test]
    fn the_sample_that_differs_most_is_found_in_its_pixel() {
        let (job, tolerance) = (job(), 0.0);
        let mut sides = sides([portable(), SideChoice::Reference]);
        let (mut most, mut expected, mut differing) = (0.0, None, 0);
        for sample in 0..3 {
            for pixel in (0..7).flat_map(|y| (0..12).map(move |x| [x, y])) {
                let [a, b] = sides.each_mut().map(|side| side.record(&job, pixel, sample).unwrap().radiance);
                let by = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
                differing += u64::from(radiance_amount(a, b) > tolerance);
                if by > most {
                    (most, expected) = (by, Some((pixel, sample)));
                }
            }
        }
        let (pixel, sample) = expected.unwrap();
        assert!(0 < differing && differing < 3 * 7 * 12, "{differing}");
        let found = find(&job, &mut sides, 3, tolerance).unwrap();
        assert_eq!(found, Found { pixel, sample, searched: 3, differing });
        // With a larger tolerance fewer samples differ, but the largest difference is the same.
        let found = find(&job, &mut sides, 3, f64::INFINITY).unwrap();
        assert_eq!(found, Found { pixel, sample, searched: 3, differing: 0 });
    }

    #[test]
    fn between_equal_sides_no_sample_differs() {
        let found = find(&job(), &mut sides([portable(), portable()]), 2, 0.0).unwrap();
        assert_eq!(found, Found { pixel: [0, 0], sample: 0, searched: 2, differing: 0 });
    }
}
