//! A film file that several runs may write at once, without any run losing another one's samples.
//!
//! A run remembers the file as it last saw it. Before the run replaces the file with a newer film, it looks again,
//! under a lock on the directory if the system has one. Machines that share a directory without locks can only
//! conflict between that look and the rename. If another run has written in the meantime, the samples of both films
//! are merged if possible; otherwise both films are kept, under two names.

use super::checkpoint::{self, FilmFile};
use super::difference::{difference, minus, ranges_of};
use super::{Description, Film, SampleRanges, key};
use crate::files::{NAME_LIMIT, NewFile, ShownPath, Stamp, WriteError, free_name, lock_within};
use std::fs::File;
use std::io::{BufReader, Seek};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a run waits for another run's check and rename, which take a moment.
const LOCK_PATIENCE: Duration = Duration::from_secs(10);

/// How many times a run tries to merge with another run's film before both films are kept.
const ATTEMPTS: usize = 5;

/// A file to which a run writes its film repeatedly.
#[derive(Debug)]
pub struct SharedFile {
    path: PathBuf,
    seen: Option<Stamp>,
    /// Whether the file may be replaced: it is an older film, or this run's film contains all of it.
    may_replace: bool,
    /// The file as last seen, held open so that it can still be read after it was replaced.
    base: Option<File>,
    /// This run's samples that the file holds.
    held: SampleRanges,
    /// Samples that other runs have added.
    others: Option<Film>,
    /// Those samples of `others` that `base` does not hold.
    others_since: Option<Film>,
}

/// The result of saving a film.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SaveOutcome {
    /// The file that holds it.
    pub path: PathBuf,
    /// A note for the user: another run has written the file too.
    pub note: Option<String>,
    /// Whether the film had to be saved under a different name.
    pub is_elsewhere: bool,
}

impl SharedFile {
    /// The file as it is now. Its present content may be replaced.
    pub fn new(path: &Path) -> SharedFile {
        let mut place = SharedFile {
            path: path.to_owned(),
            seen: None,
            may_replace: true,
            base: None,
            held: SampleRanges::default(),
            others: None,
            others_since: None,
        };
        place.note(Self::look_at(path));
        place
    }

    /// Notes that the file holds the first samples of this run's film. Later saves must not lose any of them.
    pub fn holds(&mut self, samples: &SampleRanges) {
        self.held = samples.clone();
    }

    /// Remembers the file that was found.
    fn note(&mut self, found: Option<(Stamp, Option<File>)>) {
        (self.seen, self.base) = found.map_or((None, None), |(stamp, file)| (Some(stamp), file));
        self.others_since = None;
    }

    /// The file at `path`, held open on systems where an open file can be replaced.
    fn look_at(path: &Path) -> Option<(Stamp, Option<File>)> {
        // Open first: if the file is replaced in between, the stamp is newer, and its content is checked.
        let file = if cfg!(unix) { File::open(path).ok() } else { None };
        Some((Stamp::of(path).ok().flatten()?, file))
    }

    fn is_as_seen(&self) -> bool {
        Stamp::of(&self.path).is_ok_and(|now| now == self.seen)
    }

