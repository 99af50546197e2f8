//! The reference pictures against which errors are measured, and the errors.

use super::data::ReferenceUsed;
use crate::film::Film;
use crate::recipe::Recipe;
use crate::render::{RenderSettings, SamplerKind};
use crate::saved;
use crate::stages::Transfer;
use crate::statistics::flip::Appearance;
use anyhow::{Result, bail};
use std::path::Path;

/// Seed of the references. No picture of a report uses it, so none shares random numbers with its reference.
const SEED: u32 = 0x5EED_0000;

/// A seed to recommend for a reference film.
const FREE_SEED: u32 = 900;

/// A picture relative to which errors are measured.
pub struct ReferencePicture {
    /// Its entry in the report.
    pub used: ReferenceUsed,
    means: Vec<[f64; 3]>,
    appearance: Appearance,
    transfer: Transfer,
    width: u32,
    height: u32,
}

/// The errors of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// See [`super::data::Measured::mse`].
    pub mse: f64,
    /// See [`super::data::Measured::rel_mse`].
    pub rel_mse: f64,
    /// See [`super::data::Measured::flip`].
    pub flip: f64,
}

impl ReferencePicture {
    /// Uses a film as the reference of the scene `scene`.
    ///
    /// # Errors
    /// If the film has no estimate of its own error.
    pub fn of_film(scene: &str, about: &str, film: &Film, transfer: Transfer) -> Result<Self> {
        let Some(own) = film.error() else {
            bail!(
                "the error of the reference of {scene} is unknown, because {}; render it with --estimate-error on, and with \
                 more samples if it is black",
                film.why_no_error()
            );
        };
        let means = film_means(film);
        let (width, height) = (film.width(), film.height());
        Ok(ReferencePicture {
            appearance: appearance(&means, transfer, width, height),
            means,
            transfer,
            width,
            height,
            used: ReferenceUsed {
                scene: scene.to_owned(),
                about: about.to_owned(),
                samples: film.sample_count(),
                mse: own.rmse.powi(2),
                rel_mse: own.rel_mse,
            },
        })
    }

    /// The errors of a picture of the same size; the means are linear RGB, row by row from the top.
    pub fn errors(&self, means: &[[f64; 3]]) -> Errors {
        let (mut squares, mut relative) = (0.0, 0.0);
        for (x, expected) in means.iter().flatten().zip(self.means.iter().flatten()) {
            let square = (x - expected).powi(2);
            squares += square;
            relative += square / (expected * expected + 1e-2);
        }
        let count = (3 * means.len()) as f64;
        let shown = appearance(means, self.transfer, self.width, self.height);
        Errors {
            mse: squares / count - self.used.mse,
            rel_mse: relative / count - self.used.rel_mse,
            flip: self.appearance.difference(&shown),
        }
    }
}

/// The mean of each pixel of a film, linear RGB, row by row from the top.
pub fn film_means(film: &Film) -> Vec<[f64; 3]> {
    (0..film.halves()[0].len()).map(|pixel| film.mean(pixel)).collect()
}

/// The picture as a display shows it.
fn appearance(means: &[[f64; 3]], transfer: Transfer, width: u32, height: u32) -> Appearance {
    let shown: Vec<[f64; 3]> = means
        .iter()
        .enumerate()
        .map(|(pixel, linear)| {
            let is_gamma = transfer.is_gamma(pixel / width as usize, height as usize);
            linear.map(|x| if is_gamma { x.max(0.0).sqrt().min(1.0) } else { x.clamp(0.0, 1.0) })
        })
        .collect();
    Appearance::of(width as usize, &shown)
}

/// The recipe of the reference for a scene.
pub fn recipe_of(recipe: &Recipe) -> Recipe {
    let settings =
        RenderSettings { seed: SEED, sampler: SamplerKind::Sobol, estimate_error: true, ..recipe.settings };
    Recipe { settings, ..recipe.clone() }
}

