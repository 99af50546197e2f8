//! The head of a film file, which describes its sums, and the checksums.

use super::threads::threads;
use super::{
    Checksum, Description, Film, FilmError, OLDEST_VERSION, PixelSum, SAMPLE_VERSION, SampleRanges, VERSION,
};
use crate::threads::shared;
use serde::{Deserialize, Serialize};
use std::io;
use std::ops::Range;

/// Rows of a band. Each band has a checksum of its own, so that damage can be located, and what is whole can be added
/// before the rest is read.
const BAND_ROWS: u32 = 16;

/// The last version that had one checksum for all sums.
const WITHOUT_BANDS: u32 = 3;

/// The description of a film's sums, as stored in its file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    pub version: u32,
    /// See [`SAMPLE_VERSION`].
    #[serde(default = "samples_without_version")]
    pub sample_version: u32,
    pub width: u32,
    pub height: u32,
    pub halves: usize,
    pub samples: Vec<[u64; 2]>,
    pub rejected: u64,
    /// Checksum of the other fields and of the texts.
    pub head_checksum: String,
    /// In version 3: checksum of the same data and of all sums.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksum: Option<String>,
    /// The checksum of the sums of each band, from the top.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<String>,
}

fn samples_without_version() -> u32 {
    3
}

/// The texts that a file holds beside its head and pixels.
#[derive(Clone, Copy)]
pub(super) struct Texts<'a> {
    pub recipe: &'a [u8],
    pub comments: &'a [u8],
}

/// The number of bands of a picture of this height.
pub(super) fn band_count(height: u32) -> u32 {
    height.div_ceil(BAND_ROWS)
}

/// The rows of a band.
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

/// The checksums of all bands, made by several threads.
///
/// # Errors
/// If one of the threads has failed.
fn band_checksums(film: &Film) -> io::Result<Vec<String>> {
    let width = film.width() as usize;
    let checksum = |band: u32| {
        let rows = band_rows(band, film.height());
        let pixels = rows.start as usize * width..rows.end as usize * width;
        band_checksum(band, film.halves().iter().map(|half| &half[pixels.clone()]))
    };
    let bands: Vec<u32> = (0..band_count(film.height())).collect();
    let sum = |share: &[u32]| share.iter().map(|band| checksum(*band)).collect::<Vec<_>>();
    let shares: Vec<&[u32]> = bands.chunks(bands.len().div_ceil(threads()).max(1)).collect();
    let mut checksums = Vec::with_capacity(bands.len());
    for sums in shared(shares, sum) {
        checksums.extend(sums.map_err(|_| io::Error::other("a thread that makes checksums has failed"))?);
    }
    Ok(checksums)
}

impl Head {
    /// Makes the head of a film with these texts.
    ///
    /// # Errors
    /// If a thread that makes checksums has failed.
    pub fn of(film: &Film, texts: Texts) -> io::Result<Self> {
        let mut head = Head {
            version: VERSION,
            sample_version: SAMPLE_VERSION,
            width: film.width(),
            height: film.height(),
            halves: film.halves().len(),
            samples: film.samples().iter().map(|range| [range.start, range.end]).collect(),
            rejected: film.rejected(),
            head_checksum: String::new(),
            checksum: None,
            bands: band_checksums(film)?,
        };
        head.seal(texts);
        Ok(head)
    }

    /// Sets the checksum of the head.
    pub fn seal(&mut self, texts: Texts) {
        self.head_checksum = self.sum(texts).finish();
    }

