//! Plans that divide the samples of a picture.

use super::division::Division;
use super::error::PlanError;
use super::manifest::{Plan, Work};
use crate::film::SampleRanges;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::PathBuf;

/// Samples of a picture, in parts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Samples {
    /// First sample, and one past the last.
    pub samples: [u64; 2],
    /// Parts begin and end at multiples of this power of two.
    pub block: u64,
    /// The parts.
    pub parts: Vec<Part>,
}

/// A part of a plan: a film.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// The film file, beside the manifest.
    pub file: String,
    /// First sample, and one past the last.
    pub samples: [u64; 2],
}

impl Part {
    /// What `found` lacks of the part: the number of samples per pixel.
    pub fn missing(&self, found: &SampleRanges) -> u64 {
        let (mut missing, mut from) = (0, self.samples[0]);
        while let Some(gap) = found.first_gap(from..self.samples[1], u64::MAX) {
            missing += gap.end - gap.start;
            from = gap.end;
        }
        missing
    }

    /// Whether `found` has samples that do not belong to the part.
    pub fn is_exceeded_by(&self, found: &SampleRanges) -> bool {
        found.iter().any(|range| range.start < self.samples[0] || range.end > self.samples[1])
    }
}

impl Samples {
    /// The parts of a division of `samples`, with the names of their files.
    pub fn new(samples: &Range<u64>, division: &Division) -> Self {
        let digits = division.parts.len().saturating_sub(1).to_string().len();
        let part = |(index, range): (usize, &Range<u64>)| Part {
            file: format!("part-{index:0digits$}.exr"),
            samples: [range.start, range.end],
        };
        let parts = division.parts.iter().enumerate().map(part).collect();
        Samples { samples: [samples.start, samples.end], block: division.block, parts }
    }
}

impl Work for Samples {
    const VERSION: u32 = 1;
    const RESULT: &str = "picture.exr";

    fn count(&self) -> usize {
        self.parts.len()
    }

    fn files(&self) -> Vec<&str> {
        self.parts.iter().map(|part| part.file.as_str()).collect()
    }

    fn check(&self) -> Result<(), String> {
        let mut next = self.samples[0];
        for (index, part) in self.parts.iter().enumerate() {
            if part.samples[0] != next || part.samples[1] <= next {
                let [start, end] = part.samples;
                return Err(format!("part {index} has the samples {start}..{end}, but {next} comes next"));
            }
            next = part.samples[1];
        }
        if next != self.samples[1] || self.parts.is_empty() {
            return Err(format!("its parts end at sample {next}, but it has {}", self.samples[1]));
        }
        let all = self.samples[0]..self.samples[1];
        SampleRanges::default().insert(all).map_err(|error| error.to_string())
    }
}

impl Plan<Samples> {
    /// The film file of a part.
    pub fn part_path(&self, part: &Part) -> PathBuf {
        self.beside(&part.file)
    }

    /// A part by its number, from 0.
    ///
    /// # Errors
    /// [`PlanError::NoPart`].
    pub fn part(&self, number: u64) -> Result<&Part, PlanError> {
        self.index(number).map(|index| &self.manifest.work.parts[index])
    }
}
