//! Film files: an OpenEXR picture that any viewer opens, and in it the exact sums, so that the same file is
//! picture, checkpoint and part to be merged.
//!
//! One part, scan lines, lossless. Channels `R`, `G`, `B` (float) are the mean. Channels `sum.a.R.lo`,
//! `sum.a.R.hi` and so on (32-bit unsigned) are the low and high words of each half's sums. Three texts go with
//! them: `comments` has the description's lines, `weekenderRecipe` the recipe, `weekenderFilm` what [`Head`]
//! says.

use super::{
    Description, FIXED_POINT_SCALE, Film, FilmError, PixelSum, SampleRanges, WriteError, replace_file,
};
use exr::block::reader::ChunksReader;
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::{
    AttributeValue, ChannelDescription, Compression, LineOrder, MetaData, SampleType, SmallVec, Text,
};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// The version of what is in a film file beyond the picture, and of the numbers that its samples are made from: films
/// of other numbers are neither resumed nor merged.
pub const VERSION: u32 = 2;

/// How an OpenEXR file begins.
pub(crate) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

const FILM_ATTRIBUTE: &str = "weekenderFilm";
const RECIPE_ATTRIBUTE: &str = "weekenderRecipe";

/// What a film file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    /// The sums.
    pub film: Film,
    /// The recipe of the film's job, and what else is said of it.
    pub description: Description,
}

/// A file that is no film.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error("cannot read {}: {reason}; check the name and that you may read it", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// Another kind of file.
    #[error("{} is no EXR file; a film is kept in a file that ends in .exr", path.display())]
    NotExr {
        /// The file.
        path: PathBuf,
    },
    /// A plain picture.
    #[error(
        "{} is a picture without the sums of its samples, so nothing can be added to it; only an .exr file that Weekender wrote has them",
        path.display()
    )]
    NotFilm {
        /// The file.
        path: PathBuf,
    },
    /// Written by another version.
    #[error(
        "{} holds a film of version {version}, but this program reads version {VERSION}; use the one that wrote it",
        path.display()
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        version: i64,
    },
    /// Something in it is missing or was changed.
    #[error("{} is damaged: {what}; use an earlier copy or render it again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// There is no memory for it.
    #[error("{} needs {bytes} bytes of memory, which are not to be had; close other programs", path.display())]
    Memory {
        /// The file.
        path: PathBuf,
        /// Bytes of its sums.
        bytes: u64,
    },
}

/// What a film file says of its sums.
#[derive(Serialize, Deserialize)]
struct Head {
    version: u32,
    halves: usize,
    samples: Vec<[u64; 2]>,
    rejected: u64,
    /// Of all sums: see [`checksum`].
    checksum: String,
}

/// What a channel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Plane {
    Mean { colour: usize },
    Sum { half: usize, colour: usize, shift: u32 },
}

impl Plane {
    /// All that a film of `half_count` halves has, with their names.
    fn all(half_count: usize) -> Vec<(String, Plane)> {
        let mut planes = Vec::new();
        for (colour, name) in ["R", "G", "B"].into_iter().enumerate() {
            planes.push((name.to_owned(), Plane::Mean { colour }));
            for (half, half_name) in ["a", "b"].into_iter().enumerate().take(half_count) {
                for (shift, word) in [(0, "lo"), (32, "hi")] {
                    planes
                        .push((format!("sum.{half_name}.{name}.{word}"), Plane::Sum { half, colour, shift }));
                }
            }
        }
        planes
    }

    fn sample_type(self) -> SampleType {
        match self {
            Plane::Mean { .. } => SampleType::F32,
            Plane::Sum { .. } => SampleType::U32,
        }
    }
}

/// FNV-1a over the sums, word by word. It finds damage, not intent.
fn checksum(halves: &[Vec<PixelSum>]) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for sum in halves.iter().flatten() {
        for k in sum.0 {
            hash = (hash ^ k).wrapping_mul(0x0000_0100_0000_01b3);
            // The product carries upwards only: without this, high bits of a sum would reach few bits.
            hash ^= hash >> 32;
        }
    }
    format!("{hash:016x}")
}

fn text(text: &str) -> Text {
    // UTF-8 as it is, which is what current readers expect.
    Text::from_slice_unchecked(text.as_bytes())
}

fn invalid(reason: impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason.to_string())
}

fn io_error(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => invalid(other),
    }
}

/// Writes a film file in place of `path`. Beside the film it takes the memory of one row.
///
/// # Errors
/// [`WriteError`]; the file that was there is then as it was.
pub fn save(path: &Path, film: &Film, description: &Description) -> Result<(), WriteError> {
    replace_file(path, |writer| write(film, description, writer))
}

