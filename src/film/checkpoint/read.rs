//! Reading film files: the head, the file's length and the memory needed are checked before the sums are read.

use super::head::{Head, HeadError, Texts};
use super::{
    CheckpointError, Description, FILM_ATTRIBUTE, Film, FilmError, FilmFile, MAGIC, PixelSum, Plane,
    RECIPE_ATTRIBUTE, mean,
};
use crate::files::{self, InputError};
use crate::film::SIZE_LIMIT;
use exr::block::UncompressedBlock;
use exr::block::reader::{ChunksReader, Reader};
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, Compression, MetaData};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

/// Reads a film file. The film is identical to the bit to the one that was written.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn load(path: &Path) -> Result<FilmFile, CheckpointError> {
    let (file, length) = files::open(path)?;
    read(BufReader::new(file), length, path)
}

/// Reads a film from a reader of `length` bytes. Messages name `path`.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn read(mut reader: impl Read + Seek, length: u64, path: &Path) -> Result<FilmFile, CheckpointError> {
    let file = NamedFile { path };
    file.check_magic(&mut reader)?;
    let reader = Reader::read_from_buffered(reader, true).map_err(|error| file.damaged(error))?;
    let [header] = reader.headers() else { return Err(file.not_film()) };
    let head = file.head(header)?.ok_or_else(|| file.not_film())?;
    let planes = find_planes(header, &head).map_err(|what| file.damaged(what))?;
    check_length(header, length).map_err(|what| file.damaged(what))?;
    let description = file.description(header, &head)?;
    let samples = head.ranges().map_err(|error| file.damaged(error))?;
    let texts = texts(header).map(|texts| (texts.recipe.to_vec(), texts.comments.to_vec()));
    let (recipe, comments) = texts.ok_or_else(|| file.not_film())?;

    let film = Film::try_new(head.width, head.height, head.halves);
    let mut rows = Rows {
        planes,
        width: head.width as usize,
        halves: film.map_err(|error| file.no_film(error))?.halves,
        unit: Film::fixed_point(samples.count()),
        words: vec![0; head.width as usize],
        means: vec![[0; 3]; head.width as usize],
    };
    let chunks = reader.filter_chunks(true, |_, _, _| true).map_err(|error| file.damaged(error))?;
    chunks
        .decompress_sequential(true, |meta, block| rows.take(&meta.headers[0], &block))
        .map_err(|error| file.damaged(error))?;
    if !head.has_sums(Texts { recipe: &recipe, comments: &comments }, &rows.halves) {
        return Err(file.damaged("the sums do not match their checksum"));
    }
    let film = Film::from_parts(head.width, head.height, rows.halves, samples, head.rejected);
    Ok(FilmFile { film: film.map_err(|error| file.no_film(error))?, description })
}

/// Reads the description of an EXR file; `None` if Weekender did not write one.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub(crate) fn read_description(
    mut reader: impl Read + Seek,
    path: &Path,
) -> Result<Option<Description>, CheckpointError> {
    let file = NamedFile { path };
    file.check_magic(&mut reader)?;
    let meta = MetaData::read_from_buffered(reader, true).map_err(|error| file.damaged(error))?;
    let [header] = meta.headers.as_slice() else { return Ok(None) };
    let Some(head) = file.head(header)? else { return Ok(None) };
    file.description(header, &head).map(Some)
}

/// A file that is being read, with the path that messages name.
struct NamedFile<'a> {
    path: &'a Path,
}

