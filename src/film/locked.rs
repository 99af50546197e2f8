//! A film file that one run writes repeatedly while no other run may.

use super::{Description, Film, SampleRanges, checkpoint};
use crate::system::files::{FileLock, LockedError, ShownPath, WriteError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A film file, locked until this is dropped.
#[derive(Debug)]
pub struct LockedFilm {
    path: PathBuf,
    /// The samples in the file that must not be lost.
    held: SampleRanges,
    _lock: FileLock,
}

impl LockedFilm {
    /// Locks the file, which need not exist. Its present content may be replaced, see [`LockedFilm::holds`].
    ///
    /// # Errors
    /// [`LockedError`] if another run has locked it for as long as `patience`.
    pub fn new(path: &Path, patience: Duration) -> Result<LockedFilm, LockedError> {
        let lock = FileLock::take(path, patience)?;
        Ok(LockedFilm { path: path.to_owned(), held: SampleRanges::default(), _lock: lock })
    }

    /// Notes that the file holds these samples of the film. A film that lacks any of them will not replace it, such as
    /// one that restarted because its device was lost.
    pub fn holds(&mut self, samples: &SampleRanges) {
        self.held = samples.clone();
    }

    /// Replaces the file with `film`, with a denoised picture of it as a layer, unless the file holds just this film. If
    /// it already holds all of the film's samples and more, writes nothing and returns a note for the user.
    ///
    /// # Errors
    /// [`WriteError`], also if the film and the file each have samples that the other lacks. The file is unchanged.
    pub fn save(
        &mut self,
        film: &Film,
        denoised: Option<&Film>,
        description: &Description,
    ) -> Result<Option<String>, WriteError> {
        if denoised.is_none() && *film.samples() == self.held && self.path.exists() {
            return Ok(None);
        }
        if film.samples().contains(&self.held) {
            checkpoint::save_with(&self.path, film, denoised, description)?;
            self.held = film.samples().clone();
            return Ok(None);
        }
        let holds = format!("holds the samples {} of this picture", self.held);
        if self.held.contains(film.samples()) {
            let path = self.path.shown();
            return Ok(Some(format!(
                "{path} {holds}, more than this run has rendered, so it is left unchanged"
            )));
        }
        let reason = format!("it {holds}, and this run has only {}", film.samples());
        Err(WriteError { path: self.path.clone(), reason: io::Error::other(reason) })
    }
}

#[cfg(test)]
#[expect(clippy::single_range_in_vec_init, reason = "a list of one range is meant")]
mod tests {
    use super::*;
    use std::ops::Range;

    fn film(samples: &[Range<u64>]) -> Film {
        let mut film = Film::new(3, 2);
        samples.iter().for_each(|range| film.record(range.clone(), 0).unwrap());
        film
    }

    #[test]
    fn restarted_film_does_not_replace_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("g.exr");
        checkpoint::save(&path, &film(&[0..4]), &Description::new("r")).unwrap();
        let mut run = LockedFilm::new(&path, Duration::ZERO).unwrap();
        run.holds(film(&[0..4]).samples());
        let mut save = |samples: &[Range<u64>]| run.save(&film(samples), None, &Description::new("r"));
        let held = || checkpoint::load(&path).unwrap().film.samples().to_string();
        let note = save(&[0..2]).unwrap().unwrap();
        assert!(note.contains("g.exr") && note.contains("0..4"), "{note}");
        assert_eq!(held(), "0..4");
        let error = save(&[2..6]).unwrap_err().to_string();
        assert!(error.contains("0..4") && error.contains("2..6"), "{error}");
        assert_eq!(held(), "0..4");
        assert_eq!(save(&[0..10]).unwrap(), None);
        assert!(save(&[0..6]).unwrap().is_some());
        assert_eq!(held(), "0..10");
        // A file that the user deleted is written again.
        std::fs::remove_file(&path).unwrap();
        assert_eq!(save(&[0..12]).unwrap(), None);
        assert_eq!(held(), "0..12");
    }
}
