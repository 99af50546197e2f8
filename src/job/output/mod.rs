//! Picture files: 8-bit PNG, and OpenEXR with the whole film, both with a [`Description`]; PPM and PFM without one.
//! Pictures of other programs can be read, too: [`read_picture`].

mod decoded;
mod exr;
mod netpbm;
mod png;
mod ppm;
mod read;

pub use decoded::{Damage, Encoding, Incomplete, Linear, ReadPicture, Values, displayed};
pub use read::{decode_picture, read_picture};

pub use crate::film::{Description, RECIPE_KEY, key};

use crate::film::{Film, checkpoint};
use crate::stages::Transfer;
use crate::system::files::{self, ShownPath, replace_file};
use anyhow::{Context, Result, anyhow};
use clap::ValueEnum;
use std::io::{self, BufReader, Read, Seek, Write};
use std::path::Path;

/// Longest recipe that is read from a PNG file, bytes: about two million listed spheres.
const RECIPE_LIMIT: usize = 256 << 20;

/// File format of a picture, named after its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
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
    /// If it has none of the known extensions.
    pub fn from_path(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        OutputFormat::from_str(&ending, true).map_err(|_| {
            anyhow!(
                "cannot tell the picture format of {}; let the name end in one of {}",
                path.shown(),
                OutputFormat::ALL.map(OutputFormat::ending).join(", ")
            )
        })
    }
}

/// Writes a picture to `path`, replacing an existing file, in the format of its extension. `transfer` only matters
/// for 8-bit formats; the others are linear, and an EXR file holds the film.
///
/// # Errors
/// If the file cannot be written; an existing one is then unchanged.
pub fn write_image(path: &Path, film: &Film, transfer: Transfer, description: &Description) -> Result<()> {
    write_image_as(path, OutputFormat::from_path(path)?, (film, None), transfer, description)
}

/// As [`write_image`], in this format. An EXR file of a `denoised` film keeps the film, and has it as a layer.
///
/// # Errors
/// As for [`write_image`].
pub fn write_image_as(
    path: &Path,
    format: OutputFormat,
    (film, denoised): (&Film, Option<&Film>),
    transfer: Transfer,
    description: &Description,
) -> Result<()> {
    let picture = denoised.unwrap_or(film);
    replace_file(path, |writer| match format {
        OutputFormat::Png => png::write(picture, transfer, description, false, writer),
        OutputFormat::P6 => ppm::write(picture, transfer, writer),
        OutputFormat::Exr => checkpoint::write(film, denoised, description, writer),
        OutputFormat::Pfm => netpbm::write_pfm(picture, writer),
    })?;
    Ok(())
}

/// Writes a PNG for a page that should load quickly: smaller than that of [`write_image`], and slower to write.
///
/// # Errors
/// As for [`write_image`].
pub fn write_small_png(
    path: &Path,
    film: &Film,
    transfer: Transfer,
    description: &Description,
) -> Result<()> {
    Ok(replace_file(path, |writer| png::write(film, transfer, description, true, writer))?)
}

/// Reads the description of a picture. The first bytes of the file tell its format; the name does not matter.
///
/// # Errors
/// If the file cannot be read, is damaged, or does not say how it was made.
pub fn read_description(path: &Path) -> Result<Description> {
    let mut reader = BufReader::new(files::open(path)?.0);
    let unreadable =
        |reason| anyhow!("cannot read {}: {reason}; check whether the file is complete", path.shown());
    let start = start_of(&mut reader)?;
    let found = match start.as_slice() {
        [] => return Err(anyhow!("{} is empty; render it again", path.shown())),
        [0x89, b'P', b'N', b'G', ..] => png::read_description(reader).map_err(unreadable)?,
        start if start.starts_with(&checkpoint::MAGIC) => checkpoint::read_description(reader, path)?,
        _ => None,
    };
    found.with_context(|| {
        format!(
            "{} does not say how it was made; only PNG and EXR files written by Weekender do, unless another program \
             re-saved them",
            path.shown()
        )
    })
}

/// Whether a file's name is that of a picture that many programs write.
pub fn is_named_picture(path: &Path) -> bool {
    let is = |known: &&str| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(known));
    ["png", "ppm"].iter().any(is)
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
