//! Reference pictures, and the errors measured against them.

use super::data::ReferenceUsed;
use crate::film::Film;
use crate::job::recipe::Recipe;
use crate::job::render::{RenderJob, RenderSettings, SamplerKind};
use anyhow::{Result, bail};

/// Seed of the references. No measured picture uses it, so none shares random numbers with its reference.
pub const SEED: u32 = 0x5EED_0000;

/// A picture that errors are measured against.
pub struct ReferencePicture {
    pub used: ReferenceUsed,
    means: Vec<[f64; 3]>,
}

/// See the fields of [`super::data::Measured`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    pub mse: f64,
    pub rel_mse: f64,
}

impl ReferencePicture {
    /// Uses a film as the reference of a scene. Fails if the film has no error estimate.
    pub fn of_film(scene: &str, about: &str, film: &Film) -> Result<Self> {
        let Some(own) = film.error() else {
            bail!(
                "the error of the reference of {scene} is unknown, because {}; choose a brighter scene, or more \
                 --reference-samples",
                film.why_no_error()
            );
        };
        Ok(ReferencePicture {
            means: film_means(film),
            used: ReferenceUsed {
                scene: scene.to_owned(),
                about: about.to_owned(),
                samples: film.sample_count(),
                mse: own.rmse.powi(2),
                rel_mse: own.rel_mse,
            },
        })
    }

    /// The errors of a picture of equal size, from its pixel means: linear RGB, row by row from the top.
    pub fn errors(&self, means: &[[f64; 3]]) -> Errors {
        let (mut squares, mut relative) = (0.0, 0.0);
        for (x, expected) in means.iter().flatten().zip(self.means.iter().flatten()) {
            let square = (x - expected).powi(2);
            squares += square;
            relative += square / (expected * expected + 1e-2);
        }
        let count = (3 * means.len()) as f64;
        Errors { mse: squares / count - self.used.mse, rel_mse: relative / count - self.used.rel_mse }
    }
}

/// Pixel means of a film: linear RGB, row by row from the top.
pub fn film_means(film: &Film) -> Vec<[f64; 3]> {
    (0..film.halves()[0].len()).map(|pixel| film.mean(pixel)).collect()
}

/// The job of a reference, or of a picture that is compared with one.
pub fn job_of(recipe: &Recipe, sampler: SamplerKind, seed: u32) -> Result<RenderJob> {
    let settings = RenderSettings { sampler, seed, estimate_error: true, ..recipe.settings };
    Ok(Recipe { settings, ..recipe.clone() }.job()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::fixed_point;

    /// The measured error combines those of reference and picture, which are independent.
    #[test]
    fn errors_exclude_reference_error() {
        let mut film = Film::new(16, 9, 2);
        for (half, radiance) in film.halves_mut().iter_mut().zip([0.25, 0.75]) {
            half.iter_mut().for_each(|sum| sum.add(fixed_point([radiance; 3]).unwrap()));
        }
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("grey", "", &film).unwrap();
        // The mean is 0.5, and the error a quarter of the halves' squared difference.
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(near(reference.used.mse, 0.0625) && near(reference.used.rel_mse, 0.0625 / 0.26));
        let errors = reference.errors(&[[1.0; 3]; 16 * 9]);
        assert!(near(errors.mse, 0.25 - 0.0625), "{errors:?}");
        assert!(near(errors.rel_mse, (0.25 - 0.0625) / 0.26), "{errors:?}");
        // A picture closer than the reference can be has a negative error.
        let errors = reference.errors(&film_means(&film));
        assert!(near(errors.mse, -0.0625), "{errors:?}");
    }
}
