//! One of the two pictures: a film, a picture from any program, or a backend's render.

use crate::backends::{self, BackendChoice};
use crate::cli::CompareSide;
use crate::film::{Film, key};
use crate::memory;
use crate::output::{Encoding, read_picture};
use crate::recipe::Recipe;
use crate::render::{RenderJob, RenderSettings, Renderer};
use crate::saved::{OpenError, Saved};
use anyhow::{Context, Result};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// One of the two pictures.
#[derive(Debug)]
pub struct Side {
    /// The file's or backend's name.
    pub name: String,
    /// What is known about the picture, for the reader.
    pub about: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Linear RGB, row by row from the top. With `steps`, NaN means that the value is not known.
    pub pixels: Vec<[f64; 3]>,
    /// See [`crate::output::ReadPicture::steps`].
    pub steps: Option<Vec<[f64; 3]>>,
    /// See [`crate::output::ReadPicture::limit`].
    pub limit: f64,
    /// The film, if the picture is one.
    pub film: Option<Arc<Film>>,
    /// The film's job.
    pub job: Option<RenderJob>,
    /// The recipe that the file contains.
    pub recipe: Option<Recipe>,
}

impl Side {
    /// Reads a file. `encoding` is that of integer pictures without a description.
    ///
    /// # Errors
    /// If the file cannot be read; the message says what to do.
    pub fn read(path: &Path, encoding: Encoding) -> Result<Self> {
        let name = path.display().to_string();
        let saved = match Saved::read(path) {
            Ok(saved) => Some(saved),
            // Most pictures have no description. The picture itself is read below, which reports its own errors.
            Err(OpenError::Picture(_)) => None,
            Err(error) => return Err(error.into()),
        };
        // Pixels can be compared even if the recipe is not valid.
        let recipe = saved.as_ref().and_then(|saved| saved.recipe().ok());
        let samples = samples_of(saved.as_ref());
        if let Some(film) = saved.and_then(|saved| saved.film) {
            check_memory(film.width(), film.height(), 0)?;
            let job = recipe.as_ref().and_then(|recipe| recipe.job().ok());
            let about = format!("film, {}", about_film(&film, recipe.as_ref()));
            return Ok(Side { recipe, job, ..Side::of_film(name, about, film) });
        }
        let encoding = recipe.as_ref().map_or(encoding, |recipe| Encoding::Book(recipe.rules.transfer));
        let picture = read_picture(path, encoding)?;
        let kind = if picture.steps.is_some() { "integers" } else { "floats" };
        Ok(Side {
            about: format!("picture, {}x{}, {kind}{samples}", picture.width, picture.height),
            name,
            width: picture.width,
            height: picture.height,
            pixels: picture.pixels,
            steps: picture.steps,
            limit: picture.limit,
            film: None,
            job: None,
            recipe,
        })
    }

    /// The side of a film.
    pub fn of_film(name: String, about: String, film: impl Into<Arc<Film>>) -> Self {
        let film = film.into();
        let (width, height) = (film.width(), film.height());
        let pixels = (0..width as usize * height as usize).map(|pixel| film.mean(pixel)).collect();
        let limit = f64::INFINITY;
        Side {
            name,
            about,
            width,
            height,
            pixels,
            steps: None,
            limit,
            film: Some(film),
            job: None,
            recipe: None,
        }
    }

    /// The side of a film that the program itself has rendered from `recipe`.
    ///
    /// # Errors
    /// If a comparison of this size does not fit into memory.
    pub fn of_rendered(name: String, recipe: Recipe, film: Arc<Film>) -> Result<Self> {
        check_memory(film.width(), film.height(), 0)?;
        let about = format!("film, {}", about_film(&film, Some(&recipe)));
        Ok(Side { job: recipe.job().ok(), recipe: Some(recipe), ..Side::of_film(name, about, film) })
    }
}

/// Bytes per pixel during a comparison, without films: both pictures, their difference with its noise and steps, the
/// bounds of the difference, and the heat map.
const BYTES_PER_PIXEL: u64 = 6 * 24 + 8;

/// Refuses pictures that do not fit into memory together with `films` films of two halves.
///
/// # Errors
/// If they do not fit; the message says how much is needed, how much there is and what to do.
pub(super) fn check_memory(width: u32, height: u32, films: u64) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    let bytes = films * Film::bytes(width, height, 2) + pixels * BYTES_PER_PIXEL;
    let what = || format!("comparing pictures of {width}x{height}");
    Ok(memory::check(what, bytes, "compare smaller pictures (--size sets the size of rendered ones)")?)
}

