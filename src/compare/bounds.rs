//! What a channel at the largest value of an integer format tells: the picture is at least that bright there.
//!
//! If only one picture is clipped, a difference that is computed with the bound can only be too small, so its mean over a
//! block is evidence in one direction. The bound of the other direction is infinite.

use super::side::Side;
use crate::statistics::blocks::{Block, BlockTest, Differences, Noise};

/// By what factor a block must exceed the limit for normal noise before the blocks with clipped channels count. Where bright
/// paths are rare, the noise that a clipped picture shows is far from normal.
const FACTOR: f64 = 1.6;

/// At least this share of the blocks that differ after clipping must also differ by their bounds. If a picture is dark
/// because it missed rare bright paths, it found some in other blocks, whose bounds then allow them to be equal.
const SHARE: f64 = 0.75;

/// The quantisation error of a channel. A clipped channel has none: its bound is exact.
pub(super) fn step_of(step: f64) -> f64 {
    if step.is_finite() { step } else { 0.0 }
}

/// The largest difference that rounding explains, if `step` is the root of the sum of both squared quantisation errors.
pub(super) fn rounding(step: f64, tolerance: f64) -> f64 {
    // The sum of two numbers is at most the root of two times the root of the sum of their squares. Neighbouring bytes
    // reach this limit, so it is widened by the rounding of this arithmetic.
    std::f64::consts::SQRT_2 * step * (1.0 + 1e-9) + tolerance
}

/// The least value that a channel can have, cut at a limit. NaN if it is not a number in a picture of floats.
fn capped(side: &Side, limit: f64, pixel: usize, channel: usize) -> f64 {
    let value = side.pixels[pixel][channel];
    let least = if value.is_nan() && side.steps.is_some() { side.limit } else { value };
    if least > limit { limit } else { least }
}

/// The difference of a channel, the second less the first, if both are cut where either format ends.
pub(super) fn capped_difference(a: &Side, b: &Side, pixel: usize, channel: usize) -> f64 {
    let limit = a.limit.min(b.limit);
    capped(b, limit, pixel, channel) - capped(a, limit, pixel, channel)
}

/// Which picture is brighter.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Brighter {
    First,
    Second,
}

impl Brighter {
    /// The difference of a channel, the second less the first, with the bright picture at its least value. NaN if the
    /// dark picture is clipped.
    fn bound(self, a: &Side, b: &Side, pixel: usize, channel: usize) -> f64 {
        let limit = a.limit.min(b.limit);
        match self {
            Brighter::First => b.pixels[pixel][channel] - capped(a, limit, pixel, channel),
            Brighter::Second => capped(b, limit, pixel, channel) - a.pixels[pixel][channel],
        }
    }

    /// `z` in the direction of the bright picture.
    fn evidence(self, block: &Block, channel: usize) -> f64 {
        match self {
            Brighter::First => -block.z[channel],
            Brighter::Second => block.z[channel],
        }
    }
}

