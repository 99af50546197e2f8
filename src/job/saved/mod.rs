//! Reads saved files: a scene file, a picture that describes how it was made, or a film with its samples. All code that
//! opens or resumes a file uses this module.

mod difference;
mod replaced;
mod rescue;

pub use difference::{difference, same_job};
pub use replaced::Replaced;
pub use rescue::rescue;

use crate::film::{CheckpointError, Description, Film, FilmFile, checkpoint, key};
use crate::job::output::{read_description, read_picture};
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderJob;
use crate::stages::Stage;
use crate::system::files::ShownPath;
use anyhow::{anyhow, ensure};
use std::path::{Path, PathBuf};

/// Why a file cannot be opened or resumed. The message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The film is damaged, of another version, or cannot be read; or a film is needed and the file is something else.
    #[error(transparent)]
    Film(CheckpointError),
    /// The picture cannot be read or does not describe how it was made.
    #[error(transparent)]
    Picture(anyhow::Error),
    /// The scene file or the recipe cannot be read or rendered, or the film does not match it.
    #[error(transparent)]
    Recipe(#[from] anyhow::Error),
    #[error(
        "{} is the film of another picture: {difference}; change the flags that differ, or name another film",
        path.shown()
    )]
    OtherPicture { path: PathBuf, difference: String },
}

/// The description in a picture or film, and the film itself.
#[derive(Debug)]
pub struct Saved {
    pub path: PathBuf,
    pub description: Description,
    /// The film, if the file has one and it was read.
    pub film: Option<Film>,
}

impl Saved {
    /// Reads a picture or film. The first bytes of the file tell which it is.
    ///
    /// # Errors
    /// [`OpenError::Film`] or [`OpenError::Picture`].
    pub fn read(path: &Path) -> Result<Self, OpenError> {
        match checkpoint::load(path) {
            Ok(FilmFile { film, description }) => {
                Ok(Saved { path: path.to_owned(), description, film: Some(film) })
            }
            Err(
                CheckpointError::NotExr { .. }
                | CheckpointError::NotFilm { .. }
                | CheckpointError::Resaved { .. },
            ) => Self::describe(path),
            Err(error) => Err(OpenError::Film(error)),
        }
    }

    /// Reads only the description of a picture or film, not its samples, which is fast.
    ///
    /// # Errors
    /// [`OpenError::Picture`].
    pub fn describe(path: &Path) -> Result<Self, OpenError> {
        let description = read_description(path).map_err(OpenError::Picture)?;
        Ok(Saved { path: path.to_owned(), description, film: None })
    }

    /// The recipe. Its name comes from the file's description, otherwise from the file name without its extension.
    ///
    /// # Errors
    /// [`OpenError::Recipe`].
    pub fn recipe(&self) -> Result<Recipe, OpenError> {
        let label = self.path.shown();
        let recipe = file::parse(self.description.recipe(), &label)
            .map_err(|reason| anyhow!("{label} has a recipe that cannot be read: {reason}"))?;
        let stem = self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let name = self.description.get(key::SCENE).map(str::to_owned).or(stem).unwrap_or(label);
        Ok(Recipe { name, ..recipe })
    }

    /// The stage that the description names.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.description.get(key::STAGE).and_then(|id| Stage::find(id).ok())
    }

    /// Samples per pixel, if the description has them.
    pub fn samples(&self) -> Option<u64> {
        self.description.get(key::SAMPLES)?.parse().ok().filter(|samples| *samples > 0)
    }

    /// Seconds of tracing, if the description has them.
    pub fn seconds(&self) -> Option<f64> {
        self.description.get(key::SECONDS)?.parse().ok()
    }

    fn backend(&self) -> Option<String> {
        self.description.get(key::BACKEND).map(str::to_owned)
    }

    /// The film with its tracing time and backend; `None` for a picture.
    pub fn into_film(self) -> Option<SavedFilm> {
        let (seconds, backend) = (self.seconds(), self.backend());
        Some(SavedFilm { film: self.film?, seconds, backend })
    }
}

