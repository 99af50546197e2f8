//! Pictures that are equal nearly everywhere, so that their noise is known to be zero there.

use crate::statistics::blocks::{Block, BlockTest, CHANCE};
use crate::statistics::normal::largest_of;

/// The share of pixels that may differ where all others are equal: as many as rounding may send along a different path.
const SHARE: f64 = 1e-3;

/// A larger difference is not that of a few paths among many.
const LOUD: f64 = 0.1;

/// A few pixels that differ by more than rounding, in pictures that are equal otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sparse {
    /// Number of pixels.
    count: usize,
    /// The largest difference of a channel, without its sign.
    largest: f64,
    /// Column and row of the largest difference.
    at: [usize; 2],
}

impl Sparse {
    /// Finds them; `is_moved` says whether a channel of a pixel differs by more than rounding. `None` if there are none, or
    /// too many to be called few.
    pub(super) fn of(
        difference: &[[f64; 3]],
        width: u32,
        is_moved: impl Fn(usize, usize) -> bool,
    ) -> Option<Sparse> {
        let width = width.max(1) as usize;
        let mut found = Sparse { count: 0, largest: 0.0, at: [0; 2] };
        for (pixel, channels) in difference.iter().enumerate() {
            let moved = (0..3).filter(|channel| is_moved(pixel, *channel));
            let largest = moved.map(|channel| channels[channel].abs()).fold(0.0, f64::max);
            found.count += usize::from(largest > 0.0);
            if largest > found.largest {
                (found.largest, found.at) = (largest, [pixel % width, pixel / width]);
            }
        }
        let most = (SHARE * difference.len() as f64).max(1.0);
        (found.count > 0 && found.count as f64 <= most).then_some(found)
    }

    /// Whether a difference is too large for a path that rounding sent elsewhere, unless there are only a few samples.
    pub(super) fn is_loud(&self) -> bool {
        self.largest > LOUD
    }

    /// What differs, in a picture of `pixels`.
    pub(super) fn told(&self, pixels: usize) -> String {
        let [column, row] = self.at;
        format!(
            "only {} of {pixels} pixels differ by more than rounding, most by {:.1e} at {column},{row}",
            self.count, self.largest
        )
    }
}

/// Narrows the limit of a test without known noise: a block in which all differences are within rounding cannot reach it,
/// so only the others count as tries.
pub(super) fn narrow(test: &mut BlockTest, width: u32, is_moved: impl Fn(usize, usize) -> bool) {
    let moved = |block: &Block, channel: usize| {
        let mut pixels = block.y.clone().flat_map(|row| {
            block.x.clone().map(move |column| row as usize * width as usize + column as usize)
        });
        block.is_known(channel) && pixels.any(|pixel| is_moved(pixel, channel))
    };
    let count: usize =
        test.blocks.iter().map(|block| (0..3).filter(|channel| moved(block, *channel)).count()).sum();
    test.largest_limit = largest_of(count, CHANCE);
}

#[cfg(test)]
mod tests {
    use super::{CHANCE, largest_of};
    use crate::compare::{Comparison, Side, compare};
    use crate::film::Film;
    use crate::sampling::pcg4d;

    /// A picture of floats, 80 x 48 pixels, without halves.
    fn side(value: impl Fn(u32, u32) -> f64) -> Side {
        let pixels = (0..80 * 48).map(|pixel| [value(pixel % 80, pixel / 80); 3]).collect();
        let side = Side::of_film(String::new(), String::new(), Film::new(80, 48, 1));
        Side { film: None, pixels, ..side }
    }

    fn noise(x: u32, y: u32, seed: u32) -> f64 {
        0.3 + 0.2 * f64::from(pcg4d([x, y, seed, 29])[0]) / 4_294_967_296.0
    }

    /// A picture next to itself with other values where `is_changed`.
    fn changed(is_changed: impl Fn(u32, u32) -> bool, by: f64) -> Comparison {
        let value = |x: u32, y: u32| noise(x, y, 1);
        let other = |x: u32, y: u32| if is_changed(x, y) { value(x, y) + by } else { value(x, y) };
        compare(&side(value), &side(other), None)
    }

    #[test]
    fn a_hole_in_a_picture_that_is_equal_elsewhere_is_a_difference() {
        let found = changed(|x, y| (33..37).contains(&x) && (17..20).contains(&y), -0.25);
        assert!(found.reasons.iter().any(|reason| reason.starts_with("a block is")), "{found:?}");
        assert_eq!((found.test.worst(1)[0].x.clone(), found.test.worst(1)[0].y.clone()), (32..40, 16..24));
        assert!(found.test.largest_limit < 3.0, "{}", found.test.largest_limit);
    }