    /// Saves `film`, merged with what other runs have added. `same_job` compares two recipes and returns what differs
    /// if their jobs differ.
    ///
    /// # Errors
    /// [`WriteError`]; the previous file is then unchanged.
    pub fn save(
        &mut self,
        film: &Film,
        description: &Description,
        same_job: &dyn Fn(&str, &str) -> Result<(), String>,
    ) -> Result<SaveOutcome, WriteError> {
        let (mut note, mut lock) = (None, None);
        for attempt in 0..ATTEMPTS {
            // Reading and writing take long and other runs are rare, so the first attempt does not lock.
            if attempt > 0 && lock.is_none() {
                lock = lock_directory(&self.path);
            }
            let joined = match self.joined(film) {
                Ok(joined) => joined,
                Err(reason) => return self.save_elsewhere(film, description, &reason),
            };
            let mine = joined.as_ref().unwrap_or(film);
            // A film that was lost during the run and restarted has fewer samples than the file.
            let has_shrunk = !minus(&self.held, mine.samples()).is_empty();
            if has_shrunk || !self.may_replace || !self.is_as_seen() {
                match self.consider(mine, description, same_job) {
                    Ok(Decision::Replace) => {}
                    Ok(Decision::Added(words)) => {
                        note = Some(words);
                        continue;
                    }
                    Ok(Decision::Leave(note)) => {
                        return Ok(SaveOutcome { path: self.path.clone(), note, is_elsewhere: false });
                    }
                    Err(reason) => return self.save_elsewhere(film, description, &reason),
                }
            }
            let mut description = description.clone();
            if joined.is_some() {
                description.set(key::SAMPLES, mine.sample_count());
            }
            let new = NewFile::write(&self.path, |writer| checkpoint::write(mine, &description, writer))?;
            let _lock = if lock.is_none() { lock_directory(&self.path) } else { None };
            if self.is_as_seen() {
                let ahead = new.pending_path().and_then(Self::look_at);
                new.put()?;
                self.note(ahead.filter(|_| cfg!(unix)).or_else(|| Self::look_at(&self.path)));
                (self.may_replace, self.held) = (true, mine.samples().clone());
                return Ok(SaveOutcome { path: self.path.clone(), note, is_elsewhere: false });
            }
        }
        self.save_elsewhere(film, description, "other runs keep writing it")
    }

    /// The film merged with what others have added; `None` if they have added nothing.
    fn joined(&self, film: &Film) -> Result<Option<Film>, String> {
        let Some(others) = &self.others else { return Ok(None) };
        if minus(others.samples(), film.samples()).is_empty() {
            return Ok(None);
        }
        let mut joined = others.clone();
        joined.merge(film).map_err(|error| error.to_string())?;
        Ok(Some(joined))
    }

    /// Decides what to do about a file that has changed since it was last seen.
    fn consider(
        &mut self,
        mine: &Film,
        description: &Description,
        same_job: &dyn Fn(&str, &str) -> Result<(), String>,
    ) -> Result<Decision, String> {
        let seen = Stamp::of(&self.path).map_err(|error| error.to_string())?;
        if seen.is_none() {
            // The file was deleted, or it is a device.
            self.seen = None;
            return Ok(Decision::Replace);
        }
        let FilmFile { film: theirs, description: told } =
            checkpoint::load(&self.path).map_err(|error| error.to_string())?;
        same_job(description.recipe(), told.recipe())
            .map_err(|difference| format!("it now holds a film of another picture: {difference}"))?;
        let shape = |film: &Film| (film.width(), film.height(), film.halves().len());
        if shape(mine) != shape(&theirs) {
            return Err("it now holds a film of another shape".to_owned());
        }
        let only_theirs = minus(theirs.samples(), mine.samples());
        if only_theirs.is_empty() {
            (self.seen, self.may_replace) = (seen, true);
            return Ok(Decision::Replace);
        }
        let told = |ranges: &[Range<u64>]| ranges_of(ranges).to_string();
        if minus(mine.samples(), theirs.samples()).is_empty() {
            let is_new = self.may_replace || self.seen != seen;
            (self.seen, self.may_replace) = (seen, false);
            return Ok(Decision::Leave(is_new.then(|| {
                format!(
                    "{} already holds all samples of this run, and also {}, so it is left unchanged",
                    self.path.shown(),
                    told(&only_theirs)
                )
            })));
        }
        let common = minus(theirs.samples(), &ranges_of(&only_theirs));
        let added = if common.is_empty() { Some(theirs) } else { self.without_base(theirs, &common) };
        let added = added.ok_or_else(|| {
            format!(
                "another run has added samples that cannot be separated from those of this run: {}",
                told(&common)
            )
        })?;
        for others in [&mut self.others, &mut self.others_since] {
            match others {
                Some(others) => others.merge(&added).map_err(|error| error.to_string())?,
                None => *others = Some(added.clone()),
            }
        }
        (self.seen, self.may_replace) = (seen, true);
        Ok(Decision::Added(format!(
            "another run has written {} in the meantime; its samples {} are kept too",
            self.path.shown(),
            told(&only_theirs)
        )))
    }

