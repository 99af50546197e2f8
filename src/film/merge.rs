//! Merges films from several files.

use super::checkpoint::{ApplyError, FilmHead, Sign, apply};
use super::{
    CheckpointError, Description, Film, FilmError, FilmFile, PixelSum, SampleRanges, checkpoint, key,
};
use crate::files::{self, InputError, ShownPath};
use std::fs::File;
use std::io::{BufReader, Seek};
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
        first.shown(), other.shown()
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
        first.shown(), other.shown(), range.start, range.end
    )]
    Overlap {
        /// The first file.
        first: PathBuf,
        /// A file that holds some of the same samples.
        other: PathBuf,
        /// The first samples that both hold.
        range: Range<u64>,
    },
    /// A film could be neither added nor taken away again.
    #[error("{reason}; what was added of it could not be taken away again, so merge all films again")]
    Lost {
        /// What is wrong with the file.
        reason: CheckpointError,
    },
    /// The films differ in shape.
    #[error("{} and {} cannot be merged: {reason}", first.shown(), other.shown())]
    Film {
        /// The first file.
        first: PathBuf,
        /// The file that cannot be merged with it.
        other: PathBuf,
        /// The reason.
        reason: FilmError,
    },
}

/// The sum of the films of several files. Besides the sum itself it needs memory for a few rows only: a file is added
/// while it is read, and taken away again if it turns out to be damaged.
#[derive(Debug)]
pub struct FilmSum {
    film: Film,
    description: Description,
    /// The file or plan that decides what the others must be films of.
    first: PathBuf,
    shares: Vec<Share>,
}

/// A film in a sum.
#[derive(Debug)]
pub struct Share {
    path: PathBuf,
    samples: SampleRanges,
    rejected: u64,
    seconds: Option<f64>,
    backend: Option<String>,
    /// What it needs to be taken away again, if it may leave.
    guest: Option<Guest>,
}

/// The file of a film that may leave a sum.
#[derive(Debug)]
struct Guest {
    /// Held open, so that it can be taken away even if the file was replaced.
    file: File,
    /// The film that it held. A copy in its place may have changed that.
    mark: String,
}

impl Share {
    /// The samples that it has brought.
    pub fn samples(&self) -> &SampleRanges {
        &self.samples
    }
}

impl FilmSum {
    /// An empty sum of films with this many pixels and halves. `recipe` and messages come from `first`.
    ///
    /// # Errors
    /// [`MergeError::Film`] if there is not enough memory.
    pub fn new(
        width: u32,
        height: u32,
        halves: usize,
        description: Description,
        first: &Path,
    ) -> Result<Self, MergeError> {
        let film = Film::try_new(width, height, halves).map_err(|reason| MergeError::Film {
            first: first.to_owned(),
            other: first.to_owned(),
            reason,
        })?;
        Ok(FilmSum { film, description, first: first.to_owned(), shares: Vec::new() })
    }

    /// Adds the film in a file. `same_job` gets the recipes of the sum and of the file, and returns what differs if
    /// their jobs differ. A film whose samples `may_leave` can be taken away again: see [`FilmSum::take_back`].
    ///
    /// # Errors
    /// [`MergeError`]; unless it is [`MergeError::Lost`], the sum is as before.
    pub fn add(
        &mut self,
        path: &Path,
        same_job: impl Fn(&str, &str) -> Result<(), String>,
        may_leave: impl Fn(&SampleRanges) -> bool,
    ) -> Result<&Share, MergeError> {
        let (file, about, mark) = open(path)?;
        let (first, other) = (self.first.clone(), path.to_owned());
        if let Err(difference) = same_job(self.description.recipe(), about.description.recipe()) {
            return Err(MergeError::OtherJob { first, other, difference });
        }
        let mine = (self.film.width, self.film.height, self.film.halves.len());
        let theirs = (about.width, about.height, about.halves);
        if mine != theirs {
            return Err(MergeError::Film { first, other, reason: FilmError::Size { mine, theirs } });
        }
        let overlap = self.shares.iter().find_map(|share| {
            share.samples.first_common(&about.samples).map(|range| (share.path.clone(), range))
        });
        if let Some((first, range)) = overlap {
            return Err(MergeError::Overlap { first, other, range });
        }
        let failed = |reason| MergeError::Film { first: first.clone(), other: other.clone(), reason };
        let samples = self.film.samples.union(&about.samples).map_err(failed)?;
        let rejected = self.film.with_rejected(about.rejected).map_err(failed)?;
        apply(&mut self.film.halves, &file, path, &mark, Sign::Plus).map_err(apply_error)?;
        (self.film.samples, self.film.rejected) = (samples, rejected);
        let is_guest = may_leave(&about.samples);
        self.shares.push(Share {
            path: path.to_owned(),
            samples: about.samples,
            rejected: about.rejected,
            seconds: about.description.get(key::SECONDS).and_then(|seconds| seconds.parse().ok()),
            backend: about.description.get(key::BACKEND).map(str::to_owned),
            guest: is_guest.then_some(Guest { file, mark }),
        });
        // It was pushed just now.
        Ok(&self.shares[self.shares.len() - 1])
    }

