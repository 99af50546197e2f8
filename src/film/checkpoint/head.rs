//! The head of a film file, which describes its sums, and the checksums.

use super::{Checksum, Description, Film, FilmError, PixelSum, SampleRanges, VERSION};
use serde::{Deserialize, Serialize};

/// The description of a film's sums, as stored in its file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    pub version: u32,
    pub width: u32,
    pub height: u32,
    pub halves: usize,
    pub samples: Vec<[u64; 2]>,
    pub rejected: u64,
    /// Checksum of the fields above and of the texts.
    pub head_checksum: String,
    /// Checksum of the same data and of all sums.
    pub checksum: String,
}

/// The texts that a file holds beside its head and pixels.
#[derive(Clone, Copy)]
pub(super) struct Texts<'a> {
    pub recipe: &'a [u8],
    pub comments: &'a [u8],
}

impl Head {
    /// Makes the head of a film with these texts.
    pub fn of(film: &Film, texts: Texts) -> Self {
        let mut head = Head {
            version: VERSION,
            width: film.width(),
            height: film.height(),
            halves: film.halves().len(),
            samples: film.samples().iter().map(|range| [range.start, range.end]).collect(),
            rejected: film.rejected(),
            head_checksum: String::new(),
            checksum: String::new(),
        };
        head.seal(texts, film.halves());
        head
    }

    /// Sets the checksums.
    pub fn seal(&mut self, texts: Texts, halves: &[Vec<PixelSum>]) {
        let sum = self.sum(texts);
        self.head_checksum = sum.finish();
        self.checksum = with_sums(sum, halves);
    }

    /// Parses a head.
    ///
    /// # Errors
    /// The file's version, if it is a different one; otherwise a message that says what is wrong.
    pub fn read(text: &str) -> Result<Self, HeadError> {
        let damaged = |what: &str| HeadError::Damaged(what.to_owned());
        // Check the version first: other versions may have other fields.
        let table: toml::Table = text.parse().map_err(|_| damaged("its head cannot be read"))?;
        let version = table.get("version").and_then(toml::Value::as_integer);
        match version.ok_or_else(|| damaged("its head has no version"))? {
            version if version == i64::from(VERSION) => {}
            version => return Err(HeadError::Version(version)),
        }
        let head: Head = table.try_into().map_err(|error: toml::de::Error| {
            HeadError::Damaged(format!("its head cannot be read: {}", error.message()))
        })?;
        if !(1..=2).contains(&head.halves) {
            return Err(HeadError::Damaged(format!("it has {} halves, but a film has 1 or 2", head.halves)));
        }
        Ok(head)
    }

    /// Whether head and texts match their checksum.
    pub fn is_whole(&self, texts: Texts) -> bool {
        self.sum(texts).finish() == self.head_checksum
    }

    /// Whether the sums match their checksum.
    pub fn has_sums(&self, texts: Texts, halves: &[Vec<PixelSum>]) -> bool {
        with_sums(self.sum(texts), halves) == self.checksum
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
        sum
    }
}

fn with_sums(mut sum: Checksum, halves: &[Vec<PixelSum>]) -> String {
    halves.iter().flatten().for_each(|pixel| sum.words(&pixel.0));
    sum.finish()
}

/// The lines of a description as they are stored in a file.
pub(super) fn comments(description: &Description) -> String {
    description.lines().map(|line| line + "\n").collect()
}

/// Why a head cannot be used.
pub(super) enum HeadError {
    Version(i64),
    Damaged(String),
}