/// Writes a film file.
///
/// # Errors
/// Those of `writer`.
pub(crate) fn write(
    film: &Film,
    description: &Description,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let head = Head {
        version: VERSION,
        halves: film.halves().len(),
        samples: film.samples().iter().map(|range| [range.start, range.end]).collect(),
        rejected: film.rejected(),
        checksum: checksum(film.halves()),
    };
    let head = toml::to_string(&head).map_err(invalid)?;

    // The format wants channels in the order of their names.
    let mut planes = Plane::all(film.halves().len());
    planes.sort_by(|a, b| a.0.cmp(&b.0));
    let channels: SmallVec<[ChannelDescription; 5]> = planes
        .iter()
        .map(|(name, plane)| ChannelDescription::new(text(name), plane.sample_type(), false))
        .collect();
    let size = (film.width() as usize, film.height() as usize);
    // RLE drops the empty high words and leaves the low ones, which are noise: ZIP takes many times as long for
    // little.
    let mut header = Header::new(text("Weekender"), size, channels).with_encoding(
        Compression::RLE,
        BlockDescription::ScanLines,
        LineOrder::Increasing,
    );
    header.own_attributes.software_name = Some(text(concat!("Weekender ", env!("CARGO_PKG_VERSION"))));
    header.own_attributes.comments =
        Some(text(&description.lines().map(|line| line + "\n").collect::<String>()));
    // One in each of the two maps, so that a film always becomes the same bytes.
    header.own_attributes.other.insert(text(FILM_ATTRIBUTE), AttributeValue::Text(text(&head)));
    header
        .shared_attributes
        .other
        .insert(text(RECIPE_ATTRIBUTE), AttributeValue::Text(text(description.recipe())));

    let unit = film.sample_count().max(1) as f64 * FIXED_POINT_SCALE;
    let mut headers = SmallVec::new();
    headers.push(header);
    exr::block::write(writer, headers, true, |meta, chunks| {
        let mut compressor = chunks.sequential_blocks_compressor(&meta);
        for (index, block) in
            meta.collect_ordered_blocks(|index| row_block(film, &planes, unit, &meta, index))
        {
            compressor.compress_block(index, block)?;
        }
        Ok(())
    })
    .map_err(io_error)
}

fn row_block(
    film: &Film,
    planes: &[(String, Plane)],
    unit: f64,
    meta: &MetaData,
    index: BlockIndex,
) -> UncompressedBlock {
    let width = film.width() as usize;
    let mut data = Vec::with_capacity(index.pixel_size.area() * meta.headers[0].channels.bytes_per_pixel);
    let first_row = index.pixel_position.y();
    for row in first_row..first_row + index.pixel_size.y() {
        let pixels = row * width..(row + 1) * width;
        for (_, plane) in planes {
            match *plane {
                Plane::Mean { colour } => data.extend(
                    pixels
                        .clone()
                        .flat_map(|i| ((film.pixel_sum(i).0[colour] as f64 / unit) as f32).to_ne_bytes()),
                ),
                Plane::Sum { half, colour, shift } => data.extend(
                    film.halves()[half][pixels.clone()]
                        .iter()
                        .flat_map(|sum| ((sum.0[colour] >> shift) as u32).to_ne_bytes()),
                ),
            }
        }
    }
    UncompressedBlock { index, data }
}

/// Reads a film file: the same film to the bit, and its description.
///
/// # Errors
/// [`CheckpointError`], each with what to do.
pub fn load(path: &Path) -> Result<FilmFile, CheckpointError> {
    read(open(path)?, 0, path)
}

