//! Picture files: 8-bit PNG, binary PPM (P6), and OpenEXR, which contains the whole film. All of them include a
//! [`Description`]. Pictures of other programs can be read too: [`read_picture`].

mod limits;
mod pfm;
mod png;
mod ppm;
mod read;

pub use read::{Encoding, ReadPicture, decode_picture, read_picture};

pub use crate::film::{Description, RECIPE_KEY, key};

use crate::files::{self, InputError, WriteError, replace_file};
use crate::film::{CheckpointError, Film, checkpoint};
use crate::stages::Transfer;
use std::io::{self, BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// How a picture is kept in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputFormat {
    /// 8-bit RGB.
    Png,
    /// Binary PPM, 8-bit RGB: the book's format, as bytes.
    P6,
    /// Linear float RGB and the film's exact sums: see [`crate::film::checkpoint`].
    Exr,
}

impl OutputFormat {
    /// All of them.
    pub const ALL: [OutputFormat; 3] = [OutputFormat::Png, OutputFormat::P6, OutputFormat::Exr];

    /// What its files end in, with the dot.
    pub fn ending(self) -> &'static str {
        match self {
            OutputFormat::Png => ".png",
            OutputFormat::P6 => ".ppm",
            OutputFormat::Exr => ".exr",
        }
    }

    /// The format that a file's ending stands for, in capitals or not.
    ///
    /// # Errors
    /// [`OutputError::UnknownEnding`], which lists those that are known.
    pub fn from_path(path: &Path) -> Result<Self, OutputError> {
        let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy().to_lowercase()));
        OutputFormat::ALL
            .into_iter()
            .find(|format| Some(format.ending()) == ending.as_deref())
            .ok_or_else(|| OutputError::UnknownEnding { path: path.to_owned() })
    }
}

/// A picture that cannot be written, or cannot be read for what it says.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The file's name does not say what to write.
    #[error(
        "the name {} does not end in a known picture format; let it end in one of {}",
        path.display(), OutputFormat::ALL.map(OutputFormat::ending).join(", ")
    )]
    UnknownEnding {
        /// The file.
        path: PathBuf,
    },
    /// The file system, or what it says.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file cannot be read, or is none.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A film that is damaged, or of another version.
    #[error(transparent)]
    Film(#[from] CheckpointError),
    /// What is in the file cannot be read.
    #[error("cannot read {}: {reason}; check the name and that it is a whole picture", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: io::Error,
    },
    /// A picture of somebody else's.
    #[error(
        "{} does not say how it was made; only PNG, PPM and EXR files that Weekender wrote do, as long as no other program saved them again",
        path.display()
    )]
    NoDescription {
        /// The file.
        path: PathBuf,
    },
}

/// Writes a picture in place of `path`, in the format of its ending. `transfer` matters for 8 bits only; an EXR
/// file is linear and holds the film.
///
/// # Errors
/// [`OutputError`]; the file that was there is then as it was.
pub fn write_image(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    description: &Description,
) -> Result<(), OutputError> {
    let format = OutputFormat::from_path(path)?;
    replace_file(path, |writer| match format {
        OutputFormat::Png => png::write(film, transfer, description, writer),
        OutputFormat::P6 => ppm::write(film, transfer, description, writer),
        OutputFormat::Exr => checkpoint::write(film, description, writer),
    })?;
    Ok(())
}

/// Reads what a picture says about itself. What the file is shows in its first bytes; its name does not matter.
///
/// # Errors
/// [`OutputError::Input`], [`OutputError::Read`], [`OutputError::Film`] or [`OutputError::NoDescription`].
pub fn read_description(path: &Path) -> Result<Description, OutputError> {
    let (file, _) = files::open(path)?;
    decode_description(BufReader::new(file), path)
}

/// The same from a reader; `path` stands in messages.
///
/// # Errors
/// As [`read_description`].
pub fn decode_description(mut reader: impl BufRead + Seek, path: &Path) -> Result<Description, OutputError> {
    let unreadable = |reason| OutputError::Read { path: path.to_owned(), reason };
    let start = start_of(&mut reader).map_err(unreadable)?;
    let found = match start.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => png::read_description(reader).map_err(unreadable)?,
        [b'P', b'6', ..] => ppm::read_description(reader).map_err(unreadable)?,
        start if start.starts_with(&checkpoint::MAGIC) => checkpoint::read_description(reader, path)?,
        _ => None,
    };
    found.ok_or_else(|| OutputError::NoDescription { path: path.to_owned() })
}

/// The first bytes, which tell what a file is.
fn start_of(reader: &mut (impl Read + Seek)) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    reader.by_ref().take(8).read_to_end(&mut start)?;
    reader.rewind()?;
    Ok(start)
}

/// Most bytes that the texts of a picture may have when unpacked.
const TEXT_LIMIT: usize = 64 << 20;

/// All pixels, 8-bit RGB, a row at a time: a picture may be larger than one likes to have in memory again.
fn write_rows(film: &Film, transfer: Transfer, writer: &mut impl Write) -> io::Result<()> {
    let mut bytes = vec![0; 3 * film.width() as usize];
    for row in 0..film.height() {
        film.resolve_rows(row..row + 1, transfer, &mut bytes);
        writer.write_all(&bytes)?;
    }
    Ok(())
}
