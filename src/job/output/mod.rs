//! Picture files: 8-bit PNG, PPM (P6, or P3 on request), and OpenEXR with the whole film, all with a [`Description`]; and
//! PFM, which has no place for one.
//! Pictures of other programs can be read, too: [`read_picture`].

mod apng;
mod exr;
mod limits;
mod netpbm;
mod png;
mod ppm;
mod read;

pub use apng::{FrameRate, animation_in, check_frame, write_animation};
pub use read::{
    Damage, Encoding, Linear, ReadPicture, Values, decode_picture, displayed, read_picture, srgb_to_linear,
};

pub use crate::film::{Description, RECIPE_KEY, key};

use crate::film::{CheckpointError, Film, checkpoint};
use crate::stages::Transfer;
use crate::system::files::{self, InputError, ShownPath, WriteError, replace_file};
use std::io::{self, BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Longest recipe that is read from a PNG or PPM file, bytes: about two million listed spheres.
const RECIPE_LIMIT: usize = 256 << 20;

/// File format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum OutputFormat {
    /// 8-bit RGB.
    Png,
    /// Binary PPM, 8-bit RGB: the book's format in binary form.
    #[value(name = "ppm")]
    P6,
    /// Linear float RGB and the film's exact sums: see [`crate::film::checkpoint`].
    Exr,
    /// Linear float RGB, without a description.
    Pfm,
}

impl OutputFormat {
    pub const ALL: [OutputFormat; 4] =
        [OutputFormat::Png, OutputFormat::P6, OutputFormat::Exr, OutputFormat::Pfm];

    /// File extension, with the dot.
    pub fn ending(self) -> &'static str {
        match self {
            OutputFormat::Png => ".png",
            OutputFormat::P6 => ".ppm",
            OutputFormat::Exr => ".exr",
            OutputFormat::Pfm => ".pfm",
        }
    }

    /// The format that belongs to a file name's extension, in upper or lower case.
    ///
    /// # Errors
    /// [`OutputError::UnknownEnding`], which lists the known extensions.
    pub fn from_path(path: &Path) -> Result<Self, OutputError> {
        let ending = path.extension().map(|ending| format!(".{}", ending.to_string_lossy().to_lowercase()));
        OutputFormat::ALL
            .into_iter()
            .find(|format| Some(format.ending()) == ending.as_deref())
            .ok_or_else(|| OutputError::UnknownEnding { path: path.to_owned() })
    }
}

/// Why a picture cannot be written, or its description cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error(
        "cannot tell the picture format of {}; let the name end in one of {}, or add --format",
        path.shown(), OutputFormat::ALL.map(OutputFormat::ending).join(", ")
    )]
    UnknownEnding { path: PathBuf },
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file cannot be opened, or is not a regular file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The film is damaged or of another version.
    #[error(transparent)]
    Film(#[from] CheckpointError),
    #[error("cannot read {}: {reason}", path.shown())]
    Read { path: PathBuf, reason: io::Error },
    #[error(
        "{} does not say how it was made; only PNG, PPM and EXR files written by Weekender do, unless another program has saved them again",
        path.shown()
    )]
    NoDescription { path: PathBuf },
}

impl OutputError {
    fn unreadable(path: &Path, reason: &io::Error) -> Self {
        let reason = limits::invalid(format!("{reason}; check whether the file is complete"));
        OutputError::Read { path: path.to_owned(), reason }
    }
}

/// How a PPM stores its numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum PpmForm {
    /// As bytes (P6).
    #[default]
    Binary,
    /// As text (P3), as the book writes them.
    Ascii,
}

/// How hard to compress a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PngForm {
    /// Fast.
    #[default]
    Fast,
    /// For pages that should load quickly: a quarter smaller, a tenth of a second slower.
    Small,
}

/// Variants of the formats that have several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Forms {
    /// The format, if not that of the name's extension.
    pub format: Option<OutputFormat>,
    pub ppm: PpmForm,
    pub png: PngForm,
}

/// Writes a picture to `path`, replacing an existing file, in the format of its extension. `transfer` only matters
/// for 8-bit formats; the others are linear, and an EXR file holds the film.
///
/// # Errors
/// [`OutputError`]; an existing file is then unchanged.
pub fn write_image(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    description: &Description,
) -> Result<(), OutputError> {
    write_image_as(path, film, transfer, description, Forms::default())
}

/// As [`write_image`], in the given `forms`.
///
/// # Errors
/// As for [`write_image`].
pub fn write_image_as(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    description: &Description,
    forms: Forms,
) -> Result<(), OutputError> {
    let format = forms.format.map_or_else(|| OutputFormat::from_path(path), Ok)?;
    replace_file(path, |writer| match format {
        OutputFormat::Png => png::write(film, transfer, description, forms.png, writer),
        OutputFormat::P6 => ppm::write(film, transfer, description, forms.ppm, writer),
        OutputFormat::Exr => checkpoint::write(film, None, description, writer),
        OutputFormat::Pfm => netpbm::write_pfm(film, writer),
    })?;
    Ok(())
}

/// Writes the part of a film's picture that begins at column and row `first` and has `size` pixels, as an 8-bit PNG.
///
/// # Errors
/// [`OutputError::Write`]; an existing file is then unchanged.
pub fn write_part(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    [first, size]: [[u32; 2]; 2],
    description: &Description,
) -> Result<(), OutputError> {
    let rgb8 = film.part_rgb8(transfer, first, size);
    replace_file(path, |writer| png::write_bytes(size, &rgb8, description, writer))?;
    Ok(())
}

/// Reads the description of a picture. The first bytes of the file tell its format; the name does not matter.
///
/// # Errors
/// [`OutputError::Input`], [`OutputError::Read`], [`OutputError::Film`] or [`OutputError::NoDescription`].
pub fn read_description(path: &Path) -> Result<Description, OutputError> {
    let (file, _) = files::open(path)?;
    decode_description(BufReader::new(file), path)
}

/// As [`read_description`], from a reader; `path` is only used in messages.
///
/// # Errors
/// As for [`read_description`].
pub fn decode_description(mut reader: impl BufRead + Seek, path: &Path) -> Result<Description, OutputError> {
    let unreadable = |reason: io::Error| OutputError::unreadable(path, &reason);
    let start = start_of(&mut reader).map_err(unreadable)?;
    let found = match start.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => png::read_description(reader).map_err(unreadable)?,
        [b'P', b'3' | b'6', ..] => ppm::read_description(reader).map_err(unreadable)?,
        start if start.starts_with(&checkpoint::MAGIC) => checkpoint::read_description(reader, path)?,
        _ => None,
    };
    found.ok_or_else(|| OutputError::NoDescription { path: path.to_owned() })
}

/// The first bytes, which tell the format of a file.
fn start_of(reader: &mut (impl Read + Seek)) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    reader.by_ref().take(8).read_to_end(&mut start)?;
    reader.rewind()?;
    Ok(start)
}

/// Writes all pixels as 8-bit RGB, row by row, because a second copy of a large picture may not fit into memory.
fn write_rows(film: &Film, transfer: Transfer, writer: &mut impl Write) -> io::Result<()> {
    let mut bytes = vec![0; 3 * film.width() as usize];
    for row in 0..film.height() {
        film.resolve_rows(row..row + 1, transfer, &mut bytes);
        writer.write_all(&bytes)?;
    }
    Ok(())
}