/// The same from a reader; `path` stands in messages.
///
/// # Errors
/// [`CheckpointError`], each with what to do.
pub fn read(reader: impl Read + Seek, _length: u64, path: &Path) -> Result<FilmFile, CheckpointError> {
    let damaged = |what: String| CheckpointError::Damaged { path: path.to_owned(), what };
    let reader = exr::block::read(reader, true).map_err(|error| damaged(error.to_string()))?;

    // Read what the file says of itself.
    let not_film = || CheckpointError::NotFilm { path: path.to_owned() };
    let [header] = reader.headers() else { return Err(not_film()) };
    let head = attribute(header, FILM_ATTRIBUTE).ok_or_else(not_film)?;
    let head = read_head(path, head)?;
    let description = read_description_of(header)
        .ok_or_else(|| damaged("what it says of the picture is not text, or the recipe is missing".into()))?;
    let mut samples = SampleRanges::default();
    for [start, end] in head.samples {
        samples.insert(start..end).map_err(|error| damaged(error.to_string()))?;
    }
    let planes = find_planes(header, head.halves).map_err(damaged)?;

    // Make room.
    let (columns, rows) = (header.layer_size.x(), header.layer_size.y());
    let (Ok(width), Ok(height)) = (u32::try_from(columns), u32::try_from(rows)) else {
        return Err(damaged(format!("a size of {columns}x{rows}")));
    };
    let no_memory = |error| match error {
        FilmError::Memory { bytes } => CheckpointError::Memory { path: path.to_owned(), bytes },
        other => damaged(other.to_string()),
    };
    let mut halves = Film::try_new(width, height, head.halves).map_err(no_memory)?.halves;

    // Put the words together, row by row.
    let mut words = vec![0_u32; columns];
    let chunks = reader.filter_chunks(true, |_, _, _| true).map_err(|error| damaged(error.to_string()))?;
    chunks
        .decompress_sequential(true, |meta, block| {
            for line in block.lines(&meta.headers[0].channels) {
                let place = line.location;
                if let Some(Plane::Sum { half, colour, shift }) = planes[place.channel] {
                    line.read_samples_into_slice(&mut words)?;
                    let start = place.position.y() * columns;
                    for (sum, word) in halves[half][start..start + columns].iter_mut().zip(&words) {
                        sum.0[colour] |= u64::from(*word) << shift;
                    }
                }
            }
            Ok(())
        })
        .map_err(|error| damaged(error.to_string()))?;

    if checksum(&halves) != head.checksum {
        return Err(damaged("the sums are not those that were written".into()));
    }
    let film = Film::from_parts(width, height, halves, samples, head.rejected)
        .map_err(|error| damaged(error.to_string()))?;
    Ok(FilmFile { film, description })
}

/// What an EXR file says about itself; `None` if it says nothing that Weekender wrote.
pub(crate) fn read_description(reader: impl Read) -> io::Result<Option<Description>> {
    let meta = MetaData::read_from_buffered(reader, true).map_err(io_error)?;
    Ok(meta.headers.first().and_then(read_description_of))
}

fn open(path: &Path) -> Result<BufReader<File>, CheckpointError> {
    let unreadable =
        |reason: io::Error| CheckpointError::Unreadable { path: path.to_owned(), reason: reason.to_string() };
    let mut reader = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut magic = Vec::new();
    reader.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(unreadable)?;
    if magic != MAGIC {
        return Err(CheckpointError::NotExr { path: path.to_owned() });
    }
    reader.rewind().map_err(unreadable)?;
    Ok(reader)
}

fn attribute<'a>(header: &'a Header, name: &str) -> Option<&'a str> {
    let (own, shared) = (&header.own_attributes.other, &header.shared_attributes.other);
    match own.get(name.as_bytes()).or_else(|| shared.get(name.as_bytes()))? {
        AttributeValue::Text(text) => std::str::from_utf8(text.as_slice()).ok(),
        _ => None,
    }
}

fn read_description_of(header: &Header) -> Option<Description> {
    let mut description = Description::new(attribute(header, RECIPE_ATTRIBUTE)?);
    let comments = header.own_attributes.comments.as_ref().map_or(&[][..], |text| text.as_slice());
    for line in std::str::from_utf8(comments).ok()?.lines() {
        description.set_line(line);
    }
    Some(description)
}

fn read_head(path: &Path, text: &str) -> Result<Head, CheckpointError> {
    let damaged = |what: String| CheckpointError::Damaged { path: path.to_owned(), what };
    // The version first: another one may say other things.
    let table: toml::Table = text.parse().map_err(|_| damaged("its head cannot be read".into()))?;
    let version = table.get("version").and_then(toml::Value::as_integer);
    match version.ok_or_else(|| damaged("its head has no version".into()))? {
        version if version == i64::from(VERSION) => {}
        version => return Err(CheckpointError::Version { path: path.to_owned(), version }),
    }
    let head: Head = table
        .try_into()
        .map_err(|error: toml::de::Error| damaged(format!("its head cannot be read: {}", error.message())))?;
    if !(1..=2).contains(&head.halves) {
        return Err(damaged(format!("{} halves, where there are 1 or 2", head.halves)));
    }
    Ok(head)
}

/// What each of the file's channels is.
fn find_planes(header: &Header, half_count: usize) -> Result<Vec<Option<Plane>>, String> {
    let mut planes = vec![None; header.channels.list.len()];
    for (name, plane) in Plane::all(half_count) {
        let found =
            header.channels.list.iter().position(|channel| channel.name.as_slice() == name.as_bytes());
        let index = found.ok_or_else(|| format!("the channel {name} is missing"))?;
        let channel = &header.channels.list[index];
        if channel.sample_type != plane.sample_type() || channel.sampling.area() != 1 {
            return Err(format!("the channel {name} is of another type"));
        }
        planes[index] = Some(plane);
    }
    Ok(planes)
}
