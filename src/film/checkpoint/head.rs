//! The head of a film file, which describes its sums, and the checksums.

use super::{Film, PixelSum, SAMPLE_VERSION, VERSION};
use crate::film::{Checksum, FilmError, HALVES, SampleRanges};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Rows of a band. Each band has its own checksum, so that damage can be located.
pub(super) const BAND_ROWS: u32 = 16;

/// The description of a film's sums, as stored in its file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    pub version: u32,
    /// See [`SAMPLE_VERSION`].
    pub sample_version: u32,
    pub width: u32,
    pub height: u32,
    pub halves: u32,
    pub samples: Vec<[u64; 2]>,
    pub rejected: u64,
    /// Checksum of the other fields and of the texts.
    pub head_checksum: String,
    /// The checksum of the sums of each band, from the top.
    pub bands: Vec<String>,
}

/// The versions in a head. Other versions may have other fields.
#[derive(Deserialize)]
pub(super) struct Versions {
    pub version: i64,
    pub sample_version: Option<i64>,
}

/// The texts that a file holds beside its head and pixels: the recipe, and the comments.
pub(super) type Texts<'a> = [&'a [u8]; 2];

pub(super) fn band_count(height: u32) -> u32 {
    height.div_ceil(BAND_ROWS)
}

pub(super) fn band_rows(band: u32, height: u32) -> Range<u32> {
    band * BAND_ROWS..((band + 1) * BAND_ROWS).min(height)
}

/// The checksum of a band's sums, given by halves.
pub(super) fn band_checksum<'a>(band: u32, halves: impl Iterator<Item = &'a [PixelSum]>) -> String {
    let mut sum = Checksum::default();
    sum.word(band.into());
    halves.flatten().for_each(|pixel| sum.words(&pixel.0));
    sum.finish()
}

impl Head {
    pub fn of(film: &Film, texts: Texts) -> Self {
        let band = |band: u32| {
            let rows = band_rows(band, film.height());
            let pixels = (rows.start * film.width()) as usize..(rows.end * film.width()) as usize;
            band_checksum(band, film.halves().iter().map(|half| &half[pixels.clone()]))
        };
        let mut head = Head {
            version: VERSION,
            sample_version: SAMPLE_VERSION,
            width: film.width(),
            height: film.height(),
            halves: HALVES as u32,
            samples: film.samples().iter().map(|range| [range.start, range.end]).collect(),
            rejected: film.rejected(),
            head_checksum: String::new(),
            bands: (0..band_count(film.height())).map(band).collect(),
        };
        head.head_checksum = head.checksum(texts);
        head
    }

    pub fn ranges(&self) -> Result<SampleRanges, FilmError> {
        SampleRanges::from_ranges(self.samples.iter().map(|[start, end]| *start..*end))
    }

    /// The checksum of all other fields and the texts.
    pub fn checksum(&self, texts: Texts) -> String {
        let mut sum = Checksum::default();
        sum.words(&[self.version.into(), self.width.into(), self.height.into(), self.halves.into()]);
        sum.words(&[self.rejected, self.samples.len() as u64]);
        self.samples.iter().for_each(|range| sum.words(range));
        texts.iter().for_each(|text| sum.text(text));
        sum.word(self.sample_version.into());
        self.bands.iter().for_each(|band| sum.text(band.as_bytes()));
        sum.finish()
    }
}
