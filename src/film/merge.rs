//! Merges films from several files.

use super::{CheckpointError, FilmError, FilmFile, SampleRanges, checkpoint, key};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why film files cannot be merged.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum MergeError {
    /// No file was given.
    #[error("no film was named; name the film files to merge")]
    NoFiles,
    /// A file cannot be loaded as a film.
    #[error(transparent)]
    File(#[from] CheckpointError),
    /// Two films are of different jobs.
    #[error(
        "{} and {} are films of different jobs: {difference}; only films of one job with different samples can be merged",
        first.display(), other.display()
    )]
    OtherJob {
        /// The first file.
        first: PathBuf,
        /// A file whose film has another job.
        other: PathBuf,
        /// What differs between the jobs.
        difference: String,
    },
    /// Two films have samples in common.
    #[error(
        "{} and {} both hold the samples {}..{}; each sample may be added only once, so leave one of the files out",
        first.display(), other.display(), range.start, range.end
    )]
    Overlap {
        /// The first file.
        first: PathBuf,
        /// A file that holds some of the same samples.
        other: PathBuf,
        /// The first samples that both hold.
        range: Range<u64>,
    },
    /// The films differ in shape.
    #[error("{} and {} cannot be merged: {reason}", first.display(), other.display())]
    Film {
        /// The first file.
        first: PathBuf,
        /// The file that cannot be merged with it.
        other: PathBuf,
        /// The reason.
        reason: FilmError,
    },
}

/// Merges the films of several files. At most two of them are in memory at a time.
///
/// `same_job` gets the recipes of the first file and of another one, and returns what differs if their jobs differ.
/// The description is that of the first file, with the samples of all files and, if all files have them, the sum of
/// their seconds.
///
/// # Errors
/// [`MergeError`], with the files that do not match.
pub fn merge_files<P: AsRef<Path>>(
    paths: &[P],
    same_job: impl Fn(&str, &str) -> Result<(), String>,
) -> Result<FilmFile, MergeError> {
    let [first, others @ ..] = paths else { return Err(MergeError::NoFiles) };
    let first = first.as_ref();
    let mut merged = checkpoint::load(first)?;
    let mut seconds = seconds_of(&merged);
    let mut backends = Vec::from_iter(backend_of(&merged));
    let mut added: Vec<(&Path, SampleRanges)> = vec![(first, merged.film.samples().clone())];
    for other in others {
        let other = other.as_ref();
        let part = checkpoint::load(other)?;
        same_job(merged.description.recipe(), part.description.recipe()).map_err(|difference| {
            MergeError::OtherJob { first: first.to_owned(), other: other.to_owned(), difference }
        })?;
        let overlap = added.iter().find_map(|(earlier, samples)| {
            samples.first_common(part.film.samples()).map(|range| (earlier.to_path_buf(), range))
        });
        if let Some((first, range)) = overlap {
            return Err(MergeError::Overlap { first, other: other.to_owned(), range });
        }
        merged.film.merge(&part.film).map_err(|reason| MergeError::Film {
            first: first.to_owned(),
            other: other.to_owned(),
            reason,
        })?;
        backends.extend(backend_of(&part).filter(|backend| !backends.contains(backend)));
        seconds = seconds.zip(seconds_of(&part)).map(|(sum, more)| sum + more);
        added.push((other, part.film.samples().clone()));
    }
    merged.description.set(key::SAMPLES, merged.film.sample_count());
    if !backends.is_empty() {
        merged.description.set(key::BACKEND, backends.join("; "));
    }
    if let Some(seconds) = seconds {
        merged.description.set(key::SECONDS, seconds);
    }
    Ok(merged)
}

fn backend_of(file: &FilmFile) -> Option<String> {
    file.description.get(key::BACKEND).map(str::to_owned)
}

fn seconds_of(file: &FilmFile) -> Option<f64> {
    file.description.get(key::SECONDS)?.parse().ok()
}

/// Checks whether two recipes have the same text, apart from lines that set `samples_per_pixel`.
///
/// # Errors
/// The first lines that differ.
pub fn same_recipe_text(first: &str, other: &str) -> Result<(), String> {
    let lines = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !is_sample_count(line)).map(str::to_owned).collect()
    };
    let (first, other) = (lines(first), lines(other));
    let count = first.len().max(other.len());
    let line = |lines: &[String], i: usize| lines.get(i).cloned().unwrap_or_else(|| "nothing".into());
    match (0..count).find(|i| first.get(*i) != other.get(*i)) {
        None => Ok(()),
        Some(i) => Err(format!("one recipe says `{}`, the other `{}`", line(&first, i), line(&other, i))),
    }
}

fn is_sample_count(line: &str) -> bool {
    line.trim_start().strip_prefix("samples_per_pixel").is_some_and(|rest| rest.trim_start().starts_with('='))
}
