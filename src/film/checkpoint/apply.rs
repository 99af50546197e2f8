//! Adds the sums of a film file to sums in memory, or takes them away again, with several threads and memory for a few
//! rows.

use super::head::{band_count, band_rows};
use super::open::{NamedFile, Opened};
use super::read::{for_each_band, read_opened};
use super::threads::threads;
use super::{CheckpointError, Film, FilmFile, FilmHead, PixelSum};
use crate::files::{self, InputError};
use crate::threads::shared;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

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
    let opened = Opened::new(At::start(&file), length, path)?;
    if !opened.head.has_bands() {
        return read_opened(opened);
    }
    let (named, mark, about) = (opened.file, opened.head.mark(), opened.about);
    let film = Film::try_new(about.width, about.height, about.halves);
    let mut halves = film.map_err(|error| named.no_film(error))?.halves;
    let source = Source { file: &file, length, path, mark: &mark, size: [about.width, about.height] };
    // A film that fails is dropped, so nothing needs to be taken away.
    let applied = run_all(&mut halves, source, Sign::Plus, None);
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
    let opened = Opened::new(At::start(&file), length, path)?;
    let about = opened.about.clone();
    if opened.head.has_bands() {
        let mark = opened.head.mark();
        let source = Source { file: &file, length, path, mark: &mark, size: [about.width, about.height] };
        let outcomes = run_all(&mut [], source, Sign::Plus, None);
        outcomes.into_iter().try_for_each(|(_, outcome)| outcome)?;
    } else {
        read_opened(opened)?;
    }
    Ok(about)
}

/// Adds the sums in `file` to `halves` of the same shape, or subtracts them. The file must still hold the film of this
/// mark: see [`super::head::Head::mark`].
pub(in crate::film) fn apply(
    halves: &mut [Vec<PixelSum>],
    file: &File,
    path: &Path,
    mark: &str,
    sign: Sign,
) -> Result<(), ApplyError> {
    let length = file.metadata().map_err(|reason| ApplyError::File(unreadable(path, &reason)))?.len();
    let opened = Opened::new(At::start(file), length, path).map_err(ApplyError::File)?;
    if opened.head.mark() != mark {
        return Err(ApplyError::File(changed(path)));
    }
    if !opened.head.has_bands() {
        // Only its end tells whether such a film is whole.
        let whole = read_opened(opened).map_err(ApplyError::File)?;
        for (sums, more) in halves.iter_mut().zip(&whole.film.halves) {
            change(sums, more, sign);
        }
        return Ok(());
    }
    let size = [opened.about.width, opened.about.height];
    drop(opened);
    let source = Source { file, length, path, mark, size };
    let outcomes = run_all(halves, source, sign, None);
    let failure = outcomes.iter().find_map(|(_, outcome)| outcome.as_ref().err().cloned());
    let Some(failure) = failure else { return Ok(()) };
    let done: Option<Vec<u32>> = outcomes.iter().map(|(done, _)| *done).collect();
    let Some(done) = done else { return Err(ApplyError::Lost(failure)) };
    let back = if sign == Sign::Plus { Sign::Minus } else { Sign::Plus };
    let again = run_all(halves, source, back, Some(&done));
    match again.into_iter().find_map(|(_, outcome)| outcome.err()) {
        None => Err(ApplyError::File(failure)),
        Some(_) => Err(ApplyError::Lost(failure)),
    }
}

/// A film file that several threads read at once.
#[derive(Clone, Copy)]
struct Source<'a> {
    file: &'a File,
    length: u64,
    path: &'a Path,
    /// Each thread opens the file for itself. All must find the film of this mark.
    mark: &'a str,
    /// Pixels across and down.
    size: [u32; 2],
}

/// How many bands a thread has applied, unless that is unknown, and why it has not applied all.
type Applied = (Option<u32>, Result<(), CheckpointError>);