    /// Parses a head.
    ///
    /// # Errors
    /// The file's version, if this program does not read it; otherwise a message that says what is wrong.
    pub fn read(text: &str) -> Result<Self, HeadError> {
        let damaged = |what: &str| HeadError::Damaged(what.to_owned());
        // Check the versions first: other versions may have other fields.
        let table: toml::Table = text.parse().map_err(|_| damaged("its head cannot be read"))?;
        let number = |key| table.get(key).and_then(toml::Value::as_integer);
        let version = number("version").ok_or_else(|| damaged("its head has no version"))?;
        // Until version 3, both had one number.
        let samples = number("sample_version").unwrap_or(version.min(WITHOUT_BANDS.into()));
        if samples != i64::from(SAMPLE_VERSION) {
            return Err(HeadError::SampleVersion(samples));
        }
        if !(i64::from(OLDEST_VERSION)..=i64::from(VERSION)).contains(&version) {
            return Err(HeadError::Version(version));
        }
        let head: Head = table.try_into().map_err(|error: toml::de::Error| {
            HeadError::Damaged(format!("its head cannot be read: {}", error.message()))
        })?;
        if !(1..=2).contains(&head.halves) {
            return Err(HeadError::Damaged(format!("it has {} halves, but a film has 1 or 2", head.halves)));
        }
        let (checksums, bands) = (head.bands.len(), band_count(head.height) as usize);
        if head.has_bands() && checksums != bands {
            return Err(HeadError::Damaged(format!(
                "it has {checksums} checksums for {bands} bands of rows"
            )));
        }
        Ok(head)
    }

    /// Whether each band has a checksum; otherwise only the whole film has one.
    pub fn has_bands(&self) -> bool {
        self.version > WITHOUT_BANDS
    }

    /// Whether head and texts match their checksum.
    pub fn is_whole(&self, texts: Texts) -> bool {
        self.sum(texts).finish() == self.head_checksum
    }

    /// In version 3: whether all sums match their checksum.
    pub fn has_sums(&self, texts: Texts, halves: &[Vec<PixelSum>]) -> bool {
        let mut sum = self.sum(texts);
        halves.iter().flatten().for_each(|pixel| sum.words(&pixel.0));
        Some(sum.finish()) == self.checksum
    }

    /// What tells this film from others: it depends on all texts, numbers and sums.
    pub fn mark(&self) -> String {
        format!("{} {}", self.head_checksum, self.checksum.as_deref().unwrap_or_default())
    }

    /// The sample ranges that the film holds.
    pub fn ranges(&self) -> Result<SampleRanges, FilmError> {
        SampleRanges::from_ranges(self.samples.iter().map(|[start, end]| *start..*end))
    }

    fn sum(&self, texts: Texts) -> Checksum {
        let mut sum = Checksum::default();
        sum.words(&[self.version.into(), self.width.into(), self.height.into(), self.halves as u64]);
        sum.words(&[self.rejected, self.samples.len() as u64]);
        self.samples.iter().for_each(|range| sum.words(range));
        sum.text(texts.recipe);
        sum.text(texts.comments);
        if self.has_bands() {
            sum.word(self.sample_version.into());
            self.bands.iter().for_each(|band| sum.text(band.as_bytes()));
        }
        sum
    }
}

/// The lines of a description as they are stored in a file.
pub(super) fn comments(description: &Description) -> String {
    description.lines().map(|line| line + "\n").collect()
}

/// Why a head cannot be used.
pub(super) enum HeadError {
    /// The layout of the file is of this version.
    Version(i64),
    /// The samples are of this version.
    SampleVersion(i64),
    Damaged(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Until version 3, the samples had the version of the layout.
    #[test]
    fn the_versions_of_a_head_are_checked_before_its_other_fields() {
        let told = |text: &str| match Head::read(text) {
            Ok(_) => "a head".to_owned(),
            Err(HeadError::Version(version)) => format!("layout {version}"),
            Err(HeadError::SampleVersion(version)) => format!("samples {version}"),
            Err(HeadError::Damaged(what)) => what,
        };
        for (text, expected) in [
            ("version = 2", "samples 2"),
            ("version = 9", "layout 9"),
            ("version = 2\nsample_version = 3", "layout 2"),
            ("version = 5\nsample_version = 3", "layout 5"),
            ("version = 4\nsample_version = 2", "samples 2"),
            ("version = 4\nsample_version = 4", "samples 4"),
            ("version = 5\nsample_version = 4\nnew = 1", "samples 4"),
            ("", "its head has no version"),
            ("version = \"4\"", "its head has no version"),
            ("version", "its head cannot be read"),
        ] {
            assert_eq!(told(text), expected, "{text}");
        }
        for version in ["version = 3", "version = 4\nsample_version = 3"] {
            let told = told(version);
            assert!(told.starts_with("its head cannot be read: missing field"), "{told}");
        }
    }
}
