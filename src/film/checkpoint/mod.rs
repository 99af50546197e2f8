//! Film files: an OpenEXR picture that any viewer opens, which also contains the exact sums. The same file serves as
//! picture, as checkpoint, and as a part to be merged.
//!
//! The file has one part, scan lines and lossless compression. Channels `R`, `G`, `B` (float) are the mean. Channels
//! `rest.R.lo`, `rest.R.hi` and so on (32-bit unsigned) are the low and high words of what the rounding of the mean
//! loses: mean times samples times 2^24, rounded, plus the rest is the exact sum. The rest is small, so it takes little
//! space. `sum.a.R.lo` and so on are the sums of the first half; those of the second are the difference.
//! Channels `denoised.R`, `.G` and `.B`, if present, are a denoised picture for other programs; they are not read.
//! Three text attributes go with them: `comments` has the description's lines, `weekenderRecipe` the recipe, and
//! `weekenderFilm` the `Head`.
//!
//! No data that is read can change unnoticed: one checksum covers the texts and all numbers of the head, each band of 16
//! rows has one of its sums, and the mean is compared with the sums. A flipped bit can go unnoticed only where it does not
//! affect the film: in standard attributes for other programs (the program's name, the window's position, the pixel
//! aspect ratio), and in white space.

mod head;
mod length;
mod open;
mod planes;
mod read;
mod write;

pub(crate) use length::check_length;
pub(crate) use open::read_description;
pub use open::{FilmHead, read_head};
pub use read::load;
pub(crate) use write::write;
pub use write::{save, save_with};

use super::{Description, Film, FilmError, HALVES, PixelSum, SOFTWARE, SampleRanges};
use crate::system::files::{InputError, ShownPath};
use crate::system::memory::MemoryError;
use std::path::PathBuf;

/// Layout version of film files.
pub const VERSION: u32 = 4;

/// Version of the samples: of the random numbers and how they are used. Samples of different versions must not be
/// mixed, so films of other versions are neither resumed nor merged.
pub const SAMPLE_VERSION: u32 = 6;

/// The first bytes of an OpenEXR file.
pub(crate) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The layer of a film file that has the denoised picture.
pub const DENOISED_LAYER: &str = "denoised";

const FILM_ATTRIBUTE: &str = "weekenderFilm";
const RECIPE_ATTRIBUTE: &str = "weekenderRecipe";

#[derive(Clone, Debug, PartialEq)]
pub struct FilmFile {
    pub film: Film,
    /// The recipe of the film's job, and other entries.
    pub description: Description,
}

/// Why a file cannot be loaded as a film.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
pub enum CheckpointError {
    #[error(transparent)]
    Input(#[from] InputError),
    #[error("{} is not an EXR file; films are the .exr files that Weekender saves", path.shown())]
    NotExr { path: PathBuf },
    #[error(
        "{} is a picture without a film's sums, so no samples can be added to it; only .exr files written by Weekender have them",
        path.shown()
    )]
    NotFilm { path: PathBuf },
    #[error(
        "{} is no longer a Weekender film: another program re-saved it and lost its sums ({what}); add samples to the \
         original film, or compare this one as a picture",
        path.shown()
    )]
    Resaved { path: PathBuf, what: String },
    #[error(
        "{} is a film of layout {layout} with samples of version {samples}, written by {writer}, but this program \
         ({SOFTWARE}) has layout {VERSION} and samples of version {SAMPLE_VERSION}; continue with {writer}, or render it again",
        path.shown()
    )]
    Version { path: PathBuf, layout: i64, samples: i64, writer: String },
    #[error(
        "{} has {halves} of the {HALVES} halves of a film, as earlier versions wrote with --estimate-error off, so its error is \
         unknown; render it again",
        path.shown()
    )]
    Halves { path: PathBuf, halves: u32 },
    /// Something in the file is missing or was changed.
    #[error("{} is damaged: {what}; use an earlier copy or render it again", path.shown())]
    Damaged { path: PathBuf, what: String },
    /// Another program wrote to the file meanwhile, for example by copying over it.
    #[error("{} has changed while it was read; read it again when it is complete", path.shown())]
    Changed { path: PathBuf },
    #[error("cannot read {}: {reason}", path.shown())]
    Memory { path: PathBuf, reason: MemoryError },
}

/// Threads that read or write a film file. More than eight gain little: they wait for memory and disk.
fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from).min(8)
}