/// Adds to a test without known noise the blocks that clipping hides, but whose bounds prove that they differ. Returns
/// their number. `steps` are those of both pictures.
pub(super) fn add_bounds(
    test: &mut BlockTest,
    a: &Side,
    b: &Side,
    steps: Option<&[[f64; 3]]>,
    tolerance: f64,
) -> usize {
    let is_whole = test.counts.iter().all(|count| *count == test.blocks.len());
    if is_whole || !a.limit.min(b.limit).is_finite() {
        return 0;
    }
    let tested = |value: &dyn Fn(usize, usize) -> f64| {
        let values: Vec<[f64; 3]> =
            (0..a.pixels.len()).map(|pixel| [0, 1, 2].map(|channel| value(pixel, channel))).collect();
        let noise = Noise::Spread;
        BlockTest::of(&Differences { width: a.width, values: &values, noise, steps, tolerance, rare: 0.0 })
    };
    let capped = tested(&|pixel, channel| capped_difference(a, b, pixel, channel));
    let limit = capped.largest_limit;
    let mut is_proven = vec![false; test.blocks.len()];
    for brighter in [Brighter::First, Brighter::Second] {
        let bound = tested(&|pixel, channel| brighter.bound(a, b, pixel, channel));
        let (mut differing, mut proven, mut largest) = (0_usize, Vec::new(), 0.0_f64);
        for index in 0..test.blocks.len() {
            for channel in (0..3).filter(|channel| !test.blocks[index].is_known(*channel)) {
                differing += usize::from(brighter.evidence(&capped.blocks[index], channel) > limit);
                let z = brighter.evidence(&bound.blocks[index], channel);
                if z > limit {
                    proven.push((index, channel));
                    largest = largest.max(z);
                }
            }
        }
        if largest > FACTOR * limit && proven.len() as f64 >= SHARE * differing as f64 {
            test.largest = test.largest.max(largest);
            for (index, channel) in proven {
                is_proven[index] = true;
                test.blocks[index].z[channel] = bound.blocks[index].z[channel];
                test.blocks[index].means[channel] = bound.blocks[index].means[channel];
            }
        }
    }
    is_proven.into_iter().filter(|is_proven| *is_proven).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{Comparison, compare};
    use crate::film::Film;
    use crate::sampling::pcg4d;

    /// A number of 0 to 1 that depends on a pixel.
    fn random(pixel: u32, seed: u32) -> f64 {
        f64::from(pcg4d([pixel, seed, 3, 17])[0]) / 4_294_967_296.0
    }

    /// A picture of floats, 80 x 48 pixels.
    fn floats(value: impl Fn(u32) -> f64) -> Side {
        let side = Side::of_film(String::new(), String::new(), Film::new(80, 48, 1));
        Side { film: None, pixels: (0..80 * 48).map(|pixel| [value(pixel); 3]).collect(), ..side }
    }

    /// The same in 8 bits, as the book writes them.
    fn bytes(value: impl Fn(u32) -> f64) -> Side {
        let ends = |pixel: u32| {
            let byte = (256.0 * value(pixel).max(0.0).sqrt()).floor().min(255.0);
            if byte < 255.0 { [byte, byte + 1.0].map(|end| (end / 256.0).powi(2)) } else { [f64::NAN; 2] }
        };
        let each = |part: fn([f64; 2]) -> f64| -> Vec<[f64; 3]> {
            (0..80 * 48).map(|pixel| [part(ends(pixel)); 3]).collect()
        };
        let limit = (255.0_f64 / 256.0).powi(2);
        let steps = Some(each(|[low, high]| 0.5 * (high - low)));
        Side { pixels: each(|[low, high]| 0.5 * (low + high)), steps, limit, ..floats(|_| 0.0) }
    }

    fn is_clipped(found: &Comparison) -> bool {
        found.reasons.iter().any(|reason| reason.contains("largest value of an integer format"))
    }

    #[test]
    fn rounding_explains_at_most_the_steps_of_both_pictures() {
        for (a, b) in [(0.003, 0.003), (0.1, 0.1), (0.003, 0.0), (0.002, 0.007)] {
            let most = rounding(f64::hypot(a, b), 0.0);
            assert!(a + b <= most && most <= f64::hypot(a, b) * 1.415, "{a} {b}: {most}");
            assert_eq!(rounding(f64::hypot(a, b), 0.5), most + 0.5);
        }
        assert!(
            rounding(f64::hypot(0.1, 0.1), 0.0) < 0.2 * (1.0 + 1e-8),
            "neighbouring bytes reach the limit"
        );
        assert_eq!([step_of(0.25), step_of(f64::NAN)], [0.25, 0.0]);
    }

    #[test]
    fn a_difference_is_cut_where_either_format_ends() {
        let clipped = f64::NAN;
        let bytes = |value: f64, limit: f64| Side {
            limit,
            steps: Some(vec![[0.01; 3]; 80 * 48]),
            ..floats(move |_| value)
        };
        let float = |value: f64| floats(move |_| value);
        for (a, b, expected) in [
            (float(0.25), float(0.75), 0.5),
            (float(0.25), bytes(clipped, 0.875), 0.625),
            (float(5.0), bytes(clipped, 0.875), 0.0),
            (float(5.0), bytes(0.5, 0.875), -0.375),
            (bytes(0.25, 0.875), bytes(clipped, 0.75), 0.5),
            (bytes(0.8125, 0.875), bytes(clipped, 0.75), 0.0),
            (bytes(clipped, 0.875), bytes(clipped, 0.75), 0.0),
            (float(-1.0), bytes(clipped, 0.875), 1.875),
            (float(f64::INFINITY), bytes(0.5, 0.875), -0.375),
        ] {
            let there = capped_difference(&a, &b, 7, 1);
            assert_eq!((there, capped_difference(&b, &a, 7, 1)), (expected, -expected));
        }
        // No number of a picture of floats stands for anything.
        assert!(capped_difference(&float(f64::NAN), &bytes(0.5, 0.875), 7, 1).is_nan());
    }

    #[test]
    fn what_is_clipped_in_one_picture_and_dark_in_the_other_differs() {
        let scene = |seed: u32| move |pixel: u32| 0.2 + 0.4 * random(pixel, seed);
        let painted: [fn(u32) -> bool; 4] = [
            |pixel| (16..40).contains(&(pixel % 80)) && (8..32).contains(&(pixel / 80)),
            |pixel| (24..32).contains(&(pixel % 80)) && (16..24).contains(&(pixel / 80)),
            |pixel| pixel % 80 < 40,
            |pixel| pixel / 80 < 47,
        ];
        for is_painted in painted {
            let white = bytes(move |pixel| if is_painted(pixel) { 1.0 } else { scene(2)(pixel) });
            for other in [floats(scene(1)), bytes(scene(1))] {
                for found in [compare(&other, &white, None), compare(&white, &other, None)] {
                    assert!(!found.is_equal() && is_clipped(&found), "{:?}", found.reasons);
                    let worst = &found.test.worst(1)[0];
                    assert!(is_painted(worst.y.start * 80 + worst.x.start), "{worst:?}");
                }
            }
        }
    }

    #[test]
    fn a_clipped_picture_next_to_a_brighter_one_is_no_difference() {
        let bright =
            |seed: u32| move |pixel: u32| if pixel % 80 < 24 { 2.0 + random(pixel, seed) } else { 0.3 };
        for other in [floats(bright(1)), bytes(bright(1))] {
            let found = compare(&other, &bytes(bright(2)), None);
            assert!(found.is_equal(), "{:?} {:?}", found.reasons, found.unclear);
        }
    }

    /// Of two samples, and of 4 and of 16, with noise around the limit: even, or a path of radiance 8 once in a while.
    #[test]
    fn noise_that_is_clipped_is_no_difference() {
        for (samples, seed) in
            [2, 4, 16].into_iter().flat_map(|samples| [1, 2, 3].map(|seed| (samples, seed)))
        {
            let mean = move |of: u32, seed: u32, pixel: u32| {
                let draws = (0..samples).map(|sample| random(pixel, 1000 * seed + sample));
                let sum: f64 = draws
                    .map(|x| match of {
                        0 => 0.5 + x,
                        1 => 1.8 * x,
                        _ if x < 0.08 => 8.0,
                        _ => 0.1,
                    })
                    .sum();
                sum / f64::from(samples)
            };
            for of in 0..3 {
                let there = bytes(move |pixel| mean(of, seed, pixel));
                let value = move |pixel| mean(of, seed + 10, pixel);
                for other in [floats(value), bytes(value)] {
                    let found = compare(&there, &other, None);
                    assert!(!is_clipped(&found), "{of}, {samples} samples: {:?}", found.reasons);
                }
            }
        }
    }

    #[test]
    fn nothing_is_said_of_pictures_that_are_clipped_nearly_everywhere() {
        let value = |columns: u32| move |pixel: u32| if pixel % 80 < columns { 1.0 } else { 0.5 };
        let white = |columns: u32| bytes(value(columns));
        for columns in [80, 48] {
            let found = compare(&white(columns), &floats(value(columns)), None);
            assert!(found.reasons.is_empty() && !found.is_equal(), "{:?}", found.reasons);
            assert!(found.unclear.is_some_and(|unclear| unclear.contains("can be judged")), "{columns}");
            let found = compare(&white(columns), &white(columns), None);
            assert!(found.is_equal() && found.is_same, "{columns}: {:?}", found.unclear);
        }
        let found = compare(&white(40), &floats(value(40)), None);
        assert!(found.is_equal() && !found.is_same && found.unclear.is_none(), "{:?}", found.unclear);
        // If there is a difference, the rest does not matter.
        let dark = bytes(|pixel| if pixel % 80 < 40 { 1.0 } else { 0.0 });
        let found = compare(&white(80), &dark, None);
        assert!(is_clipped(&found) && found.unclear.is_none(), "{:?}", found.reasons);
    }
}