/// A film that was read, with what its file says about the tracing.
#[derive(Debug)]
pub struct SavedFilm {
    pub film: Film,
    /// Seconds that tracing the samples took, if the file says so.
    pub seconds: Option<f64>,
    /// The backend that traced them, if the file says so.
    pub backend: Option<String>,
}

/// A file that was opened.
#[derive(Debug)]
pub struct Opened {
    pub path: PathBuf,
    /// The recipe. Its name comes from the file's description, otherwise from the file name without its extension.
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The picture or the film, whose shape matches the recipe; `None` for a scene file.
    pub saved: Option<Saved>,
}

/// Opens a scene file (its name ends in .toml), a picture or a film.
///
/// # Errors
/// [`OpenError`]; a film must have the shape that its recipe describes.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    let is_scene = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let saved = if is_scene { None } else { Some(Saved::read(path)?) };
    let recipe = saved.as_ref().map_or_else(|| Ok(file::load(path)?), Saved::recipe)?;
    let job = job_of(path, &recipe, saved.as_ref().and_then(|saved| saved.film.as_ref()))?;
    Ok(Opened { path: path.to_owned(), recipe, job, saved })
}

/// Opens a film and returns its job and the film.
///
/// # Errors
/// [`OpenError`]; pictures and scene files are refused.
pub fn open_film(path: &Path) -> Result<(RenderJob, SavedFilm), OpenError> {
    let FilmFile { film, description } = checkpoint::load(path).map_err(OpenError::Film)?;
    let saved = Saved { path: path.to_owned(), description, film: None };
    let job = job_of(path, &saved.recipe()?, Some(&film))?;
    let (seconds, backend) = (saved.seconds(), saved.backend());
    Ok((job, SavedFilm { film, seconds, backend }))
}

/// Reads the film of `job` in order to resume it.
///
/// # Errors
/// [`OpenError`]; [`OpenError::OtherPicture`] for the film of another job.
pub fn resume(path: &Path, job: &RenderJob) -> Result<SavedFilm, OpenError> {
    let (theirs, film) = open_film(path)?;
    check_same(path, job, &theirs)?;
    Ok(film)
}

/// Refuses a film of another job, as [`resume`] would, without reading the film's samples.
///
/// # Errors
/// Those of [`resume`].
pub fn check_resume(path: &Path, job: &RenderJob) -> Result<(), OpenError> {
    let theirs = job_of(path, &Saved::describe(path)?.recipe()?, None)?;
    check_same(path, job, &theirs)
}

/// The job of a file's recipe, which must have the shape of its film.
fn job_of(path: &Path, recipe: &Recipe, film: Option<&Film>) -> anyhow::Result<RenderJob> {
    let path = path.shown();
    let job =
        recipe.job().map_err(|reason| anyhow!("{path} has a recipe that cannot be rendered: {reason}"))?;
    let is_its_size = film.is_none_or(|film| job.fits(film));
    ensure!(
        is_its_size,
        "{path} is a film that does not have the size that its recipe says; render it again"
    );
    Ok(job)
}

fn check_same(path: &Path, mine: &RenderJob, theirs: &RenderJob) -> Result<(), OpenError> {
    let refused = |difference| Err(OpenError::OtherPicture { path: path.to_owned(), difference });
    difference(mine, theirs).map_or(Ok(()), refused)
}

/// Whether the file is the whole frame that `recipe` describes, made by `software`, the program and its version.
pub fn is_whole_frame(path: &Path, recipe: &Recipe, software: &str) -> bool {
    let samples = recipe.samples_per_pixel.to_string();
    read_description(path).is_ok_and(|found| {
        found.recipe() == file::to_picture_toml(recipe)
            && found.get(key::SAMPLES) == Some(&samples)
            && found.get(key::SOFTWARE) == Some(software)
    }) && read_picture(path, None).is_ok()
}

#[cfg(test)]
mod tests;
