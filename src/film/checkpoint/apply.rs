//! Adds the sums of a film file to sums in memory, or takes them away again, with several threads and memory for a few
//! rows.

use super::head::{band_count, band_rows};
use super::open::Opened;
use super::read::{for_each_band, read};
use super::threads::threads;
use super::{CheckpointError, Film, FilmFile, FilmHead, PixelSum};
use crate::files::{self, InputError};
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::thread;

/// Bytes that a thread reads at once.
const BUFFER: usize = 1 << 18;

/// What happens to the sums of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::film) enum Sign {
    Plus,
    Minus,
}

/// Why the sums of a file were not added.
pub(in crate::film) enum ApplyError {
    /// The sums in memory are as before.
    File(CheckpointError),
    /// What had been added could not be read again, so it cannot be taken away: the sums in memory are worthless.
    Lost(CheckpointError),
}

/// Reads a film file. The film is identical to the bit to the one that was written.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn load(path: &Path) -> Result<FilmFile, CheckpointError> {
    let (file, length) = files::open(path)?;
    let opened = Opened::new(BufReader::new(At { file: &file, place: 0 }), length, path)?;
    let (named, about) = (opened.file, opened.about);
    if !opened.head.has_bands() {
        return read(BufReader::new(At { file: &file, place: 0 }), length, path);
    }
    let film = Film::try_new(about.width, about.height, about.halves);
    let mut halves = film.map_err(|error| named.no_film(error))?.halves;
    // A film that fails is dropped, so nothing needs to be taken away.
    let applied = run_all(&mut halves, &file, length, path, Sign::Plus, None);
    applied.into_iter().try_for_each(|(_, outcome)| outcome)?;
    let film = Film::from_parts(about.width, about.height, halves, about.samples, about.rejected);
    Ok(FilmFile { film: film.map_err(|error| named.no_film(error))?, description: about.description })
}

/// Reads a whole film file and checks it, with memory for a few rows. (A film of version 3 is held as a whole.)
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn check(path: &Path) -> Result<FilmHead, CheckpointError> {
    let (file, length) = files::open(path)?;
    let opened = Opened::new(BufReader::new(At { file: &file, place: 0 }), length, path)?;
    if opened.head.has_bands() {
        let outcomes = run_all(&mut [], &file, length, path, Sign::Plus, None);
        outcomes.into_iter().try_for_each(|(_, outcome)| outcome)?;
    } else {
        read(BufReader::new(At { file: &file, place: 0 }), length, path)?;
    }
    Ok(opened.about)
}

/// Adds the sums in `file` to `halves` of the same shape, or subtracts them.
pub(in crate::film) fn apply(
    halves: &mut [Vec<PixelSum>],
    file: &File,
    path: &Path,
    sign: Sign,
) -> Result<(), ApplyError> {
    let length = file.metadata().map_err(|reason| ApplyError::File(unreadable(path, &reason)))?.len();
    let opened =
        Opened::new(BufReader::new(At { file, place: 0 }), length, path).map_err(ApplyError::File)?;
    if !opened.head.has_bands() {
        // Only its end tells whether such a film is whole.
        let whole = read(BufReader::new(At { file, place: 0 }), length, path).map_err(ApplyError::File)?;
        for (sums, more) in halves.iter_mut().zip(&whole.film.halves) {
            change(sums, more, sign);
        }
        return Ok(());
    }
    drop(opened);
    let outcomes = run_all(halves, file, length, path, sign, None);
    let failure = outcomes.iter().find_map(|(_, outcome)| outcome.as_ref().err().cloned());
    let Some(failure) = failure else { return Ok(()) };
    let done: Vec<u32> = outcomes.iter().map(|(done, _)| *done).collect();
    let back = if sign == Sign::Plus { Sign::Minus } else { Sign::Plus };
    let again = run_all(halves, file, length, path, back, Some(&done));
    match again.into_iter().find_map(|(_, outcome)| outcome.err()) {
        None => Err(ApplyError::File(failure)),
        Some(_) => Err(ApplyError::Lost(failure)),
    }
}

