//! Opening film files: the head, the file's length and its description are checked before any sum is read.

use super::head::{Head, HeadError, Texts};
use super::length::check_length;
use super::planes::Plane;
use super::{CheckpointError, Description, FILM_ATTRIBUTE, FilmError, MAGIC, RECIPE_ATTRIBUTE, SampleRanges};
use crate::files::{self, InputError};
use exr::block::reader::Reader;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, MetaData};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

/// What a film file says about its film, without the sums.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmHead {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Halves, 1 or 2.
    pub halves: usize,
    /// The samples that every pixel holds.
    pub samples: SampleRanges,
    /// Samples that were left out, over all pixels.
    pub rejected: u64,
    /// Recipe and other entries.
    pub description: Description,
    /// Version of the file's layout.
    pub version: u32,
    /// Version of the samples.
    pub sample_version: u32,
    /// Length of the file in bytes.
    pub bytes: u64,
}

/// Reads what a film file says about its film.
///
/// # Errors
/// [`CheckpointError`]; each message says what to do.
pub fn read_head(path: &Path) -> Result<FilmHead, CheckpointError> {
    let (file, length) = files::open(path)?;
    Ok(head_of(BufReader::new(file), length, path)?.0)
}

/// The same from a reader of `length` bytes, with the film's mark: see [`Head::mark`]. Messages name `path`.
pub(in crate::film) fn head_of(
    reader: impl Read + Seek,
    length: u64,
    path: &Path,
) -> Result<(FilmHead, String), CheckpointError> {
    let opened = Opened::new(reader, length, path)?;
    Ok((opened.about, opened.head.mark()))
}

/// A film file whose head has been read and checked.
pub(super) struct Opened<'a, R> {
    pub file: NamedFile<'a>,
    pub head: Head,
    pub about: FilmHead,
    /// What each channel holds.
    pub planes: Vec<Plane>,
    /// The recipe and the comments as they are stored.
    pub texts: [Vec<u8>; 2],
    pub reader: Reader<R>,
}

impl<'a, R: Read + Seek> Opened<'a, R> {
    pub fn new(mut reader: R, length: u64, path: &'a Path) -> Result<Self, CheckpointError> {
        let file = NamedFile { path };
        file.check_magic(&mut reader)?;
        let reader = Reader::read_from_buffered(reader, true).map_err(|error| file.damaged(error))?;
        let [header] = reader.headers() else { return Err(file.not_film()) };
        let head = file.head(header)?.ok_or_else(|| file.not_film())?;
        let planes = Plane::find(header, &head).map_err(|what| file.damaged(what))?;
        check_length(header, length).map_err(|what| file.damaged(what))?;
        let description = file.description(header, &head)?;
        let samples = head.ranges().map_err(|error| file.damaged(error))?;
        let texts = texts(header).map(|texts| [texts.recipe.to_vec(), texts.comments.to_vec()]);
        let about = FilmHead {
            width: head.width,
            height: head.height,
            halves: head.halves,
            samples,
            rejected: head.rejected,
            description,
            version: head.version,
            sample_version: head.sample_version,
            bytes: length,
        };
        Ok(Opened { file, head, about, planes, texts: texts.ok_or_else(|| file.not_film())?, reader })
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
    let file = NamedFile { path };
    file.check_magic(&mut reader)?;
    let meta = MetaData::read_from_buffered(reader, true).map_err(|error| file.damaged(error))?;
    let [header] = meta.headers.as_slice() else { return Ok(None) };
    let Some(head) = file.head(header)? else { return Ok(None) };
    file.description(header, &head).map(Some)
}

/// A file that is being read, with the path that messages name.
#[derive(Clone, Copy)]
pub(super) struct NamedFile<'a> {
    pub path: &'a Path,
}

impl NamedFile<'_> {
    fn path(&self) -> PathBuf {
        self.path.to_owned()
    }

    pub fn damaged(&self, what: impl ToString) -> CheckpointError {
        CheckpointError::Damaged { path: self.path(), what: what.to_string() }
    }

    fn not_film(&self) -> CheckpointError {
        CheckpointError::NotFilm { path: self.path() }
    }

    pub fn no_film(&self, error: FilmError) -> CheckpointError {
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
            HeadError::Version(version) => {
                CheckpointError::Version { path: self.path(), version, writer: writer(header) }
            }
            HeadError::SampleVersion(version) => {
                CheckpointError::SampleVersion { path: self.path(), version, writer: writer(header) }
            }
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

/// The program that wrote the file, as far as the file says.
fn writer(header: &Header) -> String {
    let name = header.own_attributes.software_name.as_ref();
    name.map_or_else(|| "another program".to_owned(), |name| name.to_string())
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
