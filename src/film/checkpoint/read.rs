//! Reading the sums of a film file. The head, the file's length and the memory needed are checked first.

use super::head::{BAND_ROWS, band_checksum, band_count, band_rows};
use super::open::{FilmHead, Opened, damaged, resaved_or};
use super::planes::Row;
use super::{CheckpointError, Film, FilmError, FilmFile, PixelSum, threads};
use crate::system::files;
use crate::system::threads::shared;
use exr::block::reader::{ChunksReader, Reader};
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

/// Bytes that a thread reads at once.
const BUFFER: usize = 1 << 18;

/// Reads a film file. The film equals the one that was written to the bit.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn load(path: &Path) -> Result<FilmFile, CheckpointError> {
    let (file, length) = files::open(path)?;
    let opened = Opened::new(At::start(&file), length, path)?;
    let FilmHead { width, height, .. } = opened.about;
    let no_film = |error| match error {
        FilmError::Memory(reason) => CheckpointError::Memory { path: path.to_owned(), reason },
        other => damaged(path, other),
    };
    let mut film = Film::try_new(width, height).map_err(no_film)?;
    opened.read_all(&file, film.halves_mut()).map_err(|error| resaved_or(error, &opened.header))?;
    let FilmHead { samples, rejected, description, .. } = opened.about;
    Ok(FilmFile { film: film.with_samples(samples, rejected).map_err(no_film)?, description })
}

impl Opened<'_> {
    /// Reads all bands with several threads.
    fn read_all(&self, file: &File, halves: &mut [Vec<PixelSum>]) -> Result<(), CheckpointError> {
        let bands = band_count(self.about.height);
        let each = bands.div_ceil(threads() as u32);
        let mut shares: Vec<(Range<u32>, Vec<&mut [PixelSum]>)> = (0..bands)
            .step_by(each as usize)
            .map(|first| (first..bands.min(first + each), Vec::new()))
            .collect();
        for half in halves {
            let parts = half.chunks_mut((each * BAND_ROWS * self.about.width) as usize);
            shares.iter_mut().zip(parts).for_each(|(share, part)| share.1.push(part));
        }
        let outcomes = shared(shares, |(bands, sums)| {
            let reader = Reader::read_from_buffered(At::start(file), true);
            let reader = reader.map_err(|error| damaged(self.path, error))?;
            // Another film may have been copied into the file since it was opened.
            if reader.headers() != [self.header.clone()] {
                return Err(CheckpointError::Changed { path: self.path.to_owned() });
            }
            self.read_bands(reader, bands, sums)
        });
        let panicked = |_| Err(damaged(self.path, "its rows cannot be read"));
        outcomes.into_iter().try_for_each(|outcome| outcome.unwrap_or_else(panicked))
    }

    /// Reads some bands in order and checks each. `sums` are their places in each half.
    fn read_bands(
        &self,
        reader: Reader<BufReader<At>>,
        bands: Range<u32>,
        mut sums: Vec<&mut [PixelSum]>,
    ) -> Result<(), CheckpointError> {
        let FilmHead { width, height, samples, .. } = &self.about;
        let (width, unit) = (*width as usize, Film::fixed_point(samples.count()));
        let first_row = band_rows(bands.start, *height).start as usize;
        let wanted = first_row..band_rows(bands.end - 1, *height).end as usize;
        let chunks = reader.filter_chunks(true, |_, _, block| wanted.contains(&block.pixel_position.y()));
        let mut chunks = chunks.map_err(|error| damaged(self.path, error))?.sequential_decompressor(true);
        let (mut row, mut found) = (Row::new(width), [Vec::new(), Vec::new()]);
        for band in bands {
            found.iter_mut().for_each(Vec::clear);
            let rows = band_rows(band, *height);
            let named = |what: &str| {
                damaged(self.path, format!("the rows {} to {}: {what}", rows.start, rows.end - 1))
            };
            for y in rows.clone() {
                let block = match chunks.decompress_next_block() {
                    Some(Ok(block)) if block.index.pixel_position.y() == y as usize => block,
                    Some(Ok(_)) => return Err(named("they are not in order")),
                    Some(Err(error)) => return Err(named(&error.to_string())),
                    None => return Err(named("they are missing")),
                };
                row.read(&block, &chunks.meta_data().headers[0].channels, &self.planes)
                    .map_err(|error| named(&error.to_string()))?;
                if !row.append_sums(unit, &mut found) {
                    return Err(named("the picture does not match the sums"));
                }
            }
            if self.bands.get(band as usize) != Some(&band_checksum(band, found.iter().map(Vec::as_slice))) {
                return Err(named("the sums do not match their checksum"));
            }
            let start = (rows.start as usize - first_row) * width;
            for (to, from) in sums.iter_mut().zip(&found) {
                to[start..start + from.len()].copy_from_slice(from);
            }
        }
        Ok(())
    }
}

/// A reader with its own position in a shared file.
struct At<'a> {
    file: &'a File,
    place: u64,
}

impl<'a> At<'a> {
    fn start(file: &'a File) -> BufReader<Self> {
        BufReader::with_capacity(BUFFER, At { file, place: 0 })
    }
}

impl Read for At<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = files::read_at(self.file, bytes, self.place)?;
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
    use crate::film::{Description, checkpoint::save};

    #[test]
    fn film_replaced_while_read_is_noticed() {
        let directory = tempfile::tempdir().unwrap();
        let [path, other] = ["a.exr", "b.exr"].map(|name| directory.path().join(name));
        for (path, samples) in [(&path, 0..4), (&other, 4..6)] {
            let mut film = Film::new(4, 40);
            film.record(samples, 0).unwrap();
            save(path, &film, &Description::new("r")).unwrap();
        }
        let (file, length) = files::open(&path).unwrap();
        let opened = Opened::new(At::start(&file), length, &path).unwrap();
        opened.read_all(&file, &mut []).unwrap();
        std::fs::copy(&other, &path).unwrap();
        let changed = opened.read_all(&file, &mut []).unwrap_err();
        assert_eq!(changed, CheckpointError::Changed { path: path.clone() });
    }
}