/// Reads an existing film as the reference of a scene, whose measured pictures have these samplers, each with the seeds
/// from 0 up to `seeds`.
///
/// # Errors
/// If it is the film of another picture, or has the random numbers of a measured one.
pub fn read(path: &Path, recipe: &Recipe, samplers: &[SamplerKind], seeds: u32) -> Result<ReferencePicture> {
    let (theirs, read) = saved::open_film(path)?;
    let mine = recipe_of(recipe).job()?;
    let is_same = theirs.scene() == mine.scene()
        && theirs.camera() == mine.camera()
        && theirs.rules() == mine.rules()
        && theirs.settings().max_depth == mine.settings().max_depth
        && (read.film.width(), read.film.height()) == (mine.settings().width, mine.settings().height);
    if !is_same {
        bail!(
            "{} is not a picture of {} at {}x{}; name its scene and its --size or leave out --reference",
            path.display(),
            recipe.name,
            recipe.settings.width,
            recipe.settings.height
        );
    }
    let RenderSettings { seed, sampler, .. } = *theirs.settings();
    if seed < seeds && samplers.contains(&sampler) {
        bail!(
            "{} has seed {seed} and sampler {}, as has a picture to measure (seeds 0 to {}), so their errors would \
             cancel; render the reference with --seed {}, or leave out --reference",
            path.display(),
            sampler.name(),
            seeds - 1,
            seeds.max(FREE_SEED)
        );
    }
    let about = read.backend.as_deref().unwrap_or("unknown");
    ReferencePicture::of_film(&recipe.name, about, &read.film, recipe.rules.transfer)
}

#[cfg(test)]
mod tests {
    use super::super::rendered::make;
    use super::super::tests::{cpu, place, small};
    use super::*;
    use crate::film::{Description, checkpoint, fixed_point};
    use crate::recipe::file;
    use crate::stages::Diffuse;
    use glam::DVec3;