/// An empty film for a job.
///
/// # Errors
/// If there is no memory for it.
pub(super) fn new_film(job: &RenderJob) -> Result<Film> {
    let RenderSettings { width, height, .. } = *job.settings();
    Ok(Film::try_new(width, height, job.settings().half_count())?)
}

fn samples_of(saved: Option<&Saved>) -> String {
    let samples = saved.and_then(|saved| saved.description.get(key::SAMPLES));
    samples.map_or_else(String::new, |samples| format!(", {samples} samples"))
}

fn about_film(film: &Film, recipe: Option<&Recipe>) -> String {
    let size = format!("{}x{}, {} samples", film.width(), film.height(), film.sample_count());
    match recipe {
        Some(Recipe { name, settings, .. }) => {
            format!("{name}, {size}, {}, seed {}", settings.sampler.name(), settings.seed)
        }
        None => size,
    }
}

/// A backend that renders a side.
pub struct Rendering {
    name: String,
    renderer: Box<dyn Renderer>,
}

impl Rendering {
    /// Starts a backend.
    ///
    /// # Errors
    /// If the backend is not available.
    pub fn start(choice: &BackendChoice, name: &str) -> Result<Self> {
        let renderer = backends::create(choice).with_context(|| format!("{name} is not available"))?;
        Ok(Rendering { name: name.to_owned(), renderer })
    }

    /// Renders one sample of every pixel.
    pub fn sample(&mut self, job: &RenderJob, index: u64) -> Result<Film> {
        self.samples(job, index..index + 1)
    }

    fn samples(&mut self, job: &RenderJob, range: std::ops::Range<u64>) -> Result<Film> {
        let mut film = new_film(job)?;
        self.renderer.accumulate(job, range, &mut film, &AtomicBool::new(false))?;
        Ok(film)
    }

    /// The side of a film that this backend rendered.
    pub fn side(&self, recipe: &Recipe, job: &RenderJob, film: Film) -> Side {
        let info = self.renderer.info();
        let about = format!("{} {}, {}", info.name, info.device, about_film(&film, Some(recipe)));
        Side {
            job: Some(job.clone()),
            recipe: Some(recipe.clone()),
            ..Side::of_film(self.name.clone(), about, film)
        }
    }

    /// Renders the samples of `ranges`.
    ///
    /// # Errors
    /// If the backend fails.
    pub fn render(
        &mut self,
        recipe: &Recipe,
        job: &RenderJob,
        ranges: impl Iterator<Item = std::ops::Range<u64>>,
    ) -> Result<Side> {
        let mut film = new_film(job)?;
        for range in ranges {
            film.merge(&self.samples(job, range)?)?;
        }
        Ok(self.side(recipe, job, film))
    }
}

/// A side that was read, or a backend that waits for the scene and size of the other side.
pub enum OpenedSide {
    /// Read from a file.
    Read(Box<Side>),
    /// To be rendered.
    Backend(Box<Rendering>),
}

impl OpenedSide {
    /// Reads the file or starts the backend.
    ///
    /// # Errors
    /// If the file cannot be read or the backend is not available.
    pub fn open(side: &CompareSide, encoding: Encoding) -> Result<Self> {
        Ok(match side {
            CompareSide::File(path) => OpenedSide::Read(Box::new(Side::read(path, encoding)?)),
            CompareSide::Backend { name, choice } => {
                OpenedSide::Backend(Box::new(Rendering::start(choice, name)?))
            }
        })
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_do_not_fit_into_memory_are_refused() {
        check_memory(400, 225, 2).unwrap();
        let refused = check_memory(1 << 22, 1 << 22, 0).unwrap_err().to_string();
        assert!(refused.starts_with("comparing pictures of 4194304x4194304 needs "), "{refused}");
    }

    #[test]
    fn films_of_two_halves_count_beside_what_every_comparison_needs() {
        // 2^40 pixels of 152 bytes, or of that and films of 48, and 64 MiB for everything else.
        for (films, needed) in [(0, "167125.8 GB"), (2, "272679.0 GB"), (4, "378232.1 GB")] {
            let refused = check_memory(1 << 20, 1 << 20, films).unwrap_err().to_string();
            assert!(refused.contains(&format!(" needs {needed} of memory")), "{films}: {refused}");
        }
    }
}
