//! Opening film files: the head, the file's length and its description are checked before any sum is read.

use super::head::{Head, Versions, band_count};
use super::length::check_length;
use super::planes::{self, Plane};
use super::{
    CheckpointError, Description, FILM_ATTRIBUTE, HALVES, MAGIC, RECIPE_ATTRIBUTE, SAMPLE_VERSION,
    SampleRanges, VERSION,
};
use crate::system::files::{self, InputError};
use exr::block::reader::Reader;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, MetaData};
use std::fmt::Display;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// A film file's description of its film, without the sums.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmHead {
    pub width: u32,
    pub height: u32,
    /// The samples that every pixel holds.
    pub samples: SampleRanges,
    /// Rejected samples, over all pixels.
    pub rejected: u64,
    pub description: Description,
}

/// Reads a film file's description of its film.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn read_head(path: &Path) -> Result<FilmHead, CheckpointError> {
    let (file, length) = files::open(path)?;
    Ok(Opened::new(BufReader::new(file), length, path)?.about)
}

/// A film file whose head has been read and checked.
pub(super) struct Opened<'a> {
    pub path: &'a Path,
    pub header: Header,
    pub about: FilmHead,
    pub bands: Vec<String>,
    pub planes: Vec<Plane>,
}

impl<'a> Opened<'a> {
    /// Opens a film of `length` bytes. Messages name `path`.
    pub fn new(mut reader: impl Read + Seek, length: u64, path: &'a Path) -> Result<Self, CheckpointError> {
        check_magic(&mut reader, path)?;
        let reader = Reader::read_from_buffered(reader, true).map_err(|error| damaged(path, error))?;
        let not_film = || CheckpointError::NotFilm { path: path.to_owned() };
        let [header] = reader.headers() else { return Err(not_film()) };
        let opened = Self::with(header, length, path).map_err(|error| resaved_or(error, header))?;
        opened.ok_or_else(not_film)
    }

    fn with(header: &Header, length: u64, path: &'a Path) -> Result<Option<Self>, CheckpointError> {
        let Some((head, description)) = read_texts(header, path)? else { return Ok(None) };
        if u64::from(head.halves) != HALVES {
            return Err(CheckpointError::Halves { path: path.to_owned(), halves: head.halves });
        }
        let resaved = |what| CheckpointError::Resaved { path: path.to_owned(), what };
        let planes = planes::find(header, &head).map_err(resaved)?;
        check_length(header, length).map_err(|what| damaged(path, what))?;
        let about = FilmHead {
            width: head.width,
            height: head.height,
            samples: head.ranges().map_err(|error| damaged(path, error))?,
            rejected: head.rejected,
            description,
        };
        Ok(Some(Opened { path, header: header.clone(), about, bands: head.bands, planes }))
    }
}

/// Reads the description of an EXR file; `None` if Weekender did not write one.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub(crate) fn read_description(
    mut reader: impl Read + Seek,
    path: &Path,
) -> Result<Option<Description>, CheckpointError> {
    check_magic(&mut reader, path)?;
    let meta = MetaData::read_from_buffered(reader, true).map_err(|error| damaged(path, error))?;
    let [header] = meta.headers.as_slice() else { return Ok(None) };
    match read_texts(header, path).map_err(|error| resaved_or(error, header)) {
        Err(CheckpointError::Resaved { .. }) => Ok(None),
        texts => Ok(texts?.map(|(_, description)| description)),
    }
}

/// Turns damage into [`CheckpointError::Resaved`] if the file has attributes that this program doesn't write.
pub(super) fn resaved_or(error: CheckpointError, header: &Header) -> CheckpointError {
    let (own, shared) = (&header.own_attributes, &header.shared_attributes);
    let is_ours = own.other.len() + shared.other.len() == 2 && own.capture_date.is_none();
    match error {
        CheckpointError::Damaged { path, what } if !is_ours => CheckpointError::Resaved { path, what },
        error => error,
    }
}

pub(super) fn damaged(path: &Path, what: impl Display) -> CheckpointError {
    CheckpointError::Damaged { path: path.to_owned(), what: what.to_string() }
}

fn check_magic(reader: &mut (impl Read + Seek), path: &Path) -> Result<(), CheckpointError> {
    let unreadable = |error: std::io::Error| InputError::unreadable(path, error);
    let mut magic = Vec::new();
    reader.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic).map_err(unreadable)?;
    if magic != MAGIC {
        return Err(CheckpointError::NotExr { path: path.to_owned() });
    }
    Ok(reader.rewind().map_err(unreadable)?)
}

/// The film's head and the picture's description, which match their checksum; `None` if the file has no film.
fn read_texts(header: &Header, path: &Path) -> Result<Option<(Head, Description)>, CheckpointError> {
    let Some(head) = attribute(header, FILM_ATTRIBUTE) else { return Ok(None) };
    let head = read_head_text(head, header, path)?;
    let recipe = attribute(header, RECIPE_ATTRIBUTE).ok_or_else(|| damaged(path, "its recipe is missing"))?;
    let comments = header.own_attributes.comments.as_ref().map_or(&[][..], |text| text.as_slice());
    if head.checksum([recipe, comments]) != head.head_checksum {
        return Err(damaged(path, "its head or texts do not match their checksum"));
    }
    let no_text = |_| damaged(path, "its recipe or description is not text");
    let mut description = Description::new(std::str::from_utf8(recipe).map_err(no_text)?);
    std::str::from_utf8(comments).map_err(no_text)?.lines().for_each(|line| description.set_line(line));
    Ok(Some((head, description)))
}

fn read_head_text(bytes: &[u8], header: &Header, path: &Path) -> Result<Head, CheckpointError> {
    let unreadable =
        |error: toml::de::Error| damaged(path, format!("its head cannot be read: {}", error.message()));
    let text = std::str::from_utf8(bytes).map_err(|_| damaged(path, "its head is not text"))?;
    let Versions { version, sample_version } = toml::from_str(text).map_err(unreadable)?;
    if (version, sample_version) != (VERSION.into(), Some(SAMPLE_VERSION.into())) {
        let writer = header.own_attributes.software_name.as_ref();
        return Err(CheckpointError::Version {
            path: path.to_owned(),
            // Layouts before 4 stored one number for both versions.
            layout: version,
            samples: sample_version.unwrap_or(version),
            writer: writer.map_or_else(|| "another program".to_owned(), ToString::to_string),
        });
    }
    let head: Head = toml::from_str(text).map_err(unreadable)?;
    let (checksums, bands) = (head.bands.len(), band_count(head.height) as usize);
    if checksums != bands {
        return Err(damaged(path, format!("it has {checksums} checksums of bands, but should have {bands}")));
    }
    Ok(head)
}

fn attribute<'a>(header: &'a Header, name: &str) -> Option<&'a [u8]> {
    let (own, shared) = (&header.own_attributes.other, &header.shared_attributes.other);
    match own.get(name.as_bytes()).or_else(|| shared.get(name.as_bytes()))? {
        AttributeValue::Text(text) => Some(text.as_slice()),
        _ => None,
    }
}
