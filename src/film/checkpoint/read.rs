//! Reading the sums of a film file, band by band. The head, the file's length and the memory needed are checked first.

use super::head::{Head, Texts, band_checksum, band_count, band_rows};
use super::open::Opened;
use super::planes::Row;
use super::{CheckpointError, Film, FilmFile, PixelSum};
use crate::film::FIXED_POINT_MAX;
use exr::block::UncompressedBlock;
use exr::block::reader::ChunksReader;
use std::io::{Read, Seek};
use std::ops::Range;
use std::path::Path;

/// Reads a film from a reader of `length` bytes. The film is identical to the bit to the one that was written.
/// Messages name `path`.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn read(reader: impl Read + Seek, length: u64, path: &Path) -> Result<FilmFile, CheckpointError> {
    read_opened(Opened::new(reader, length, path)?)
}

/// The film of an opened file.
pub(super) fn read_opened(opened: Opened<impl Read + Seek>) -> Result<FilmFile, CheckpointError> {
    let (file, about, texts) = (opened.file, opened.about.clone(), opened.texts.clone());
    let film = Film::try_new(about.width, about.height, about.halves);
    let mut halves = film.map_err(|error| file.no_film(error))?.halves;
    let head = for_each_band(opened, 0..band_count(about.height), |pixels, sums| {
        for (to, from) in halves.iter_mut().zip(sums) {
            to[pixels.clone()].copy_from_slice(from);
        }
    })?;
    let [recipe, comments] = &texts;
    if !head.has_bands() && !head.has_sums(Texts { recipe, comments }, &halves) {
        return Err(file.damaged("the sums do not match their checksum"));
    }
    let film = Film::from_parts(about.width, about.height, halves, about.samples, about.rejected);
    Ok(FilmFile { film: film.map_err(|error| file.no_film(error))?, description: about.description })
}

/// Reads some bands of a film in order, and hands each to `take` with the places of its pixels once it has been
/// checked. (Films of version 3 have nothing to check a band with.)
pub(super) fn for_each_band<R: Read + Seek>(
    opened: Opened<R>,
    bands: Range<u32>,
    mut take: impl FnMut(Range<usize>, &[Vec<PixelSum>]),
) -> Result<Head, CheckpointError> {
    let Opened { file, head, about, planes, reader, .. } = opened;
    let (width, has_bands) = (about.width as usize, head.has_bands());
    let rows = band_rows(bands.start, about.height).start..band_rows(bands.end - 1, about.height).end;
    let limits: Vec<u64> = (0..about.halves)
        .map(|half| about.samples.count_in_half(half, about.halves).saturating_mul(FIXED_POINT_MAX.into()))
        .collect();
    let unit = Film::fixed_point(about.samples.count());
    let wanted = |row: usize| (rows.start as usize..rows.end as usize).contains(&row);
    let chunks = reader.filter_chunks(true, |_, _, block| wanted(block.pixel_position.y()));
    let mut chunks = chunks.map_err(|error| file.damaged(error))?.sequential_decompressor(true);
    let (mut row, mut words) = (Row::new(width), vec![0; width]);
    for band in bands {
        let rows = band_rows(band, about.height);
        let named = |what: &dyn std::fmt::Display| {
            file.damaged(format!("the rows {} to {}: {what}", rows.start, rows.end - 1))
        };
        let mut sums = vec![vec![PixelSum::default(); width * rows.len()]; about.halves];
        for (index, y) in rows.clone().enumerate() {
            let block = match chunks.decompress_next_block() {
                Some(Ok(block)) => block,
                Some(Err(error)) => return Err(named(&error)),
                None => return Err(named(&"they are missing")),
            };
            if block.index.pixel_position.y() != y as usize {
                return Err(named(&"they are not in order"));
            }
            let place = index * width..(index + 1) * width;
            let mut halves: Vec<&mut [PixelSum]> =
                sums.iter_mut().map(|half| &mut half[place.clone()]).collect();
            read_row(&block, chunks.meta_data(), &planes, &mut row, &mut words, &mut halves)
                .map_err(|error| named(&error))?;
            if !row.finish(has_bands, unit, &mut halves) {
                return Err(named(&"the picture does not match the sums"));
            }
        }
        let checksum = band_checksum(band, sums.iter().map(Vec::as_slice));
        if has_bands && head.bands.get(band as usize) != Some(&checksum) {
            return Err(named(&"the sums do not match their checksum"));
        }
        for (sums, limit) in sums.iter().zip(&limits) {
            if sums.iter().any(|sum| sum.0.iter().any(|k| k > limit)) {
                return Err(named(&"a sum is larger than its samples can give"));
            }
        }
        take(rows.start as usize * width..rows.end as usize * width, &sums);
    }
    Ok(head)
}

fn read_row(
    block: &UncompressedBlock,
    meta: &exr::meta::MetaData,
    planes: &[super::planes::Plane],
    row: &mut Row,
    words: &mut [u32],
    halves: &mut [&mut [PixelSum]],
) -> Result<(), exr::error::Error> {
    for line in block.lines(&meta.headers[0].channels) {
        line.read_samples_into_slice(words)?;
        row.take(planes[line.location.channel], words, halves);
    }
    Ok(())
}