/// Gives each thread some bands, of which it applies all, or the number in `counts`. Returns how many each has applied.
fn run_all(
    halves: &mut [Vec<PixelSum>],
    file: &File,
    length: u64,
    path: &Path,
    sign: Sign,
    counts: Option<&[u32]>,
) -> Vec<(u32, Result<(), CheckpointError>)> {
    let about = Opened::new(BufReader::new(At { file, place: 0 }), length, path).map(|opened| opened.about);
    let (width, height) = match about {
        Ok(about) => (about.width, about.height),
        Err(error) => return vec![(0, Err(error))],
    };
    let bands = band_count(height);
    let threads = counts.map_or_else(|| threads().min(bands as usize), <[u32]>::len);
    let mut rest: Vec<&mut [PixelSum]> = halves.iter_mut().map(Vec::as_mut_slice).collect();
    let run = |first: u32, count: u32, mut sums: Vec<&mut [PixelSum]>| {
        let mut done = 0;
        if count == 0 {
            return (0, Ok(()));
        }
        let reader = BufReader::with_capacity(BUFFER, At { file, place: 0 });
        let base = band_rows(first, height).start as usize * width as usize;
        let outcome = Opened::new(reader, length, path).and_then(|opened| {
            for_each_band(opened, first..first + count, |pixels, band| {
                for (sums, more) in sums.iter_mut().zip(band) {
                    change(&mut sums[pixels.start - base..pixels.end - base], more, sign);
                }
                done += 1;
            })
        });
        (done, outcome.map(drop))
    };
    thread::scope(|scope| {
        let mut workers = Vec::new();
        for index in 0..threads as u32 {
            let share = |index: u32| (u64::from(bands) * u64::from(index) / threads as u64) as u32;
            let (first, end) = (share(index), share(index + 1));
            let pixels = band_rows(first, height).start..band_rows(end - 1, height).end;
            let pixels = pixels.len() * width as usize;
            let mut own = Vec::new();
            rest = std::mem::take(&mut rest)
                .into_iter()
                .map(|half| {
                    let (mine, others) = half.split_at_mut(pixels);
                    own.push(mine);
                    others
                })
                .collect();
            let count = counts.and_then(|counts| counts.get(index as usize)).copied().unwrap_or(end - first);
            let run = &run;
            workers.push(scope.spawn(move || run(first, count, own)));
        }
        let fallen = |_| (0, Err(unreadable(path, &ErrorKind::Other.into())));
        workers.into_iter().map(|worker| worker.join().unwrap_or_else(fallen)).collect()
    })
}

fn change(sums: &mut [PixelSum], more: &[PixelSum], sign: Sign) {
    for (sum, more) in sums.iter_mut().zip(more) {
        for (k, more) in sum.0.iter_mut().zip(more.0) {
            *k = if sign == Sign::Plus { k.wrapping_add(more) } else { k.wrapping_sub(more) };
        }
    }
}

fn unreadable(path: &Path, reason: &io::Error) -> CheckpointError {
    InputError::Unreadable { path: path.to_owned(), reason: reason.to_string() }.into()
}

/// A reader with a place of its own in a file that others read too.
struct At<'a> {
    file: &'a File,
    place: u64,
}

impl Read for At<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        #[cfg(unix)]
        let count = std::os::unix::fs::FileExt::read_at(self.file, bytes, self.place)?;
        #[cfg(windows)]
        let count = std::os::windows::fs::FileExt::seek_read(self.file, bytes, self.place)?;
        self.place += count as u64;
        Ok(count)
    }
}

impl Seek for At<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (base, offset) = match to {
            SeekFrom::Start(place) => (place, 0),
            SeekFrom::Current(offset) => (self.place, offset),
            SeekFrom::End(offset) => (self.file.metadata()?.len(), offset),
        };
        self.place = base.checked_add_signed(offset).ok_or(ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}
