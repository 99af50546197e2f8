//! Reads saved files: a scene file, a picture that describes how it was made, or a film with its samples. All code that
//! opens or resumes a file uses this module.

mod difference;
mod replaced;
mod rescue;

pub use difference::{difference, same_job};
pub use replaced::Replaced;
pub use rescue::rescue;

use crate::film::{CheckpointError, Description, Film, FilmFile, FilmHead, checkpoint, key};
use crate::job::output::{read_description, read_picture};
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderJob;
use crate::stages::Stage;
use crate::system::files::ShownPath;
use anyhow::anyhow;
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
    /// The scene file or the recipe cannot be read or rendered, or the film is of another size or picture.
    #[error(transparent)]
    Recipe(#[from] anyhow::Error),
}

/// A saved file. A film's samples are not read yet.
#[derive(Debug)]
pub struct Saved {
    pub path: PathBuf,
    pub kind: Kind,
    /// Its name comes from the file's description, otherwise from the file name without its extension.
    pub recipe: Recipe,
}

#[derive(Debug)]
pub enum Kind {
    Scene,
    Picture(Description),
    Film(FilmHead),
}

/// A film that was read.
#[derive(Debug)]
pub struct SavedFilm {
    pub film: Film,
    /// Seconds that tracing the samples took, if the file says so.
    pub seconds: Option<f64>,
}

/// Opens a scene file (its name ends in .toml), a picture or a film. The first bytes of the file tell whether it is a
/// film.
///
/// # Errors
/// [`OpenError`]; a film must have the size that its recipe describes.
pub fn open(path: &Path) -> Result<Saved, OpenError> {
    let saved = |kind, recipe| Saved { path: path.to_owned(), kind, recipe };
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        return Ok(saved(Kind::Scene, file::load(path)?));
    }
    let kind = match checkpoint::read_head(path) {
        Ok(head) => Kind::Film(head),
        Err(error @ CheckpointError::Resaved { .. }) => {
            Kind::Picture(read_description(path).map_err(|_| OpenError::Film(error))?)
        }
        Err(CheckpointError::NotExr { .. } | CheckpointError::NotFilm { .. }) => {
            Kind::Picture(read_description(path).map_err(OpenError::Picture)?)
        }
        Err(error) => return Err(OpenError::Film(error)),
    };
    let description = kind.description().map_or("", Description::recipe);
    let label = path.shown();
    let recipe = file::parse(description, &label)
        .map_err(|reason| anyhow!("{label} has a recipe that cannot be read: {reason}"))?;
    let settings = &recipe.settings;
    if let Kind::Film(FilmHead { width, height, .. }) = kind
        && (width, height) != (settings.width, settings.height)
    {
        return Err(OpenError::Recipe(anyhow!(
            "{label} is a film that does not have the size that its recipe says; render it again"
        )));
    }
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let name = kind.text(key::SCENE).map(str::to_owned).or(stem).unwrap_or(label);
    Ok(saved(kind, Recipe { name, ..recipe }))
}

impl Kind {
    fn description(&self) -> Option<&Description> {
        match self {
            Kind::Scene => None,
            Kind::Picture(description) | Kind::Film(FilmHead { description, .. }) => Some(description),
        }
    }

    /// An entry of the description.
    pub fn text(&self, key: &str) -> Option<&str> {
        self.description()?.get(key)
    }
}

impl Saved {
    /// The stage that the description names.
    pub fn stage(&self) -> Option<&'static Stage> {
        Stage::find(self.kind.text(key::STAGE)?).ok()
    }

    /// Samples per pixel, if the description has them.
    pub fn samples(&self) -> Option<u64> {
        self.kind.text(key::SAMPLES)?.parse().ok().filter(|samples| *samples > 0)
    }

    /// Seconds of tracing, if the description has them.
    pub fn seconds(&self) -> Option<f64> {
        self.kind.text(key::SECONDS)?.parse().ok()
    }

    /// The validated job of the recipe.
    ///
    /// # Errors
    /// [`OpenError::Recipe`].
    pub fn job(&self) -> Result<RenderJob, OpenError> {
        let path = self.path.shown();
        let job = self.recipe.job();
        Ok(job.map_err(|reason| anyhow!("{path} has a recipe that cannot be rendered: {reason}"))?)
    }

    /// Refuses a film of another job.
    ///
    /// # Errors
    /// [`OpenError::Recipe`].
    pub fn check_same(&self, job: &RenderJob) -> Result<(), OpenError> {
        let Some(difference) = difference(job, &self.job()?) else { return Ok(()) };
        let path = self.path.shown();
        Err(OpenError::Recipe(anyhow!(
            "{path} is the film of another picture: {difference}; change the flags that differ, or name another film"
        )))
    }

    /// Reads the film.
    ///
    /// # Errors
    /// [`OpenError::Film`]; pictures and scene files are refused.
    pub fn film(&self) -> Result<SavedFilm, OpenError> {
        let FilmFile { film, .. } = checkpoint::load(&self.path).map_err(OpenError::Film)?;
        Ok(SavedFilm { film, seconds: self.seconds() })
    }
}

/// Reads the film of `job` in order to resume it.
///
/// # Errors
/// [`OpenError`], also for the film of another job.
pub fn resume(path: &Path, job: &RenderJob) -> Result<SavedFilm, OpenError> {
    let saved = open(path)?;
    saved.check_same(job)?;
    saved.film()
}

/// Whether the file is the whole frame that `recipe` describes, made by `software`, the program and its version, and
/// with this entry.
pub fn is_whole_frame(path: &Path, recipe: &Recipe, software: &str, (key, value): (&str, &str)) -> bool {
    read_description(path).is_ok_and(|found| {
        found.recipe() == file::to_picture_toml(recipe)
            && found.get(key) == Some(value)
            && found.get(key::SOFTWARE) == Some(software)
    }) && read_picture(path, None).is_ok()
}

#[cfg(test)]
mod tests;