    /// Takes away every film that was added with `may_leave`.
    ///
    /// # Errors
    /// [`MergeError::Lost`] if one of them cannot be read any more: the sum is then worthless, until it is cleared.
    pub fn take_back(&mut self) -> Result<(), MergeError> {
        let leaves = |share: &mut Share| share.guest.is_some();
        for share in self.shares.extract_if(.., leaves) {
            let Some(Guest { file, mark }) = &share.guest else { continue };
            let taken = apply(&mut self.film.halves, file, &share.path, mark, Sign::Minus);
            taken.map_err(|error| match error {
                ApplyError::File(reason) | ApplyError::Lost(reason) => MergeError::Lost { reason },
            })?;
            self.film.rejected -= share.rejected;
        }
        let ranges = self.shares.iter().flat_map(|share| share.samples.iter());
        self.film.samples = SampleRanges::from_ranges(ranges).map_err(|reason| MergeError::Film {
            first: self.first.clone(),
            other: self.first.clone(),
            reason,
        })?;
        Ok(())
    }

    /// A copy. What is in it stays in it: [`FilmSum::take_back`] takes away only what is added to the copy.
    ///
    /// # Errors
    /// [`MergeError::Film`] if there is not enough memory.
    pub fn try_copy(&self) -> Result<Self, MergeError> {
        let film = self.film.try_copy().map_err(|reason| MergeError::Film {
            first: self.first.clone(),
            other: self.first.clone(),
            reason,
        })?;
        let shares = self.shares.iter().map(|share| Share {
            path: share.path.clone(),
            samples: share.samples.clone(),
            rejected: share.rejected,
            seconds: share.seconds,
            backend: share.backend.clone(),
            guest: None,
        });
        let (description, first) = (self.description.clone(), self.first.clone());
        Ok(FilmSum { film, description, first, shares: shares.collect() })
    }

    /// Empties the sum, which needs no memory.
    pub fn clear(&mut self) {
        self.film.halves.iter_mut().for_each(|half| half.fill(PixelSum::default()));
        (self.film.samples, self.film.rejected) = (SampleRanges::default(), 0);
        self.shares.clear();
    }

    /// The sum.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// The description of the sum: that of its beginning, with the samples of all films and, if all films have them,
    /// the sum of their seconds.
    pub fn description(&self) -> Description {
        let mut description = self.description.clone();
        description.set(key::SAMPLES, self.film.sample_count());
        let mut backends: Vec<&str> = Vec::new();
        for backend in self.shares.iter().filter_map(|share| share.backend.as_deref()) {
            if !backends.contains(&backend) {
                backends.push(backend);
            }
        }
        if !backends.is_empty() {
            description.set(key::BACKEND, backends.join("; "));
        }
        if let Some(seconds) = self.shares.iter().map(|share| share.seconds).sum::<Option<f64>>() {
            description.set(key::SECONDS, seconds);
        }
        description
    }
}

fn apply_error(error: ApplyError) -> MergeError {
    match error {
        ApplyError::File(reason) => MergeError::File(reason),
        ApplyError::Lost(reason) => MergeError::Lost { reason },
    }
}

/// A film file, held open, what it says about its film, and the film's mark.
fn open(path: &Path) -> Result<(File, FilmHead, String), CheckpointError> {
    let (mut file, length) = files::open(path)?;
    let (about, mark) = checkpoint::head_of(BufReader::new(&file), length, path)?;
    file.rewind()
        .map_err(|reason| InputError::Unreadable { path: path.to_owned(), reason: reason.to_string() })?;
    Ok((file, about, mark))
}

/// Merges the films of several files. Besides the sum, this needs memory for a few rows.
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
    let [first, ..] = paths else { return Err(MergeError::NoFiles) };
    let FilmHead { width, height, halves, description, .. } = checkpoint::read_head(first.as_ref())?;
    let mut sum = FilmSum::new(width, height, halves, description, first.as_ref())?;
    for path in paths {
        sum.add(path.as_ref(), &same_job, |_| false)?;
    }
    let description = sum.description();
    Ok(FilmFile { film: sum.film, description })
}