    /// The part of `theirs` that is neither in the film both runs started from nor known to be from other runs, if `common`
    /// is exactly these two.
    fn without_base(&self, theirs: Film, common: &[Range<u64>]) -> Option<Film> {
        let mut file = self.base.as_ref()?;
        let length = file.metadata().ok()?.len();
        file.rewind().ok()?;
        let mut base = checkpoint::read(BufReader::new(file), length, &self.path).ok()?.film;
        if let Some(others) = &self.others_since {
            base.merge(others).ok()?;
        }
        (base.samples().iter().eq(common.iter().cloned())).then(|| difference(theirs, &base)).flatten()
    }

    /// Saves the film under a free name beside the file. Later saves also go there.
    fn save_elsewhere(
        &mut self,
        film: &Film,
        description: &Description,
        reason: &str,
    ) -> Result<SaveOutcome, WriteError> {
        let taken = self.path.clone();
        // Another run may take a name that was free just now.
        for _ in 0..NAME_LIMIT {
            let Some(path) = free_name(|number| numbered(&taken, number + 1)) else { break };
            let new = NewFile::write(&path, |writer| checkpoint::write(film, description, writer))?;
            if new.put_new()? {
                let note = format!(
                    "another program has written {} in the meantime: {reason}; it is left unchanged, and the samples \
                     of this run are in {}",
                    taken.shown(),
                    path.shown()
                );
                *self = SharedFile::new(&path);
                return Ok(SaveOutcome { path, note: Some(note), is_elsewhere: true });
            }
        }
        let reason = std::io::Error::other("all numbered names next to it are taken");
        Err(WriteError { path: taken, reason })
    }
}

/// What to do about a file that another run has written.
enum Decision {
    /// Replace it: this run's film contains all of it.
    Replace,
    /// Replace it: this run's film now includes its samples.
    Added(String),
    /// Leave it: it contains all of this run's film.
    Leave(Option<String>),
}

/// Numbers a name: `film.exr` becomes `film-2.exr`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    path.with_file_name(format!("{stem}-{number}{ending}"))
}

/// Locks the directory of `path` until the result is dropped, so that no other run on this machine checks and renames
/// at the same time. This includes other machines if the file system shares locks. Without locks the result is `None`,
/// and only the check before the rename protects the file.
fn lock_directory(path: &Path) -> Option<File> {
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    lock_within(File::open(directory.unwrap_or(Path::new("."))).ok()?, LOCK_PATIENCE)
}

#[cfg(test)]
#[expect(clippy::single_range_in_vec_init, reason = "a list of one range is meant")]
mod tests {
    use super::*;

    /// A black film with these samples.
    fn film(samples: &[Range<u64>]) -> Film {
        let mut film = Film::new(3, 2, 2);
        samples.iter().for_each(|range| film.record(range.clone(), 0).unwrap());
        film
    }

    /// Another run may write again between the first look at its samples and the lock.
    #[test]
    fn samples_that_come_in_two_turns_before_the_own_are_told_apart() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("g.exr");
        let description = Description::new("r");
        let same = |_: &str, _: &str| Ok(());
        checkpoint::save(&path, &film(&[0..2]), &description).unwrap();
        let mut place = SharedFile::new(&path);
        let mine = film(&[0..2, 100..102]);
        for theirs in [200..202, 200..204] {
            checkpoint::save(&path, &film(&[0..2, theirs]), &description).unwrap();
            let joined = place.joined(&mine).unwrap().unwrap_or_else(|| mine.clone());
            let verdict = place.consider(&joined, &description, &same);
            assert!(matches!(verdict, Ok(Decision::Added(_))));
        }
        let saved = place.save(&mine, &description, &same).unwrap();
        assert!(!saved.is_elsewhere, "{saved:?}");
        assert!(checkpoint::load(&path).unwrap().film == film(&[0..2, 100..102, 200..204]));
    }
}