    #[test]
    fn only_a_film_of_the_same_paths_is_a_reference() {
        let (_directory, path) = place();
        let recipe = small();
        let made = make(&path, &recipe, &cpu(None), 2, |_| true).unwrap().unwrap();
        let read = |recipe: &Recipe| read(&path, recipe, &[SamplerKind::Sobol], 8);
        assert_eq!(read(&recipe).unwrap().used, made.used);
        assert_eq!((made.used.scene.as_str(), made.used.samples), ("metals", 2));
        assert!(made.used.about.starts_with("cpu "), "{}", made.used.about);
        let mut moved = recipe.clone();
        moved.camera.look_from += DVec3::new(0.25, 0.5, 1.0);
        let mut other = Recipe::find("three-spheres").unwrap();
        (other.settings, other.camera, other.rules) = (recipe.settings, recipe.camera, recipe.rules);
        assert!(other.scene != recipe.scene);
        let mut wider = recipe.clone();
        wider.settings.width += 1;
        let mut shorter = recipe.clone();
        shorter.settings.max_depth -= 1;
        let mut taller = recipe.clone();
        taller.settings.height += 1;
        let mut ruled = recipe.clone();
        ruled.rules.diffuse = Diffuse::Hemisphere;
        for (what, recipe) in [
            ("camera", moved),
            ("scene", other),
            ("width", wider),
            ("height", taller),
            ("depth", shorter),
            ("rules", ruled),
        ] {
            let error = read(&recipe).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.contains("is not a picture of"), "{what}: {error}");
        }
    }

    #[test]
    fn a_film_with_the_random_numbers_of_a_measured_picture_is_no_reference() {
        use SamplerKind::{Independent, Sobol};
        let (_directory, path) = place();
        let recipe = small();
        let told = |seed, sampler, samplers: &[SamplerKind], seeds| {
            let settings = RenderSettings { seed, sampler, estimate_error: true, ..recipe.settings };
            let theirs = Recipe { settings, ..recipe.clone() };
            let mut film = theirs.job().unwrap().new_film();
            film.halves_mut()[0][0].add(fixed_point([0.5; 3]).unwrap());
            film.record(0..2, 0).unwrap();
            checkpoint::save(&path, &film, &Description::new(&file::to_picture_toml(&theirs))).unwrap();
            read(&path, &recipe, samplers, seeds).err().map(|error| error.to_string())
        };
        for (seed, sampler, samplers, seeds) in [
            (8, Sobol, &[Sobol, Independent][..], 8),
            (0, Independent, &[Sobol], 8),
            (0, Sobol, &[Independent], 8),
            (900, Sobol, &[Sobol], 900),
        ] {
            assert_eq!(told(seed, sampler, samplers, seeds), None, "{seed} {sampler:?}");
        }
        for (seed, sampler, samplers, seeds, remedy) in [
            (0, Sobol, &[Sobol][..], 1, "--seed 900"),
            (7, Independent, &[Sobol, Independent], 8, "--seed 900"),
            (900, Sobol, &[Sobol], 901, "--seed 901"),
        ] {
            let told = told(seed, sampler, samplers, seeds).unwrap();
            assert!(told.contains(&format!("seed {seed} and sampler {}", sampler.name())), "{told}");
            assert!(told.contains(remedy), "{told}");
        }
    }

    #[test]
    fn errors_are_means_over_pixels_and_channels() {
        let mut film = Film::new(16, 9, 2);
        for half in film.halves_mut() {
            half.iter_mut().for_each(|sum| sum.add(fixed_point([0.5; 3]).unwrap()));
        }
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("grey", "", &film, Transfer::Linear).unwrap();
        let used = [reference.used.mse, reference.used.rel_mse];
        assert!(used.iter().all(|error| (0.0..1e-12).contains(error)), "rounding alone: {used:?}");
        let same = reference.errors(&film_means(&film));
        assert_eq!(same, Errors { mse: -used[0], rel_mse: -used[1], flip: 0.0 });
        let errors = reference.errors(&[[0.75; 3]; 16 * 9]);
        assert!((errors.mse - 0.0625).abs() < 1e-9, "{errors:?}");
        assert!((errors.rel_mse - 0.0625 / 0.26).abs() < 1e-9, "{errors:?}");
        assert!(errors.flip > 0.0, "{errors:?}");
    }

    /// Every error is that of the reference and of the picture together, as the two are independent.
    #[test]
    fn the_error_of_the_reference_is_subtracted() {
        let mut film = Film::new(16, 9, 2);
        for (half, radiance) in film.halves_mut().iter_mut().zip([0.25, 0.75]) {
            half.iter_mut().for_each(|sum| sum.add(fixed_point([radiance; 3]).unwrap()));
        }
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("grey", "", &film, Transfer::Linear).unwrap();
        // Its mean is 0.5, and its error a quarter of the squared difference of the halves.
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(near(reference.used.mse, 0.0625) && near(reference.used.rel_mse, 0.0625 / 0.26));
        let errors = reference.errors(&[[1.0; 3]; 16 * 9]);
        assert!(near(errors.mse, 0.25 - 0.0625), "{errors:?}");
        assert!(near(errors.rel_mse, (0.25 - 0.0625) / 0.26), "{errors:?}");
        // A picture that is nearer than the reference can be has a negative error.
        let errors = reference.errors(&film_means(&film));
        assert!(near(errors.mse, -0.0625) && near(errors.rel_mse, -0.0625 / 0.26), "{errors:?}");
    }

    #[test]
    fn what_is_shown_decides_how_different_pictures_look() {
        let pixels = [[0.25; 3], [4.0; 3], [-1.0; 3], [0.0; 3]];
        let equals = |transfer: Transfer, shown: [f64; 4]| {
            let shown = shown.map(|x| [x; 3]);
            appearance(&pixels, transfer, 2, 2).difference(&Appearance::of(2, &shown)) < 1e-9
        };
        assert!(equals(Transfer::Linear, [0.25, 1.0, 0.0, 0.0]));
        assert!(equals(Transfer::Gamma2, [0.5, 1.0, 0.0, 0.0]));
        assert!(!equals(Transfer::Gamma2, [0.25, 1.0, 0.0, 0.0]));
        let pixels = [[0.25; 3]; 4];
        let split = appearance(&pixels, Transfer::LinearAboveGamma2, 2, 2);
        let expected = Appearance::of(2, &[[0.25; 3], [0.25; 3], [0.5; 3], [0.5; 3]]);
        assert!(split.difference(&expected) < 1e-9);
    }
}
