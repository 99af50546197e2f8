//! One of the two pictures: a film, a picture of any program, or what a backend renders now.

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
use std::sync::atomic::AtomicBool;

/// A picture that is compared.
#[derive(Debug)]
pub struct Side {
    /// The file's or backend's name.
    pub name: String,
    /// What is known of it.
    pub about: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Linear RGB, row by row from the top; with `steps`, NaN where it is not known.
    pub pixels: Vec<[f64; 3]>,
    /// See [`crate::output::ReadPicture::steps`].
    pub steps: Option<Vec<[f64; 3]>>,
    /// See [`crate::output::ReadPicture::limit`].
    pub limit: f64,
    /// The film, where there is one.
    pub film: Option<Film>,
    /// The film's job.
    pub job: Option<RenderJob>,
    /// What the file says that it was made from.
    pub recipe: Option<Recipe>,
}

impl Side {
    /// Reads a file. Whole numbers without a description are taken as `encoding` says.
    ///
    /// # Errors
    /// A file that cannot be read, with what to do.
    pub fn read(path: &Path, encoding: Encoding) -> Result<Self> {
        let name = path.display().to_string();
        let saved = match Saved::read(path) {
            Ok(saved) => Some(saved),
            // Most pictures do not say what they are; the picture itself is read below, with its errors.
            Err(OpenError::Picture(_) | OpenError::NotFilm(_)) => None,
            Err(error) => return Err(error.into()),
        };
        // Numbers can be compared whatever is said of them.
        let recipe = saved.as_ref().and_then(|saved| saved.recipe().ok());
        let said = said(saved.as_ref());
        if let Some(film) = saved.and_then(|saved| saved.film) {
            check_memory(film.width(), film.height(), 0)?;
            let job = recipe.as_ref().and_then(|recipe| recipe.job().ok());
            let about = format!("film, {}", about_film(&film, recipe.as_ref()));
            return Ok(Side { recipe, job, ..Side::of_film(name, about, film) });
        }
        let encoding = recipe.as_ref().map_or(encoding, |recipe| Encoding::Book(recipe.rules.transfer));
        let picture = read_picture(path, encoding)?;
        let kind = if picture.steps.is_some() { "whole numbers" } else { "float" };
        Ok(Side {
            about: format!("picture, {}x{}, {kind}{said}", picture.width, picture.height),
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
    pub fn of_film(name: String, about: String, film: Film) -> Self {
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
}

/// What a pixel takes besides films while pictures are compared: both pictures, their difference, its noise and steps,
/// and the map of it.
const BYTES_PER_PIXEL: u64 = 5 * 24 + 8;

/// Refuses pictures that do not fit into memory together, with `films` films of two halves that are rendered.
///
/// # Errors
/// What is needed, what there is and what to do.
pub(super) fn check_memory(width: u32, height: u32, films: u64) -> Result<()> {
    let pixels = u64::from(width) * u64::from(height);
    let bytes = films * Film::bytes(width, height, 2) + pixels * BYTES_PER_PIXEL;
    let what = || format!("comparing pictures of {width}x{height}");
    Ok(memory::check(what, bytes, "compare smaller pictures (--size for those that are rendered)")?)
}

/// An empty film for a job.
///
/// # Errors
/// If there is no memory for it.
pub(super) fn new_film(job: &RenderJob) -> Result<Film> {
    let RenderSettings { width, height, .. } = *job.settings();
    Ok(Film::try_new(width, height, job.settings().half_count())?)
}

fn said(saved: Option<&Saved>) -> String {
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

/// A backend that is to render a side.
pub struct Rendering {
    name: String,
    renderer: Box<dyn Renderer>,
}

impl Rendering {
    /// Starts a backend.
    ///
    /// # Errors
    /// If it cannot be had.
    pub fn start(choice: &BackendChoice, name: &str) -> Result<Self> {
        let renderer = backends::create(choice).with_context(|| format!("{name} cannot be had"))?;
        Ok(Rendering { name: name.to_owned(), renderer })
    }

    /// Adds one sample of every pixel.
    pub fn sample(&mut self, job: &RenderJob, index: u64) -> Result<Film> {
        self.samples(job, index..index + 1)
    }

    fn samples(&mut self, job: &RenderJob, range: std::ops::Range<u64>) -> Result<Film> {
        let mut film = new_film(job)?;
        self.renderer.accumulate(job, range, &mut film, &AtomicBool::new(false))?;
        Ok(film)
    }

    /// The side that `film`, which this rendered, is.
    pub fn side(&self, recipe: &Recipe, job: &RenderJob, film: Film) -> Side {
        let info = self.renderer.info();
        let about = format!("{} {}, {}", info.name, info.device, about_film(&film, Some(recipe)));
        Side {
            job: Some(job.clone()),
            recipe: Some(recipe.clone()),
            ..Side::of_film(self.name.clone(), about, film)
        }
    }

    /// Renders samples `ranges` as a side.
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

/// A side that is there, or one that waits for what the other says of its scene.
pub enum Opened {
    /// Read from a file.
    Read(Box<Side>),
    /// To be rendered.
    Backend(Box<Rendering>),
}

impl Opened {
    /// Reads the file or starts the backend.
    ///
    /// # Errors
    /// If that cannot be done.
    pub fn open(side: &CompareSide, encoding: Encoding) -> Result<Self> {
        Ok(match side {
            CompareSide::File(path) => Opened::Read(Box::new(Side::read(path, encoding)?)),
            CompareSide::Backend { name, choice } => {
                Opened::Backend(Box::new(Rendering::start(choice, name)?))
            }
        })
    }
}
