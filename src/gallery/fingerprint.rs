//! What decides whether a still must be rendered again.

use crate::film::Checksum;
use crate::recipe::{Recipe, file};
use crate::render::{RenderError, RenderSettings, Renderer};
use crate::render_cpu::{CpuError, CpuOptions, CpuRenderer, Isa};
use std::sync::atomic::AtomicBool;

/// Largest width of the small picture, pixels.
const WIDTH: u32 = 48;

/// Samples per pixel of the small picture: one of each half.
const SAMPLES: u64 = 2;

/// Makes fingerprints: checksums of a recipe and of a small picture that this program renders of it.
///
/// The recipe tells whether the settings have changed, and the small picture whether the sampler, a scene or the tracer
/// has. The small picture is always rendered by the plainest code of the CPU, so the fingerprint does not depend on the
/// backend.
pub struct Fingerprints(CpuRenderer);

impl Fingerprints {
    /// Starts a renderer.
    ///
    /// # Errors
    /// [`CpuError`] if its thread cannot be started.
    pub fn new() -> Result<Self, CpuError> {
        let options = CpuOptions {
            isa: Some(Isa::Portable),
            lanes: Some(1),
            threads: Some(1),
            ..CpuOptions::default()
        };
        CpuRenderer::new(options).map(Fingerprints)
    }

    /// The fingerprint of a recipe: 16 hexadecimal digits.
    ///
    /// # Errors
    /// If the small picture cannot be rendered.
    pub fn of(&mut self, recipe: &Recipe) -> Result<String, FingerprintError> {
        let RenderSettings { width, height, .. } = recipe.settings;
        let small = width.min(WIDTH);
        let settings = RenderSettings {
            width: small,
            height: (height * small / width).max(1),
            estimate_error: true,
            ..recipe.settings
        };
        let job = Recipe { settings, ..recipe.clone() }.job()?;
        let mut film = job.new_film();
        self.0.accumulate(&job, 0..SAMPLES, &mut film, &AtomicBool::new(false))?;
        let mut checksum = Checksum::default();
        checksum.text(file::to_toml(recipe).as_bytes());
        for sum in film.halves().iter().flatten() {
            sum.0.iter().for_each(|channel| checksum.word(*channel));
        }
        Ok(checksum.finish())
    }
}

/// Why there is no fingerprint of a recipe.
#[derive(Debug, thiserror::Error)]
pub enum FingerprintError {
    /// The recipe is not valid.
    #[error(transparent)]
    Job(#[from] crate::render::JobError),
    /// The small picture could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gallery::Quality;
    use crate::stages::Stage;
    use std::sync::Arc;

    #[test]
    fn every_change_of_a_picture_shows() {
        let mut fingerprints = Fingerprints::new().unwrap();
        let recipe = Quality::Quick.recipe(Stage::find("metal-fuzzy").unwrap());
        let own = fingerprints.of(&recipe).unwrap();
        assert_eq!(fingerprints.of(&recipe).unwrap(), own);
        let mut scene = (*recipe.scene).clone();
        scene.spheres[1].radius += 1e-9;
        let mut others = vec![
            Recipe { samples_per_pixel: 65, ..recipe.clone() },
            Recipe { scene: Arc::new(scene), ..recipe.clone() },
        ];
        others.push(recipe.clone());
        others[2].settings.seed = 1;
        others.push(recipe.clone());
        others[3].rules.transfer = crate::stages::Transfer::Linear;
        for other in &others {
            assert_ne!(fingerprints.of(other).unwrap(), own);
        }
        assert_eq!(fingerprints.of(&Recipe { name: "other".to_owned(), ..recipe }).unwrap(), own);
    }

    #[test]
    fn the_small_picture_counts_besides_the_recipe() {
        let mut fingerprints = Fingerprints::new().unwrap();
        let recipe = Quality::Quick.recipe(Stage::find("metal").unwrap());
        let mut text = Checksum::default();
        text.text(file::to_toml(&recipe).as_bytes());
        assert_ne!(fingerprints.of(&recipe).unwrap(), text.finish());
    }

    #[test]
    fn a_fingerprint_is_that_of_the_recipe_and_of_two_samples_of_a_picture_of_48_columns() {
        let recipe = Quality::Quick.recipe(Stage::find("metal").unwrap());
        assert_eq!((recipe.settings.width, recipe.settings.height), (480, 270));
        let mut small = recipe.clone();
        (small.settings.width, small.settings.height, small.settings.estimate_error) = (48, 27, true);
        let job = small.job().unwrap();
        let mut film = job.new_film();
        let plain = CpuOptions { isa: Some(Isa::Portable), lanes: Some(1), ..CpuOptions::default() };
        let mut renderer = CpuRenderer::new(plain).unwrap();
        renderer.accumulate(&job, 0..2, &mut film, &AtomicBool::new(false)).unwrap();
        let mut checksum = Checksum::default();
        checksum.text(file::to_toml(&recipe).as_bytes());
        for sum in film.halves().iter().flatten() {
            checksum.words(&sum.0);
        }
        assert_eq!(Fingerprints::new().unwrap().of(&recipe).unwrap(), checksum.finish());
    }

    #[test]
    fn a_very_flat_picture_has_a_fingerprint() {
        let mut recipe = Quality::Quick.recipe(Stage::find("metal").unwrap());
        (recipe.settings.width, recipe.settings.height) = (4 * WIDTH, 1);
        assert_eq!(Fingerprints::new().unwrap().of(&recipe).unwrap().len(), 16);
    }
}
