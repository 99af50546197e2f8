//! Renders reference pictures, or continues those that are there in part.

use super::reference::{ReferencePicture, recipe_of};
use crate::backends::{self, BackendChoice};
use crate::film::{Description, Film, checkpoint, key};
use crate::progressive::PassSizer;
use crate::recipe::{Recipe, file};
use crate::render::{RenderError, RenderJob, Renderer};
use crate::saved;
use anyhow::{Context, Result, anyhow};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Duration of a pass of a reference; progress is shown and Ctrl-C is noticed between passes.
const PASS: Duration = Duration::from_millis(500);

/// Renders the reference, or continues the part of it in `path`. `go_on` receives the fraction that is done; if it
/// returns false, the result is `None` and the film is kept.
///
/// # Errors
/// If the backend fails, in which case the film is kept unless it is spoiled; if `path` is something that cannot be read
/// as a film; or if the film cannot be written.
pub fn make(
    path: &Path,
    recipe: &Recipe,
    choice: &BackendChoice,
    samples: u64,
    go_on: impl FnMut(f64) -> bool,
) -> Result<Option<ReferencePicture>> {
    make_with(backends::create(choice)?.as_mut(), path, recipe, samples, go_on)
}

fn make_with(
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

/// The film in `path`, if there is one of this job and backend.
///
/// # Errors
/// If something else is there that cannot be read as a film: it might be worth hours, so it is not replaced.
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
    use super::super::tests::{cpu, place, small};
    use super::*;
    use crate::render::{BackendInfo, Stats};
    use std::ops::Range;

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

    /// A renderer of black pictures whose film is spoiled by the second pass.
    struct Spoiling;

    impl Renderer for Spoiling {
        fn info(&self) -> BackendInfo {
            BackendInfo { name: "spoiling", device: String::new(), lanes: 1, threads: 1 }
        }

        fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
            Ok(())
        }

        fn accumulate(
            &mut self,
            _: &RenderJob,
            samples: Range<u64>,
            film: &mut Film,
            _: &AtomicBool,
        ) -> Result<Stats, RenderError> {
            if film.sample_count() > 0 {
                film.halves_mut()[0][0].0 = [1; 3];
                return Err(RenderError::FilmLost { backend: "spoiling", reason: "a slip".to_owned() });
            }
            film.record(samples, 0)?;
            Ok(Stats::default())
        }
    }

    #[test]
    fn a_film_that_was_spoiled_is_not_kept() {
        let (_directory, path) = place();
        let error = make_with(&mut Spoiling, &path, &small(), 64, |_| true).err().unwrap();
        assert!(error.to_string().contains("spoiled the film"), "{error}");
        assert!(!path.exists());
    }

    #[test]
    fn what_is_no_film_is_not_replaced() {
        let (_directory, path) = place();
        make(&path, &small(), &cpu(None), 2, |_| true).unwrap().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() * 2 / 3;
        bytes[middle] ^= 0x10;
        for bytes in [bytes, b"no film".to_vec()] {
            std::fs::write(&path, &bytes).unwrap();
            let error = make(&path, &small(), &cpu(None), 4, |_| true).err().unwrap().to_string();
            assert!(error.contains("reference.exr") && error.contains("move that file away"), "{error}");
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
        }
    }

    #[test]
    fn the_film_of_another_backend_is_replaced() {
        let (_directory, path) = place();
        let exact = BackendChoice::Reference { threads: Some(1) };
        let job = recipe_of(&small()).job().unwrap();
        let film_of = |choice: &BackendChoice, samples: u64| {
            let mut film = job.new_film();
            let mut renderer = backends::create(choice).unwrap();
            renderer.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
            film
        };
        for (choice, samples, backend) in [
            (cpu(None), 2, "cpu "),
            (cpu(None), 6, "cpu "),
            (exact.clone(), 4, "reference f64"),
            (exact, 8, "reference f64"),
        ] {
            make(&path, &small(), &choice, samples, |_| true).unwrap().unwrap();
            let kept = checkpoint::load(&path).unwrap();
            assert!(kept.film == film_of(&choice, samples), "{backend}, {samples}");
            let told = |key| kept.description.get(key).unwrap_or_default();
            assert_eq!((told(key::SCENE), told(key::SAMPLES)), ("metals", samples.to_string().as_str()));
            assert!(told(key::BACKEND).starts_with(backend), "{}", told(key::BACKEND));
        }
    }

    #[test]
    fn the_film_of_another_picture_is_replaced() {
        let (_directory, path) = place();
        let mut other = small();
        other.settings.max_depth -= 1;
        for recipe in [&other, &small()] {
            make(&path, recipe, &cpu(None), 2, |_| true).unwrap().unwrap();
        }
        let kept = saved::open_film(&path).unwrap().0;
        assert_eq!(kept.settings().max_depth, small().settings.max_depth);
    }
}
