//! Plans that divide the samples of a picture.

use super::division::Division;
use super::error::PlanError;
use super::manifest::{Plan, Work};
use crate::film::SampleRanges;
use crate::render::SAMPLE_LIMIT;
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
        if next > SAMPLE_LIMIT {
            return Err(format!("its parts end at sample {next}, but a film has at most {SAMPLE_LIMIT}"));
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    fn work(samples: [u64; 2], parts: &[[u64; 2]]) -> Samples {
        let part = |samples: &[u64; 2]| Part { file: "part.exr".to_owned(), samples: *samples };
        Samples { samples, block: 1, parts: parts.iter().map(part).collect() }
    }

    #[test]
    fn parts_follow_each_other_from_the_first_sample_to_the_last() {
        for parts in [&[[3, 9]][..], &[[3, 4], [4, 9]], &[[3, 5], [5, 6], [6, 9]]] {
            assert_eq!(work([3, 9], parts).check(), Ok(()), "{parts:?}");
        }
        for (parts, told) in [
            (&[[3_u64, 8]][..], "its parts end at sample 8, but it has 9"),
            (&[], "its parts end at sample 3, but it has 9"),
            (&[[3, 10]], "its parts end at sample 10, but it has 9"),
            (&[[2, 9]], "part 0 has the samples 2..9, but 3 comes next"),
            (&[[4, 9]], "part 0 has the samples 4..9, but 3 comes next"),
            (&[[3, 5], [6, 9]], "part 1 has the samples 6..9, but 5 comes next"),
            (&[[3, 5], [4, 9]], "part 1 has the samples 4..9, but 5 comes next"),
            (&[[3, 5], [5, 5], [5, 9]], "part 1 has the samples 5..5, but 5 comes next"),
            (&[[3, 5], [5, 4], [4, 9]], "part 1 has the samples 5..4, but 5 comes next"),
        ] {
            assert_eq!(work([3, 9], parts).check(), Err(told.to_owned()));
        }
        assert!(work([3, 3], &[]).check().is_err(), "no parts");
    }

    #[test]
    fn parts_end_at_the_largest_sample_of_a_film() {
        let last = |end: u64| work([0, end], &[[0, 7], [7, end]]).check();
        assert_eq!(last(SAMPLE_LIMIT), Ok(()));
        assert!(last(SAMPLE_LIMIT + 1).unwrap_err().ends_with("at most 4294967296"));
    }

    #[test]
    fn a_part_tells_what_a_film_lacks_and_has_too_much() {
        let part = Part { file: "part.exr".to_owned(), samples: [4, 12] };
        for (ranges, missing, is_too_much) in [
            (&[[4_u64, 12]][..], 0, false),
            (&[], 8, false),
            (&[[4, 5]], 7, false),
            (&[[11, 12]], 7, false),
            (&[[5, 7], [9, 10]], 5, false),
            (&[[3, 5]], 7, true),
            (&[[11, 13]], 7, true),
            (&[[5, 6], [12, 13]], 7, true),
            (&[[0, 20]], 0, true),
        ] {
            let mut found = SampleRanges::default();
            ranges.iter().for_each(|[start, end]| found.insert(*start..*end).unwrap());
            assert_eq!(
                (part.missing(&found), part.is_exceeded_by(&found)),
                (missing, is_too_much),
                "{found}"
            );
        }
    }

    #[test]
    fn names_of_parts_are_equally_long() {
        let names = |count: u64| {
            let parts = (0..count).map(|start| start..start + 1).collect();
            let work = Samples::new(&(0..count), &Division { block: 1, parts });
            (work.samples, work.parts[0].file.clone(), work.parts[count as usize - 1].clone())
        };
        let part = |file: &str, samples| Part { file: file.to_owned(), samples };
        assert_eq!(names(1), ([0, 1], "part-0.exr".to_owned(), part("part-0.exr", [0, 1])));
        assert_eq!(names(10), ([0, 10], "part-0.exr".to_owned(), part("part-9.exr", [9, 10])));
        assert_eq!(names(11), ([0, 11], "part-00.exr".to_owned(), part("part-10.exr", [10, 11])));
    }
}