impl NamedFile<'_> {
    fn path(&self) -> PathBuf {
        self.path.to_owned()
    }

    fn damaged(&self, what: impl ToString) -> CheckpointError {
        CheckpointError::Damaged { path: self.path(), what: what.to_string() }
    }

    fn not_film(&self) -> CheckpointError {
        CheckpointError::NotFilm { path: self.path() }
    }

    fn no_film(&self, error: FilmError) -> CheckpointError {
        match error {
            FilmError::Memory(reason) => CheckpointError::Memory { path: self.path(), reason },
            other => self.damaged(other),
        }
    }

    fn check_magic(&self, reader: &mut (impl Read + Seek)) -> Result<(), CheckpointError> {
        let unreadable = |reason: std::io::Error| {
            CheckpointError::from(InputError::Unreadable { path: self.path(), reason: reason.to_string() })
        };
        let mut magic = Vec::new();
        reader.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(unreadable)?;
        if magic != MAGIC {
            return Err(CheckpointError::NotExr { path: self.path() });
        }
        reader.rewind().map_err(unreadable)
    }

    /// The head of the film; `None` if the file has no film.
    fn head(&self, header: &Header) -> Result<Option<Head>, CheckpointError> {
        let Some(bytes) = attribute(header, FILM_ATTRIBUTE) else { return Ok(None) };
        let text = std::str::from_utf8(bytes).map_err(|_| self.damaged("its head is not text"))?;
        Head::read(text).map(Some).map_err(|error| match error {
            HeadError::Version(version) => CheckpointError::Version { path: self.path(), version },
            HeadError::Damaged(what) => self.damaged(what),
        })
    }

    /// The description of the picture, checked against its checksum.
    fn description(&self, header: &Header, head: &Head) -> Result<Description, CheckpointError> {
        let texts = texts(header).ok_or_else(|| self.damaged("its recipe is missing"))?;
        if !head.is_whole(texts) {
            return Err(self.damaged("its head or texts do not match their checksum"));
        }
        let no_text = |_| self.damaged("its recipe or description is not text");
        let mut description = Description::new(std::str::from_utf8(texts.recipe).map_err(no_text)?);
        for line in std::str::from_utf8(texts.comments).map_err(no_text)?.lines() {
            description.set_line(line);
        }
        Ok(description)
    }
}

fn attribute<'a>(header: &'a Header, name: &str) -> Option<&'a [u8]> {
    let (own, shared) = (&header.own_attributes.other, &header.shared_attributes.other);
    match own.get(name.as_bytes()).or_else(|| shared.get(name.as_bytes()))? {
        AttributeValue::Text(text) => Some(text.as_slice()),
        _ => None,
    }
}

fn texts(header: &Header) -> Option<Texts<'_>> {
    let comments = header.own_attributes.comments.as_ref().map_or(&[][..], |text| text.as_slice());
    Some(Texts { recipe: attribute(header, RECIPE_ATTRIBUTE)?, comments })
}

/// The plane that each channel of the file holds, if the layout is that of a film.
fn find_planes(header: &Header, head: &Head) -> Result<Vec<Plane>, String> {
    let (columns, rows) = (header.layer_size.x(), header.layer_size.y());
    if (head.width as usize, head.height as usize) != (columns, rows) {
        return Err(format!(
            "it has {columns}x{rows} pixels, but its head says {}x{}",
            head.width, head.height
        ));
    }
    if !(1..=SIZE_LIMIT).contains(&head.width) || !(1..=SIZE_LIMIT).contains(&head.height) {
        return Err(format!(
            "its size is {columns}x{rows}, but each side must have 1 to {SIZE_LIMIT} pixels"
        ));
    }
    if header.deep || header.blocks != BlockDescription::ScanLines || header.compression != Compression::RLE {
        return Err("its pixels are not stored as those of a film".to_owned());
    }
    let known = Plane::all(head.halves);
    let channels = &header.channels.list;
    for (name, plane) in &known {
        let channel = channels.iter().find(|channel| channel.name.as_slice() == name.as_bytes());
        let channel = channel.ok_or_else(|| format!("the channel {name} is missing"))?;
        if channel.sample_type != plane.sample_type() || channel.sampling.area() != 1 {
            return Err(format!("the channel {name} has the wrong type"));
        }
    }
    let found = channels.iter().map(|channel| {
        let plane = known.iter().find(|(name, _)| channel.name.as_slice() == name.as_bytes());
        plane.map(|(_, plane)| *plane).ok_or_else(|| format!("a film has no channel {}", channel.name))
    });
    let planes = found.collect::<Result<Vec<_>, _>>()?;
    if planes.len() != known.len() {
        return Err(format!("it has {} channels, but a film has {}", planes.len(), known.len()));
    }
    Ok(planes)
}

