//! A set of sample indices, as disjoint ranges.

use super::{FilmError, HALVES, SAMPLE_LIMIT};
use std::fmt;
use std::ops::Range;

/// The samples that a film holds: sorted, disjoint, non-adjacent ranges below [`SAMPLE_LIMIT`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleRanges {
    ranges: Vec<Range<u64>>,
    count: u64,
}

impl SampleRanges {
    /// The set of all samples in `ranges`, which may be in any order.
    ///
    /// # Errors
    /// [`FilmError::Range`] if a range is empty or reaches beyond [`SAMPLE_LIMIT`], [`FilmError::Overlap`] if two
    /// ranges have samples in common.
    pub fn from_ranges(ranges: impl IntoIterator<Item = Range<u64>>) -> Result<Self, FilmError> {
        let mut ranges: Vec<Range<u64>> = ranges.into_iter().collect();
        if let Some(range) = ranges.iter().find(|range| range.is_empty() || range.end > SAMPLE_LIMIT) {
            return Err(FilmError::Range { range: range.clone() });
        }
        ranges.sort_unstable_by_key(|range| range.start);
        Self::of_sorted(ranges)
    }

    fn of_sorted(ranges: impl IntoIterator<Item = Range<u64>>) -> Result<Self, FilmError> {
        let mut set = SampleRanges::default();
        for range in ranges {
            if let Some(last) = set.ranges.last()
                && last.end > range.start
            {
                return Err(FilmError::Overlap { range: range.start..range.end.min(last.end) });
            }
            set.push(range);
        }
        Ok(set)
    }

    /// Adds a range that begins at or after the end of the set.
    fn push(&mut self, range: Range<u64>) {
        self.count += range.end - range.start;
        match self.ranges.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => self.ranges.push(range),
        }
    }

    pub fn count(&self) -> u64 {
        self.count
    }

    /// The number of samples in half `half`.
    pub fn count_in_half(&self, half: usize) -> u64 {
        let below = |end: u64| end / HALVES + u64::from(end % HALVES > half as u64);
        self.ranges.iter().map(|r| below(r.end) - below(r.start)).sum()
    }

    /// The ranges in order.
    pub fn iter(&self) -> impl Iterator<Item = Range<u64>> + '_ {
        self.ranges.iter().cloned()
    }

    /// One past the largest sample, 0 for an empty set. A resumed run continues here.
    pub fn end(&self) -> u64 {
        self.ranges.last().map_or(0, |r| r.end)
    }

    /// The number of ranges that end at or before `sample`.
    fn ranges_before(&self, sample: u64) -> usize {
        self.ranges.partition_point(|range| range.end <= sample)
    }

    /// The first contiguous part of `range` that is in the set.
    pub fn overlap(&self, range: &Range<u64>) -> Option<Range<u64>> {
        let first = self.ranges.get(self.ranges_before(range.start))?;
        let both = first.start.max(range.start)..first.end.min(range.end);
        (!both.is_empty()).then_some(both)
    }

    /// # Errors
    /// [`FilmError::Overlap`] if part of `range` is in the set.
    pub fn check_new(&self, range: &Range<u64>) -> Result<(), FilmError> {
        self.overlap(range).map_or(Ok(()), |range| Err(FilmError::Overlap { range }))
    }

    /// The first contiguous range of samples that both sets have.
    pub fn first_common(&self, other: &SampleRanges) -> Option<Range<u64>> {
        let (few, many) = if self.ranges.len() < other.ranges.len() { (self, other) } else { (other, self) };
        few.ranges.iter().find_map(|range| many.overlap(range))
    }

    /// Adds a range; adjacent ranges are joined.
    ///
    /// # Errors
    /// [`FilmError::Overlap`] if part of it is already in the set, [`FilmError::Range`] if it reaches beyond
    /// [`SAMPLE_LIMIT`]. Nothing is added then.
    pub fn insert(&mut self, range: Range<u64>) -> Result<(), FilmError> {
        if range.is_empty() {
            return Ok(());
        }
        let added = SampleRanges::from_ranges([range])?;
        // Most ranges come in order.
        match added.ranges.as_slice() {
            [range] if self.end() <= range.start => self.push(range.clone()),
            _ => *self = self.union(&added)?,
        }
        Ok(())
    }

    /// Whether all samples of `other` are in the set.
    pub fn contains(&self, other: &SampleRanges) -> bool {
        other.iter().all(|range| self.first_gap(range, u64::MAX).is_none())
    }

    /// The samples of both sets.
    ///
    /// # Errors
    /// [`FilmError::Overlap`] if they have some in common.
    pub fn union(&self, other: &SampleRanges) -> Result<SampleRanges, FilmError> {
        let mut ranges: Vec<Range<u64>> = self.iter().chain(other.iter()).collect();
        // The input consists of two sorted runs, which this sort merges in linear time.
        ranges.sort_by_key(|range| range.start);
        Self::of_sorted(ranges)
    }

    /// The first contiguous range of `within` that is missing, at most `limit` samples long. `None` if nothing is
    /// missing or the limit is 0.
    pub fn first_gap(&self, within: Range<u64>, limit: u64) -> Option<Range<u64>> {
        let place = self.ranges_before(within.start);
        let (start, next) = match self.ranges.get(place) {
            Some(range) if range.start <= within.start => (range.end, self.ranges.get(place + 1)),
            next => (within.start, next),
        };
        let end = next.map_or(within.end, |next| next.start.min(within.end));
        let end = end.min(start.saturating_add(limit));
        (start < end).then_some(start..end)
    }
}

/// As `0..64, 128..256`.
impl fmt::Display for SampleRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, range) in self.ranges.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
        }
        Ok(())
    }
}
