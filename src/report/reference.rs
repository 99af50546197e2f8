//! The reference pictures against which errors are measured, and the errors.

use super::data::ReferenceUsed;
use crate::backends::{self, BackendChoice};
use crate::film::{Description, Film, checkpoint, key};
use crate::progressive::PassSizer;
use crate::recipe::{Recipe, file};
use crate::render::{RenderJob, RenderSettings, SamplerKind};
use crate::saved;
use crate::stages::Transfer;
use crate::statistics::flip::Appearance;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Seed of the references. No picture of a report uses it, so none shares random numbers with its reference.
const SEED: u32 = 0x5EED_0000;

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
                "the reference of {scene} has only one half, so its own error is unknown; render it with --estimate-error on"
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

/// Reads an existing film as the reference of a scene.
///
/// # Errors
/// If it is the film of another picture.
pub fn read(path: &Path, recipe: &Recipe) -> Result<ReferencePicture> {
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
    let about = read.backend.as_deref().unwrap_or("unknown");
    ReferencePicture::of_film(&recipe.name, about, &read.film, recipe.rules.transfer)
}

/// Duration of a pass of a reference; progress is shown and Ctrl-C is noticed between passes.
const PASS: Duration = Duration::from_millis(500);

/// Renders the reference, or continues the part of it in `path`. `go_on` receives the fraction that is done; if it
/// returns false, the result is `None` and the film is kept.
///
/// # Errors
/// If the backend fails, in which case the film is kept, or if the film cannot be written.
pub fn make(
    path: &Path,
    recipe: &Recipe,
    choice: &BackendChoice,
    samples: u64,
    mut go_on: impl FnMut(f64) -> bool,
) -> Result<Option<ReferencePicture>> {
    let recipe = recipe_of(recipe);
    let job = recipe.job()?;
    let mut renderer = backends::create(choice)?;
    let info = renderer.info();
    let about = format!("{} {}", info.name, info.device);
    let mut film = kept(path, &job, &about).unwrap_or_else(|| job.new_film());
    let mut sizer = PassSizer::new(job.settings().half_count());
    let before = film.sample_count();
    let mut outcome = Ok(());
    while let Some(pass) = sizer.next(film.samples(), 0..samples, None) {
        if !go_on(film.sample_count() as f64 / samples as f64) {
            break;
        }
        let begin = Instant::now();
        let count = pass.end - pass.start;
        if let Err(error) = renderer.accumulate(&job, pass, &mut film, &AtomicBool::new(false)) {
            outcome = Err(error);
            break;
        }
        sizer.measured(count, begin.elapsed(), PASS);
    }
    if film.sample_count() > before {
        let mut description = Description::new(&file::to_picture_toml(&recipe));
        description.set(key::SCENE, &recipe.name);
        description.set(key::SAMPLES, film.sample_count());
        description.set(key::BACKEND, &about);
        checkpoint::save(path, &film, &description).context("cannot save the reference")?;
    }
    outcome?;
    if film.sample_count() < samples {
        return Ok(None);
    }
    ReferencePicture::of_film(&recipe.name, &about, &film, recipe.rules.transfer).map(Some)
}

/// The film in `path`, if it is of this job and backend.
fn kept(path: &Path, job: &RenderJob, about: &str) -> Option<Film> {
    let (theirs, read) = saved::open_film(path).ok()?;
    let is_same = theirs == *job && read.backend.as_deref() == Some(about);
    is_same.then_some(read.film)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::fixed_point;
    use crate::render_cpu::CpuOptions;
    use glam::DVec3;
    use std::path::PathBuf;
    use tempfile::TempDir;

    fn small() -> Recipe {
        let mut recipe = Recipe::find("metals").unwrap();
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        recipe
    }

    fn cpu(panics_after: Option<u64>) -> BackendChoice {
        BackendChoice::Cpu(CpuOptions { threads: Some(1), panics_after, ..CpuOptions::default() })
    }

    fn place() -> (TempDir, PathBuf) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("reference.exr");
        (directory, path)
    }

    #[test]
    fn only_a_film_of_the_same_paths_is_a_reference() {
        let (_directory, path) = place();
        let recipe = small();
        make(&path, &recipe, &cpu(None), 2, |_| true).unwrap().unwrap();
        assert_eq!(read(&path, &recipe).unwrap().used.samples, 2);
        let mut moved = recipe.clone();
        moved.camera.look_from += DVec3::new(0.25, 0.5, 1.0);
        let mut other = Recipe::find("three-spheres").unwrap();
        (other.settings, other.camera, other.rules) = (recipe.settings, recipe.camera, recipe.rules);
        assert!(other.scene != recipe.scene);
        let mut wider = recipe.clone();
        wider.settings.width += 1;
        let mut shorter = recipe.clone();
        shorter.settings.max_depth -= 1;
        for (what, recipe) in [("camera", moved), ("scene", other), ("size", wider), ("depth", shorter)] {
            let error = read(&path, &recipe).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.contains("is not a picture of"), "{what}: {error}");
        }
    }

    #[test]
    fn a_backend_that_fails_is_an_error_and_the_film_is_kept() {
        let (_directory, path) = place();
        let recipe = small();
        make(&path, &recipe, &cpu(None), 2, |_| true).unwrap().unwrap();
        let error = make(&path, &recipe, &cpu(Some(0)), 8, |_| true).err().unwrap();
        assert!(error.to_string().contains("panicked"), "{error}");
        assert_eq!(checkpoint::load(&path).unwrap().film.sample_count(), 2);
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
    fn passes_grow_and_progress_is_told_between_them() {
        let (_directory, path) = place();
        let mut told = Vec::new();
        let go_on = |share: f64| {
            told.push(share);
            true
        };
        make(&path, &small(), &cpu(None), 512, go_on).unwrap().unwrap();
        assert!(told.len() < 64, "{told:?}");
        assert_eq!((told[0], told[1]), (0.0, 2.0 / 512.0));
        assert!(told.is_sorted_by(|a, b| a < b) && told.iter().all(|share| *share < 1.0), "{told:?}");
        // A film that is large enough is not rendered again.
        let mut calls = 0;
        let again = make(&path, &small(), &cpu(None), 512, |_| {
            calls += 1;
            true
        });
        assert_eq!((again.unwrap().unwrap().used.samples, calls), (512, 0));
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