#[cfg(test)]
mod tests {
    use super::head::{Head, Texts};
    use super::write::write_with;
    use super::*;
    use crate::film::SIZE_LIMIT;
    use std::io::Cursor;

    const TEXTS: Texts = [b"[render]\n", b"Scene: none\n"];

    fn film() -> Film {
        let mut film = Film::new(4, 3);
        for (index, sum) in film.halves_mut().iter_mut().flatten().enumerate() {
            sum.0 = [index as u64 * 0x1000_0001; 3];
        }
        film.record(0..10, 1).unwrap();
        film
    }

    /// A film file that is valid, except for what `change` does to its head.
    fn file(change: impl FnOnce(&mut Head)) -> Vec<u8> {
        let film = film();
        let mut head = Head::of(&film, TEXTS);
        change(&mut head);
        head.head_checksum = head.checksum(TEXTS);
        let mut file = Cursor::new(Vec::new());
        write_with(&film, None, TEXTS, &head, &mut file).unwrap();
        file.into_inner()
    }

    fn opened(bytes: &[u8]) -> Result<FilmFile, CheckpointError> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("x.exr");
        std::fs::write(&path, bytes).unwrap();
        load(&path)
    }

    #[test]
    fn an_invalid_head_is_refused_even_with_a_correct_checksum() {
        assert_eq!(opened(&file(|_| {})).unwrap().film, film());
        let refused = |change: fn(&mut Head), part: &str| {
            let message = opened(&file(change)).unwrap_err().to_string();
            assert!(message.contains("x.exr is damaged") && message.contains(part), "{part}: {message}");
        };
        let resaved = |change: fn(&mut Head), part: &str| {
            let message = opened(&file(change)).unwrap_err().to_string();
            assert!(
                message.contains("no longer a Weekender film") && message.contains(part),
                "{part}: {message}"
            );
        };
        refused(|head| head.samples = vec![[0, 1 << 62]], "0..4611686018427387904");
        refused(|head| head.samples = vec![[0, 5], [1 << 32, (1 << 32) + 5]], "4294967296");
        refused(|head| head.samples = vec![[7, 7]], "7..7");
        refused(|head| head.samples = vec![[9, 3]], "9..3");
        refused(|head| head.samples = vec![[0, 6], [4, 10]], "samples 4..6 are already");
        refused(|head| head.samples = vec![[0, 20]], "the rows 0 to 2: the ");
        refused(|head| head.bands = Vec::new(), "0 checksums of bands");
        refused(|head| head.rejected = 1 << 62, "4611686018427387904 samples rejected");
        refused(|head| head.rejected = 121, "121 samples rejected");
        for halves in [1, 3] {
            let error = opened(&file(|head| head.halves = halves)).unwrap_err();
            assert!(matches!(error, CheckpointError::Halves { halves: found, .. } if found == halves));
        }
        resaved(|head| head.width = 5, "4x3 pixels, but its head says 5x3");
    }

    #[test]
    fn ranges_may_be_in_any_order_and_adjacent() {
        let bytes = file(|head| head.samples = vec![[5, 10], [0, 3], [3, 5]]);
        assert_eq!(opened(&bytes).unwrap().film, film());
    }

    /// Overwrites bytes at `offset` after an attribute's name, type and length.
    fn with_attribute(mut bytes: Vec<u8>, name: &[u8], offset: usize, value: i32) -> Vec<u8> {
        let place = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len() + 4;
        bytes[place + offset..place + offset + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    }

    #[test]
    fn short_file_is_refused_before_allocation() {
        let claim = |side: u32| {
            let bytes = file(|head| {
                (head.width, head.height) = (side, side);
                head.bands = vec![String::new(); side.div_ceil(16) as usize];
            });
            let bytes = with_attribute(bytes, b"chunkCount\0int\0", 0, side as i32);
            let last = side as i32 - 1;
            let bytes = with_attribute(bytes, b"dataWindow\0box2i\0", 8, last);
            opened(&with_attribute(bytes, b"dataWindow\0box2i\0", 12, last)).unwrap_err().to_string()
        };
        let message = claim(SIZE_LIMIT);
        assert!(message.contains("16384x16384") && message.contains("60 bytes"), "{message}");
        let message = claim(20_000);
        assert!(message.contains("20000x20000") && message.contains("16384"), "{message}");
    }
}
