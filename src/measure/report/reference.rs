//! Reference pictures, and the errors measured against them.

use super::data::ReferenceUsed;
use crate::film::{Description, Film, checkpoint, key};
use crate::job::recipe::{Recipe, file};
use crate::job::render::{RenderError, RenderJob, RenderSettings, Renderer, SamplerKind};
use crate::job::saved;
use crate::numbers::statistics::flip::Appearance;
use crate::progressive::PassSizer;
use crate::stages::Transfer;
use anyhow::{Context, Result, anyhow, bail};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Seed of the references. No measured picture uses it, so none shares random numbers with its reference.
const SEED: u32 = 0x5EED_0000;

/// Duration of a reference's pass, between updates of progress and checks for Ctrl-C.
const PASS: Duration = Duration::from_millis(500);

/// A picture that errors are measured against.
pub struct ReferencePicture {
    pub used: ReferenceUsed,
    means: Vec<[f64; 3]>,
    appearance: Appearance,
    transfer: Transfer,
    width: u32,
    height: u32,
}

/// See the fields of [`super::data::Measured`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    pub mse: f64,
    pub rel_mse: f64,
    pub flip: f64,
}

impl ReferencePicture {
    /// Uses a film as the reference of a scene. Fails if the film has no error estimate.
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

    /// The errors of a picture of equal size, from its pixel means: linear RGB, row by row from the top.
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

/// Pixel means of a film: linear RGB, row by row from the top.
pub fn film_means(film: &Film) -> Vec<[f64; 3]> {
    (0..film.halves()[0].len()).map(|pixel| film.mean(pixel)).collect()
}

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

/// The recipe of a scene's reference.
fn recipe_of(recipe: &Recipe) -> Recipe {
    let settings =
        RenderSettings { seed: SEED, sampler: SamplerKind::Sobol, estimate_error: true, ..recipe.settings };
    Recipe { settings, ..recipe.clone() }
}

/// Renders the reference, or continues the part of it in `path`. `go_on` receives the share done; if it returns false,
/// the result is `None` and the film is kept.
///
/// Fails if the renderer fails (keeping the film unless it is spoiled), if `path` holds something other than a film, or
/// if the film cannot be written.
pub fn make(
    renderer: &mut dyn Renderer,
    path: &Path,
    recipe: &Recipe,
    samples: u64,
    mut go_on: impl FnMut(f64) -> bool,
) -> Result<Option<ReferencePicture>> {
    let recipe = recipe_of(recipe);
    let job = recipe.job()?;
    let info = renderer.info();
    let about = format!("{} {}", info.name, info.device);
    let mut film = kept(path, &job, &about)?.unwrap_or_else(|| job.new_film());
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
    let is_spoiled = matches!(outcome, Err(RenderError::FilmLost { .. } | RenderError::Cancelled));
    if film.sample_count() > before && !is_spoiled {
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

/// The film in `path`, if it is of this job and backend. Anything unreadable there is an error and is not replaced,
/// because it may be worth hours.
fn kept(path: &Path, job: &RenderJob, about: &str) -> Result<Option<Film>> {
    if path.symlink_metadata().is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound) {
        return Ok(None);
    }
    let (theirs, read) = saved::open_film(path)
        .map_err(|error| anyhow!("{error}; the reference would be written there, so move that file away"))?;
    let is_same = theirs == *job && read.backend.as_deref() == Some(about);
    Ok(is_same.then_some(read.film))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cpu, small};
    use super::*;
    use crate::backends::{self, BackendChoice};
    use crate::film::fixed_point;
    use std::path::PathBuf;
    use tempfile::TempDir;

    fn place() -> (TempDir, PathBuf) {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("reference.exr");
        (directory, path)
    }

    fn made(path: &Path, choice: &BackendChoice, samples: u64) -> Result<ReferencePicture> {
        let mut renderer = backends::create(choice).unwrap();
        make(renderer.as_mut(), path, &small(), samples, |_| true).map(Option::unwrap)
    }

    /// The measured error combines those of reference and picture, which are independent.
    #[test]
    fn errors_exclude_reference_error() {
        let mut film = Film::new(16, 9, 2);
        for (half, radiance) in film.halves_mut().iter_mut().zip([0.25, 0.75]) {
            half.iter_mut().for_each(|sum| sum.add(fixed_point([radiance; 3]).unwrap()));
        }
        film.record(0..2, 0).unwrap();
        let reference = ReferencePicture::of_film("grey", "", &film, Transfer::Linear).unwrap();
        // The mean is 0.5, and the error a quarter of the halves' squared difference.
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        assert!(near(reference.used.mse, 0.0625) && near(reference.used.rel_mse, 0.0625 / 0.26));
        let errors = reference.errors(&[[1.0; 3]; 16 * 9]);
        assert!(near(errors.mse, 0.25 - 0.0625), "{errors:?}");
        assert!(near(errors.rel_mse, (0.25 - 0.0625) / 0.26) && errors.flip > 0.0, "{errors:?}");
        // A picture closer than the reference can be has a negative error.
        let errors = reference.errors(&film_means(&film));
        assert!(near(errors.mse, -0.0625) && errors.flip == 0.0, "{errors:?}");
    }

    #[test]
    fn flip_uses_display_values() {
        let pixels = [[0.25; 3], [4.0; 3], [-1.0; 3], [0.25; 3]];
        let equals = |transfer: Transfer, shown: [f64; 4]| {
            let shown = shown.map(|x| [x; 3]);
            appearance(&pixels, transfer, 2, 2).difference(&Appearance::of(2, &shown)) < 1e-9
        };
        assert!(equals(Transfer::Linear, [0.25, 1.0, 0.0, 0.25]));
        assert!(equals(Transfer::Gamma2, [0.5, 1.0, 0.0, 0.5]));
        assert!(equals(Transfer::LinearAboveGamma2, [0.25, 1.0, 0.0, 0.5]));
        assert!(!equals(Transfer::Gamma2, [0.25, 1.0, 0.0, 0.5]));
    }

    #[test]
    fn failed_backend_keeps_film() {
        let (_directory, path) = place();
        made(&path, &cpu(None), 2).unwrap();
        let error = made(&path, &cpu(Some(0)), 8).err().unwrap();
        assert!(error.to_string().contains("panicked"), "{error}");
        assert_eq!(checkpoint::load(&path).unwrap().film.sample_count(), 2);
    }

    #[test]
    fn foreign_file_is_not_replaced() {
        let (_directory, path) = place();
        std::fs::write(&path, "no film").unwrap();
        let error = made(&path, &cpu(None), 4).err().unwrap().to_string();
        assert!(error.contains("reference.exr") && error.contains("move that file away"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"no film");
    }

    #[test]
    fn only_same_backend_continues_film() {
        let (_directory, path) = place();
        let exact = BackendChoice::Reference { threads: Some(1) };
        let job = recipe_of(&small()).job().unwrap();
        for (choice, samples) in [(cpu(None), 2), (cpu(None), 6), (exact.clone(), 4), (exact, 8)] {
            made(&path, &choice, samples).unwrap();
            let mut film = job.new_film();
            let mut renderer = backends::create(&choice).unwrap();
            renderer.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
            let kept = checkpoint::load(&path).unwrap();
            assert!(kept.film == film, "{choice:?}, {samples}");
            let text = |key| kept.description.get(key).unwrap_or_default();
            assert_eq!((text(key::SCENE), text(key::SAMPLES)), ("metals", samples.to_string().as_str()));
        }
    }
}
