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
            means: film.exact_means().collect(),
            used: ReferenceUsed {
                scene: scene.to_owned(),
                about: about.to_owned(),
                samples: film.sample_count(),
                mse: own.rmse.powi(2),
                rel_mse: own.rel_mse,
            },
        })
    }

    /// Mean squared error and relative one of a film of equal size, without the reference's own.
    pub fn errors(&self, film: &Film) -> [f64; 2] {
        let (mut squares, mut relative) = (0.0, 0.0);
        for (mean, expected) in film.exact_means().zip(&self.means) {
            for (x, expected) in mean.iter().zip(expected) {
                let square = (x - expected).powi(2);
                squares += square;
                relative += square / (expected * expected + 1e-2);
            }
        }
        let count = (3 * self.means.len()) as f64;
        [squares / count - self.used.mse, relative / count - self.used.rel_mse]
    }
}

/// The job of a reference, or of a picture that is compared with one.
pub fn job_of(recipe: &Recipe, sampler: SamplerKind, seed: u32) -> Result<RenderJob> {
    let settings = RenderSettings { sampler, seed, ..recipe.settings };
    Ok(Recipe { settings, ..recipe.clone() }.job()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::fixed_point;

    /// The measured error combines those of reference and picture, which are independent.
    #[test]
    fn errors_exclude_reference_error() {
        let mut film = Film::new(16, 9);
        for (half, radiance) in film.halves_mut().iter_mut().zip([0.25, 0.75]) {
            half.iter_mut().for_each(|sum| sum.add(fixed_point([radiance; 3]).unwrap()));
        }
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("grey", "", &film).unwrap();
        // The mean is 0.5, and the error a quarter of the halves' squared difference.
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(near(reference.used.mse, 0.0625) && near(reference.used.rel_mse, 0.0625 / 0.26));
        let mut white = Film::new(16, 9);
        white.halves_mut()[0].fill(fixed_point([1.0; 3]).unwrap());
        white.record(0..1, 0).unwrap();
        let [mse, rel_mse] = reference.errors(&white);
        assert!(near(mse, 0.25 - 0.0625) && near(rel_mse, (0.25 - 0.0625) / 0.26), "{mse} {rel_mse}");
        // A picture closer than the reference can be has a negative error.
        assert!(near(reference.errors(&film)[0], -0.0625));
    }
}
