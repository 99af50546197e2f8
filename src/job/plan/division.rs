//! Divides samples into parts.

use std::ops::Range;

/// How much longer than its share the longest part may be.
const TOLERANCE: f64 = 0.05;

/// Divides `samples` into `parts` parts of about equal length, in order. They begin and end at multiples of a power of
/// two, the *block*, except where the samples themselves do not. Such a block of Sobol points is as even as the same
/// number of points from the start, so a part, and any sum of parts, is as good as the same samples of one machine.
///
/// The block is the largest for which no part is more than a twentieth longer than its share. `None` if there are fewer
/// samples than parts, or no parts.
pub(super) fn divide(samples: Range<u64>, parts: u64) -> Option<(u64, Vec<Range<u64>>)> {
    let count = samples.end.checked_sub(samples.start)?;
    if parts == 0 || count < parts {
        return None;
    }
    let share = count.div_ceil(parts);
    let longest_allowed = (share as f64 * (1.0 + TOLERANCE)) as u64;
    (0..=share.ilog2()).rev().map(|bits| 1 << bits).find_map(|block| {
        let (first, end) = (samples.start / block, samples.end.div_ceil(block));
        let blocks = end - first;
        if blocks < parts {
            return None;
        }
        let border = |part: u64| {
            let blocks = u128::from(blocks) * u128::from(part) / u128::from(parts);
            ((first + blocks as u64) * block).clamp(samples.start, samples.end)
        };
        let parts: Vec<Range<u64>> = (0..parts).map(|part| border(part)..border(part + 1)).collect();
        let fits = parts.iter().all(|part| !part.is_empty() && part.end - part.start <= longest_allowed);
        fits.then_some((block, parts))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_power_of_two_is_divided_into_powers_of_two() {
        let (block, parts) = divide(0..4096, 32).unwrap();
        assert_eq!((block, parts.len()), (128, 32));
        assert_eq!((parts[0].clone(), parts[31].clone()), (0..128, 3968..4096));
    }

    #[test]
    fn uneven_division_uses_smaller_blocks() {
        let (block, parts) = divide(0..1000, 3).unwrap();
        assert_eq!((block, parts), (16, vec![0..336, 336..672, 672..1000]));
        let (block, parts) = divide(0..5, 4).unwrap();
        assert_eq!((block, parts), (1, vec![0..1, 1..2, 2..3, 3..5]));
        // Samples that continue an existing picture.
        let (block, parts) = divide(96..4192, 4).unwrap();
        assert_eq!((block, parts[1].clone()), (64, 1088..2112));
        assert_eq!((divide(0..3, 4), divide(0..3, 0)), (None, None));
    }

    proptest! {
        #[test]
        fn parts_are_aligned_even_and_complete(start in 0_u64..9000, count in 1_u64..1 << 31, parts in 1_u64..1200) {
            let samples = start..start + count;
            let Some((block, found)) = divide(samples.clone(), parts) else {
                prop_assert!(count < parts);
                return Ok(());
            };
            prop_assert_eq!(found.len() as u64, parts);
            prop_assert!(block.is_power_of_two());
            prop_assert_eq!((found[0].start, found[found.len() - 1].end), (samples.start, samples.end));
            for pair in found.windows(2) {
                prop_assert_eq!(pair[0].end, pair[1].start);
                prop_assert_eq!(pair[0].end % block, 0);
            }
            let longest = found.iter().map(|part| part.end - part.start).max().unwrap();
            prop_assert!(longest as f64 <= count.div_ceil(parts) as f64 * 1.05);
        }
    }
}