/// Fewest bytes of a chunk: its entry in the offset table, its row number and its length.
const CHUNK_BYTES: u64 = 16;

/// A chunk may always have this many bytes, whatever the file's length, because tiles may be larger than the picture.
const SMALL_CHUNK_BYTES: u64 = 16 << 20;

/// Refuses a file that is too short for what it claims to hold, and files that no reader can handle.
pub(crate) fn check_length(header: &Header, length: u64) -> Result<(), String> {
    if header.deep {
        return Err("it holds deep data".to_owned());
    }
    if header.channels.list.iter().any(|channel| channel.sampling.area() != 1) {
        return Err("some of its channels have fewer samples than pixels".to_owned());
    }
    // The largest number of bytes that one stored byte can decompress to.
    let ratio = match header.compression {
        Compression::Uncompressed => 1,
        Compression::RLE => 64,
        Compression::ZIP1 | Compression::ZIP16 => 1032,
        _ => 4096,
    };
    let (columns, rows) = (header.layer_size.x() as u64, header.layer_size.y() as u64);
    let bytes = columns.saturating_mul(rows).saturating_mul(header.channels.bytes_per_pixel as u64);
    let least = (header.chunk_count as u64).saturating_mul(CHUNK_BYTES).saturating_add(bytes / ratio);
    if length < least {
        return Err(format!(
            "it has {length} bytes, but {columns}x{rows} pixels of {} bytes need at least {least}",
            header.channels.bytes_per_pixel
        ));
    }
    let (across, down) = match header.blocks {
        BlockDescription::Tiles(tiles) => (tiles.tile_size.x(), tiles.tile_size.y()),
        BlockDescription::ScanLines => (header.layer_size.x(), header.compression.scan_lines_per_block()),
    };
    let pixels = (across as u64).saturating_mul(down as u64);
    let most = length.saturating_mul(ratio).saturating_add(SMALL_CHUNK_BYTES);
    if pixels.saturating_mul(header.channels.bytes_per_pixel as u64) > most {
        return Err(format!("it has {length} bytes, too few for chunks of {across}x{down} pixels"));
    }
    Ok(())
}

/// The sums, assembled row by row.
struct Rows {
    planes: Vec<Plane>,
    width: usize,
    halves: Vec<Vec<PixelSum>>,
    /// See [`Film::fixed_point`].
    unit: f64,
    words: Vec<u32>,
    /// Bits of the row's picture.
    means: Vec<[u32; 3]>,
}

impl Rows {
    /// Takes a block, which is one row, and compares its picture with its sums.
    fn take(&mut self, header: &Header, block: &UncompressedBlock) -> Result<(), exr::error::Error> {
        let start = block.index.pixel_position.y() * self.width;
        let pixels = start..start + self.width;
        for line in block.lines(&header.channels) {
            let plane = self.planes[line.location.channel];
            line.read_samples_into_slice(&mut self.words)?;
            match plane {
                Plane::Mean { colour } => {
                    self.means.iter_mut().zip(&self.words).for_each(|(mean, word)| mean[colour] = *word);
                }
                Plane::Sum { half, colour, shift } => {
                    for (sum, word) in self.halves[half][pixels.clone()].iter_mut().zip(&self.words) {
                        sum.0[colour] |= u64::from(*word) << shift;
                    }
                }
            }
        }
        for (pixel, means) in pixels.zip(&self.means) {
            for (colour, bits) in means.iter().enumerate() {
                let sum =
                    self.halves.iter().try_fold(0_u64, |sum, half| sum.checked_add(half[pixel].0[colour]));
                if sum.map(|sum| mean(sum, self.unit).to_bits()) != Some(*bits) {
                    return Err(exr::error::Error::Invalid("the picture does not match the sums".into()));
                }
            }
        }
        Ok(())
    }
}
