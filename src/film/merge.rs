//! Merges films from several files.

use super::{Description, Film, FilmFile, FilmHead, SampleRanges, checkpoint, key};
use crate::system::files::ShownPath;
use anyhow::{Context, Result, bail};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The sum of the films of several files. Adding one needs memory for it besides the sum.
#[derive(Clone, Debug)]
pub struct FilmSum {
    film: Film,
    description: Description,
    /// The file or plan that the others must match.
    first: PathBuf,
    /// The files with their samples.
    parts: Vec<(PathBuf, SampleRanges)>,
    backends: Vec<String>,
    /// Seconds of tracing, if all files have them.
    seconds: Option<f64>,
}

impl FilmSum {
    /// An empty sum of films with this many pixels and halves. `recipe` and messages come from `first`.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn new(
        width: u32,
        height: u32,
        halves: usize,
        description: Description,
        first: &Path,
    ) -> Result<Self> {
        let film = Film::try_new(width, height, halves)
            .with_context(|| format!("{} cannot be merged", first.shown()))?;
        let (first, parts, backends) = (first.to_owned(), Vec::new(), Vec::new());
        Ok(FilmSum { film, description, first, parts, backends, seconds: Some(0.0) })
    }

    /// Adds the film of a file and returns its samples. `same_job` gets the recipes of the sum and of the file, and
    /// returns what differs if their jobs do.
    ///
    /// # Errors
    /// Which files do not match, and why; the sum is then unchanged.
    pub fn add(
        &mut self,
        path: &Path,
        same_job: impl Fn(&str, &str) -> Result<(), String>,
    ) -> Result<SampleRanges> {
        let FilmFile { film, description } = checkpoint::load(path)?;
        let (first, other) = (self.first.shown(), path.shown());
        if let Err(difference) = same_job(self.description.recipe(), description.recipe()) {
            bail!(
                "{other} is the film of another picture than {first}: {difference}; leave it out, or move it out of the \
                 plan's directory"
            );
        }
        for (path, samples) in &self.parts {
            if let Some(Range { start, end }) = samples.first_common(film.samples()) {
                bail!(
                    "{} and {other} both hold the samples {start}..{end}; each sample may be added only once, so leave one of \
                     the files out",
                    path.shown()
                );
            }
        }
        self.film.merge(&film).with_context(|| format!("{first} and {other} cannot be merged"))?;
        self.parts.push((path.to_owned(), film.samples().clone()));
        let backend = description.get(key::BACKEND).map(str::to_owned);
        self.backends.extend(backend.filter(|backend| !self.backends.contains(backend)));
        let seconds = description.get(key::SECONDS).and_then(|seconds| seconds.parse::<f64>().ok());
        self.seconds = self.seconds.zip(seconds).map(|(sum, seconds)| sum + seconds);
        Ok(film.samples().clone())
    }

    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The description of the sum: the first film's, with the samples of all films, all their backends, and the sum of
    /// their seconds if all have them.
    pub fn description(&self) -> Description {
        let mut description = self.description.clone();
        description.set(key::SAMPLES, self.film.sample_count());
        if !self.backends.is_empty() {
            description.set(key::BACKEND, self.backends.join("; "));
        }
        if let Some(seconds) = self.seconds {
            description.set(key::SECONDS, seconds);
        }
        description
    }
}

/// Merges the films of several files. Besides the sum, this needs memory for one of them.
///
/// `same_job` gets the recipes of the first file and of another one, and returns what differs if their jobs differ.
/// The description is that of the first file, see [`FilmSum::description`].
///
/// # Errors
/// Which files do not match, and why.
pub fn merge_files<P: AsRef<Path>>(
    paths: &[P],
    same_job: impl Fn(&str, &str) -> Result<(), String>,
) -> Result<FilmFile> {
    let first = paths.first().context("no film was named; name the film files to merge")?;
    let FilmHead { width, height, halves, description, .. } = checkpoint::read_head(first.as_ref())?;
    let mut sum = FilmSum::new(width, height, halves, description, first.as_ref())?;
    for path in paths {
        sum.add(path.as_ref(), &same_job)?;
    }
    let description = sum.description();
    Ok(FilmFile { film: sum.film, description })
}