    #[test]
    fn a_few_pixels_that_differ_a_lot_allow_no_verdict() {
        let found = changed(|x, y| (x, y) == (30, 20), 0.5);
        assert!(found.reasons.is_empty() && !found.is_equal(), "{:?}", found.reasons);
        let unclear = found.unclear.unwrap();
        assert!(
            unclear
                .starts_with("only 1 of 3840 pixels differ by more than rounding, most by 5.0e-1 at 30,20"),
            "{unclear}"
        );
        let found = changed(|x, y| x % 30 == 5 && y == 20, 0.5);
        assert!(found.unclear.is_some_and(|unclear| unclear.starts_with("only 3 of 3840")));
        // More of them are noise, as far as can be told.
        assert!(changed(|x, y| x % 20 == 5 && y % 20 == 5, 0.5).is_equal());
    }

    /// As of paths that rounding sends elsewhere.
    #[test]
    fn a_few_pixels_that_differ_a_little_are_noted() {
        let found = changed(|x, y| (x, y) == (30, 20), -0.02);
        assert!(found.is_equal() && found.unclear.is_none(), "{found:?}");
        assert!(
            found.notes.iter().any(|note| note.ends_with("most by 2.0e-2 at 30,20")),
            "{:?}",
            found.notes
        );
    }

    #[test]
    fn a_thousandth_of_the_pixels_are_few_but_at_least_one() {
        // Of 3840 pixels, 3.84 may differ.
        let places = [(5, 20), (35, 20), (65, 20), (75, 40)];
        let is_doubted =
            |count: usize| changed(|x, y| places[..count].contains(&(x, y)), 0.5).unclear.is_some();
        assert_eq!([0, 1, 3, 4].map(is_doubted), [false, true, true, false]);
        // Of 128 pixels, one.
        let small = |count: u32| {
            let pixels = (0..128).map(|pixel| [noise(pixel, 0, 1) + f64::from(u8::from(pixel < count)); 3]);
            let side = Side::of_film(String::new(), String::new(), Film::new(16, 8, 1));
            Side { film: None, pixels: pixels.collect(), ..side }
        };
        let is_doubted = |count: u32| compare(&small(0), &small(count), None).unclear.is_some();
        assert_eq!([0, 1, 2].map(is_doubted), [false, true, false]);
    }

    #[test]
    fn a_difference_of_a_tenth_is_too_much_for_rounding() {
        for (by, is_loud) in [(0.09, false), (-0.09, false), (0.11, true), (-0.11, true)] {
            let found = changed(|x, y| (x, y) == (30, 20), by);
            assert_eq!((found.unclear.is_some(), found.is_equal()), (is_loud, !is_loud), "{by}");
            let is_noted = found.notes.iter().any(|note| note.starts_with("only 1 of 3840 pixels differ"));
            assert_eq!(is_noted, !is_loud, "{by}: {:?}", found.notes);
        }
    }

    #[test]
    fn only_channels_of_blocks_that_differ_count_as_tries() {
        let one = side(|x, y| noise(x, y, 1));
        /// Column, row and channel.
        type Place = (usize, usize, usize);
        let limit = |places: &[Place]| {
            let mut other = side(|x, y| noise(x, y, 1));
            for (x, y, channel) in places {
                other.pixels[y * 80 + x][*channel] += 0.05;
            }
            compare(&one, &other, None).test.largest_limit
        };
        let (red, blue) = (0, 2);
        let cases: [(&[Place], usize); 4] = [
            (&[], 0),
            (&[(3, 3, red)], 1),
            (&[(3, 3, red), (4, 5, red), (3, 3, blue)], 2),
            (&[(7, 7, red), (8, 7, red), (7, 8, red), (79, 47, blue)], 4),
        ];
        for (places, tries) in cases {
            assert_eq!(limit(places), largest_of(tries, CHANCE), "{places:?}");
        }
    }

    #[test]
    fn blocks_that_are_too_near_without_halves_are_not_blamed_on_halves() {
        let stripes = |x: u32, y: u32| {
            let by = if y.is_multiple_of(2) { 0.3 } else { -0.3 };
            noise(x, y, 2) + by
        };
        let found = compare(&side(|x, y| noise(x, y, 1)), &side(stripes), None);
        assert!(found.notes.iter().any(|note| note.contains("such as stripes")), "{:?}", found.notes);
        assert!(!found.notes.iter().any(|note| note.contains("do the halves")), "{:?}", found.notes);
    }
}
