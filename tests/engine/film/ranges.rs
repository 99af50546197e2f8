//! The set of samples that a film holds.

use super::common::description;
use proptest::prelude::*;
use std::collections::HashSet;
use weekender::film::{Film, FilmError, SAMPLE_LIMIT, SampleRanges, checkpoint};

proptest! {
    #[test]
    fn ranges_are_a_set(
        ranges in prop::collection::vec((0_u64..60, 0_u64..12), 0..12),
        within in (0_u64..70, 0_u64..70),
        limit in 0_u64..20,
    ) {
        let mut set = HashSet::new();
        let mut samples = SampleRanges::default();
        for (start, length) in ranges {
            let range = start..start + length;
            let common: Vec<u64> = range.clone().filter(|i| set.contains(i)).collect();
            match samples.overlap(&range) {
                None => prop_assert!(common.is_empty()),
                Some(both) => {
                    // It is a contiguous range that starts at the first common sample and is as long as possible.
                    prop_assert!(both.clone().all(|i| set.contains(&i) && range.contains(&i)));
                    prop_assert_eq!(Some(&both.start), common.first());
                    prop_assert!(!(set.contains(&both.end) && range.contains(&both.end)));
                }
            }
            let before = samples.clone();
            if common.is_empty() {
                prop_assert_eq!(samples.insert(range.clone()), Ok(()));
                set.extend(range);
            } else {
                prop_assert!(samples.insert(range).is_err());
                prop_assert_eq!(&samples, &before);
            }
        }
        prop_assert_eq!(&SampleRanges::from_ranges(samples.iter().collect::<Vec<_>>().into_iter().rev()).unwrap(), &samples);
        let (mut first, mut second) = (SampleRanges::default(), SampleRanges::default());
        for (index, range) in samples.iter().enumerate() {
            if index % 2 == 0 { &mut first } else { &mut second }.insert(range).unwrap();
        }
        prop_assert_eq!(first.first_common(&second), None);
        prop_assert_eq!(&first.union(&second).unwrap(), &samples);
        if first.count() > 0 {
            prop_assert!(samples.first_common(&first).is_some() && samples.union(&first).is_err());
        }
        let held: HashSet<u64> = samples.iter().flatten().collect();
        prop_assert_eq!(&held, &set);
        let pieces: Vec<_> = samples.iter().collect();
        prop_assert!(pieces.windows(2).all(|pair| pair[0].end < pair[1].start));
        prop_assert_eq!(samples.count(), set.len() as u64);
        prop_assert_eq!(samples.end(), set.iter().max().map_or(0, |i| i + 1));
        for half in [0, 1] {
            let expected = set.iter().filter(|i| **i as usize % 2 == half).count();
            prop_assert_eq!(samples.count_in_half(half), expected as u64);
        }
        let within = within.0..within.1;
        let start = within.clone().find(|i| !set.contains(i));
        let gap = start.filter(|_| limit > 0).map(|start| {
            let end = (start..within.end).take(limit as usize).find(|i| set.contains(i));
            start..end.unwrap_or(within.end.min(start + limit))
        });
        prop_assert_eq!(samples.first_gap(within, limit), gap);
    }
}

#[test]
fn sample_indices_end_at_the_limit() {
    let mut samples = SampleRanges::default();
    samples.insert(1..SAMPLE_LIMIT).unwrap();
    assert_eq!(samples.count_in_half(0) + samples.count_in_half(1), samples.count());
    assert_eq!(samples.to_string(), format!("1..{SAMPLE_LIMIT}"));
    for end in [SAMPLE_LIMIT + 1, 1 << 63, u64::MAX] {
        let range = SAMPLE_LIMIT..end;
        let refused = Err(FilmError::Range { range: range.clone() });
        assert_eq!(samples.insert(range.clone()), refused);
        assert_eq!(SampleRanges::from_ranges([range.clone()]).map(|_| ()), refused);
        let mut film = Film::new(1, 1);
        assert_eq!(film.record(range, 0), refused);
        assert_eq!(film, Film::new(1, 1));
    }
}

#[test]
fn a_film_may_have_very_many_ranges() {
    // Anything quadratic in the number of ranges would take most of a minute here.
    let even = || (0..200_000).map(|k| 2 * k..2 * k + 1);
    let mut film = Film::new(1, 1);
    even().for_each(|range| film.record(range, 0).unwrap());
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("even.exr");
    checkpoint::save(&path, &film, &description()).unwrap();
    let read = checkpoint::load(&path).unwrap().film;
    assert_eq!(read.samples(), &SampleRanges::from_ranges(even().rev()).unwrap());
    assert_eq!(read.samples().first_gap(399_990..400_000, 10), Some(399_991..399_992));
}