/// Gives each thread some bands, of which it applies all, or the number in `counts`.
fn run_all(halves: &mut [Vec<PixelSum>], source: Source, sign: Sign, counts: Option<&[u32]>) -> Vec<Applied> {
    let [width, height] = source.size;
    let bands = band_count(height);
    let threads = counts.map_or_else(|| threads().min(bands as usize), <[u32]>::len);
    let mut rest: Vec<&mut [PixelSum]> = halves.iter_mut().map(Vec::as_mut_slice).collect();
    let mut shares = Vec::with_capacity(threads);
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
        shares.push((first..first + count, own));
    }
    let work = |(bands, sums): (Range<u32>, Vec<&mut [PixelSum]>)| {
        let reader = BufReader::with_capacity(BUFFER, At { file: source.file, place: 0 });
        apply_bands(reader, source, bands, sums, sign)
    };
    let fallen = |_| (None, Err(unreadable(source.path, &ErrorKind::Other.into())));
    shared(shares, work).into_iter().map(|applied| applied.unwrap_or_else(fallen)).collect()
}

/// Applies some bands to `sums`, which begin with the first of them.
fn apply_bands(
    reader: impl Read + Seek,
    source: Source,
    bands: Range<u32>,
    mut sums: Vec<&mut [PixelSum]>,
    sign: Sign,
) -> Applied {
    if bands.is_empty() {
        return (Some(0), Ok(()));
    }
    let [width, height] = source.size;
    let base = band_rows(bands.start, height).start as usize * width as usize;
    let mut done = 0;
    let run = || -> Result<(), CheckpointError> {
        let opened = Opened::new(reader, source.length, source.path)?;
        if opened.head.mark() != source.mark {
            return Err(changed(source.path));
        }
        let add = |pixels: Range<usize>, band: &[Vec<PixelSum>]| {
            for (sums, more) in sums.iter_mut().zip(band) {
                change(&mut sums[pixels.start - base..pixels.end - base], more, sign);
            }
            done += 1;
        };
        for_each_band(opened, bands, add).map(drop)
    };
    // What was applied before a panic of the decompressor must be known, so that it can be taken away.
    let outcome = catch_unwind(AssertUnwindSafe(run));
    let fallen = |_| Err(NamedFile { path: source.path }.damaged("its rows cannot be read"));
    (Some(done), outcome.unwrap_or_else(fallen))
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

fn changed(path: &Path) -> CheckpointError {
    CheckpointError::Changed { path: path.to_owned() }
}

/// A reader with a place of its own in a file that others read too.
struct At<'a> {
    file: &'a File,
    place: u64,
}

impl<'a> At<'a> {
    /// Reads the head of a file from its start.
    fn start(file: &'a File) -> BufReader<Self> {
        BufReader::new(At { file, place: 0 })
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Description;
    use std::io::Cursor;

    /// A reader that panics where a decompressor could.
    struct Panicking<'a> {
        bytes: Cursor<&'a [u8]>,
        limit: u64,
    }

    impl Read for Panicking<'_> {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            let count = self.bytes.read(bytes)?;
            assert!(self.bytes.position() <= self.limit, "a slip");
            Ok(count)
        }
    }

    impl Seek for Panicking<'_> {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.bytes.seek(to)
        }
    }

    /// A film of three bands.
    fn film() -> Film {
        let mut film = Film::new(4, 40, 2);
        film.record(0..10, 0).unwrap();
        for (index, sum) in film.halves_mut().iter_mut().flatten().enumerate() {
            sum.0 = [index as u64 + 1; 3];
        }
        film
    }

    #[test]
    fn what_was_applied_before_a_panic_is_counted() {
        let (film, path) = (film(), Path::new("x.exr"));
        let mut file = Cursor::new(Vec::new());
        super::super::write(&film, &Description::new("r"), &mut file).unwrap();
        let bytes = file.into_inner();
        let (length, cursor) = (bytes.len() as u64, Cursor::new(bytes.as_slice()));
        let mark = Opened::new(cursor.clone(), length, path).unwrap().head.mark();
        let unused = tempfile::tempfile().unwrap();
        let source = Source { file: &unused, length, path, mark: &mark, size: [4, 40] };
        let applied = |limit: u64| {
            let mut sums = vec![PixelSum::default(); 4 * 40];
            let reader = Panicking { bytes: cursor.clone(), limit };
            let (done, outcome) = apply_bands(reader, source, 0..3, vec![sums.as_mut_slice()], Sign::Plus);
            let rows = sums.chunks(4).take_while(|row| row.iter().all(|sum| sum.0 != [0; 3])).count();
            (done, rows, outcome.is_ok())
        };
        assert_eq!(applied(length), (Some(3), 40, true));
        // The last row is in the last band.
        assert_eq!(applied(length - 1), (Some(2), 32, false));
    }
}
