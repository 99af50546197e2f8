//! Differences of films and of sample sets.

use super::{Film, PixelSum, SampleRanges};
use std::ops::Range;

/// The ranges in `all` without those in `taken`. Both inputs and the result are sorted and disjoint.
pub(super) fn minus(all: &SampleRanges, taken: &SampleRanges) -> Vec<Range<u64>> {
    let mut left = Vec::new();
    let mut taken = taken.iter().peekable();
    for range in all.iter() {
        let mut start = range.start;
        while let Some(other) = taken.peek() {
            if other.start >= range.end {
                break;
            }
            if other.start > start {
                left.push(start..other.start);
            }
            start = start.max(other.end);
            if other.end > range.end {
                break;
            }
            taken.next();
        }
        if start < range.end {
            left.push(start..range.end);
        }
    }
    left
}

pub(super) fn ranges_of(ranges: &[Range<u64>]) -> SampleRanges {
    let mut set = SampleRanges::default();
    for range in ranges {
        // The ranges are disjoint, so nothing overlaps.
        let _ = set.insert(range.clone());
    }
    set
}

/// The part of `film` that is not in `base`. `film` has all samples of `base`; the result is `None` if its sums are
/// not those of `base` plus others.
pub(super) fn difference(film: Film, base: &Film) -> Option<Film> {
    let samples = ranges_of(&minus(film.samples(), base.samples()));
    let rejected = film.rejected().checked_sub(base.rejected())?;
    let (width, height) = (film.width(), film.height());
    let mut halves = film.halves().to_vec();
    for (half, base_half) in halves.iter_mut().zip(base.halves()) {
        for (sum, base_sum) in half.iter_mut().zip(base_half) {
            let mut left = [0; 3];
            for (left, (sum, base)) in left.iter_mut().zip(sum.0.iter().zip(base_sum.0)) {
                *left = sum.checked_sub(base)?;
            }
            *sum = PixelSum(left);
        }
    }
    Film::from_parts(width, height, halves, samples, rejected).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::single_range_in_vec_init, reason = "a list of one range is meant")]
    fn ranges_are_taken_from_ranges() {
        let cases = [
            (vec![0..10], vec![], vec![0..10]),
            (vec![0..10], vec![0..10], vec![]),
            (vec![0..10], vec![3..5], vec![0..3, 5..10]),
            (vec![0..10, 20..30], vec![5..25], vec![0..5, 25..30]),
            (vec![0..10, 20..30, 40..50], vec![8..12, 22..24, 28..45], vec![0..8, 20..22, 24..28, 45..50]),
            (vec![5..6], vec![0..100], vec![]),
        ];
        for (all, taken, left) in cases {
            assert_eq!(minus(&ranges_of(&all), &ranges_of(&taken)), left, "{all:?} - {taken:?}");
        }
    }

    #[test]
    fn what_a_film_has_more_is_its_own() {
        let film = |samples: u64, rejected: u64, red: u64| {
            let mut film = Film::new(2, 1, 1);
            film.halves_mut()[0][1] = PixelSum([red, 0, 0]);
            film.record(0..samples, rejected).unwrap();
            film
        };
        let rest = difference(film(6, 3, 50), &film(4, 1, 20)).unwrap();
        assert_eq!((rest.samples().to_string().as_str(), rest.rejected()), ("4..6", 2));
        assert_eq!(rest.halves()[0][1], PixelSum([30, 0, 0]));
        // What is less than the base was not made from it.
        assert!(difference(film(6, 0, 50), &film(4, 1, 20)).is_none());
        assert!(difference(film(6, 3, 10), &film(4, 1, 20)).is_none());
    }
}
