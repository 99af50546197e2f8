//! Merges films from several files.

use super::{CheckpointError, Description, Film, FilmFile, SampleRanges, checkpoint, key};
use crate::system::files::ShownPath;
use anyhow::{Context, Result, bail};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The sum of the films of several files. Adding one needs memory for it besides the sum.
#[derive(Clone, Debug)]
pub struct FilmSum {
    film: Film,
    /// The first film's.
    description: Description,
    /// The files with their samples. The others must match the first.
    parts: Vec<(PathBuf, SampleRanges)>,
    backends: Vec<String>,
    /// Seconds of tracing, if all files have them.
    seconds: Option<f64>,
}

impl FilmSum {
    /// Reads the first film.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let FilmFile { film, description } = checkpoint::load(path)?;
        Ok(FilmSum {
            parts: vec![(path.to_owned(), film.samples().clone())],
            backends: backends(&description),
            seconds: seconds(&description),
            film,
            description,
        })
    }

    /// Adds the film of another file. `same_job` gets the recipes of the sum and of the file, and returns what differs
    /// if their jobs do.
    ///
    /// # Errors
    /// Which files do not match, and why; the sum is then unchanged.
    pub fn add(&mut self, path: &Path, same_job: impl Fn(&str, &str) -> Result<(), String>) -> Result<()> {
        let FilmFile { film, description } = checkpoint::load(path)?;
        let (first, other) = (self.parts[0].0.shown(), path.shown());
        if let Err(difference) = same_job(self.description.recipe(), description.recipe()) {
            bail!("{other} is the film of another picture than {first}: {difference}; leave it out");
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
        for backend in backends(&description) {
            if !self.backends.contains(&backend) {
                self.backends.push(backend);
            }
        }
        self.seconds = self.seconds.zip(seconds(&description)).map(|(sum, seconds)| sum + seconds);
        Ok(())
    }

    /// The files with their samples, in the order in which they were added.
    pub fn parts(&self) -> &[(PathBuf, SampleRanges)] {
        &self.parts
    }

    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The description of the sum: the first film's, with the samples of all films, all their backends, and the sum of
    /// their seconds if all have them.
    pub fn description(&self) -> Description {
        let mut description = self.description.clone();
        description.set(key::SAMPLES, self.film.sample_count());
        // That of the first film is not that of the sum.
        description.remove(key::DENOISED);
        if !self.backends.is_empty() {
            description.set(key::BACKEND, self.backends.join("; "));
        }
        match self.seconds {
            Some(seconds) => description.set(key::SECONDS, seconds),
            None => description.remove(key::SECONDS),
        }
        description
    }
}

/// The backends, each once and without its number of samples.
fn backends(description: &Description) -> Vec<String> {
    let text = description.get(key::BACKEND).unwrap_or_default();
    let name = |one: &str| match one.rsplit_once(" (") {
        Some((name, count)) if count.ends_with("sample)") || count.ends_with("samples)") => name.to_owned(),
        _ => one.to_owned(),
    };
    let mut names: Vec<String> = text.split("; ").filter(|one| !one.is_empty()).map(name).collect();
    names.dedup();
    names
}

fn seconds(description: &Description) -> Option<f64> {
    description.get(key::SECONDS)?.parse().ok()
}
