//! A set of sample indices, as disjoint ranges.

use super::FilmError;
use std::fmt;
use std::ops::Range;

/// The samples that a film holds: sorted, disjoint, not touching.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SampleRanges(Vec<Range<u64>>);

impl SampleRanges {
    /// How many.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|r| r.end - r.start).sum()
    }

    /// How many of them fall to half `half` of `half_count`: those with `index mod half_count == half`.
    pub fn count_in_half(&self, half: usize, half_count: usize) -> u64 {
        let (half, half_count) = (half as u64, half_count as u64);
        let below = |end: u64| end / half_count + u64::from(end % half_count > half);
        self.0.iter().map(|r| below(r.end) - below(r.start)).sum()
    }

    /// The ranges in order.
    pub fn iter(&self) -> impl Iterator<Item = Range<u64>> + '_ {
        self.0.iter().cloned()
    }

    /// One past the largest sample, 0 when empty: where a run goes on.
    pub fn end(&self) -> u64 {
        self.0.last().map_or(0, |r| r.end)
    }

    /// The first samples of `range` that are there, in one piece.
    pub fn overlap(&self, range: &Range<u64>) -> Option<Range<u64>> {
        let common = |r: &Range<u64>| r.start.max(range.start)..r.end.min(range.end);
        self.0.iter().map(common).find(|both| !both.is_empty())
    }

    /// Adds a range; ranges that touch become one.
    ///
    /// # Errors
    /// [`FilmError::Overlap`] if any of it is there; nothing is then added.
    pub fn insert(&mut self, range: Range<u64>) -> Result<(), FilmError> {
        if range.is_empty() {
            return Ok(());
        }
        if let Some(range) = self.overlap(&range) {
            return Err(FilmError::Overlap { range });
        }
        self.0.push(range);
        self.0.sort_by_key(|r| r.start);
        let mut joined: Vec<Range<u64>> = Vec::with_capacity(self.0.len());
        for range in self.0.drain(..) {
            match joined.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        self.0 = joined;
        Ok(())
    }

    /// The first samples of `within` that are missing, at most `limit` of them, in one piece; `None` when all
    /// are there, or the limit is 0.
    pub fn first_gap(&self, within: Range<u64>, limit: u64) -> Option<Range<u64>> {
        let mut start = within.start;
        for range in &self.0 {
            if range.end <= start {
                continue;
            }
            if range.start > start {
                let end = range.start.min(within.end).min(start.saturating_add(limit));
                return (start < end).then_some(start..end);
            }
            start = range.end;
        }
        let end = within.end.min(start.saturating_add(limit));
        (start < end).then_some(start..end)
    }
}

/// As `0..64, 128..256`.
impl fmt::Display for SampleRanges {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, range) in self.0.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
        }
        Ok(())
    }
}
