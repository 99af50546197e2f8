//! Whether two pictures differ by more than their noise.
//!
//! The picture is cut into blocks of about 8 x 8 pixels. A block's `z` is its mean difference divided by the
//! deviation of that mean; if there is nothing but noise, it is a normal number. Over `m` blocks the sum of `z^2`
//! then lies within `m +- 4 sqrt(2 m)`, and the largest `z` within a limit that 99 of 100 pairs of equal pictures
//! keep. The three channels are tested separately, because their noise is correlated.

use super::normal::{from_student, largest_of};
use std::ops::Range;

/// Side of a block in pixels, approximately: blocks divide the picture evenly.
pub const SIDE: u32 = 8;

/// Probability that equal pictures exceed the limit of `z`.
pub const CHANCE: f64 = 0.01;

/// By how many deviations the sum of `z^2` may differ.
pub const SUM_DEVIATIONS: f64 = 4.0;

/// The difference of two pictures, row by row from the top, and what is known about its noise.
#[derive(Clone, Debug)]
pub struct Differences<'a> {
    /// Width in pixels.
    pub width: u32,
    /// Difference of each pixel. A channel that is not finite in one pixel is left out of the whole block: near a
    /// limit, noise decides which values are known, so those that are known would be biased.
    pub values: &'a [[f64; 3]],
    /// Independent noise of each pixel.
    pub noise: Noise<'a>,
    /// Largest error of each pixel in either direction that a whole block may share, such as that of 8-bit
    /// quantisation.
    pub steps: Option<&'a [[f64; 3]]>,
    /// Additional deviation that the mean of a block may have.
    pub tolerance: f64,
    /// Additional deviation that a single pixel of a block may have: the effect of rare paths that both halves happen
    /// to have in equal numbers, so that the difference of the halves does not show them.
    pub rare: f64,
}

/// What is known about the noise of each pixel.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// Estimates of each pixel's variance, with one degree of freedom each.
    Variances(&'a [[f64; 3]]),
    /// Nothing. The noise is taken from the spread of the differences within a block, so differences finer than a
    /// block count as noise.
    Spread,
}

/// A block and the differences of its channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Columns of the picture.
    pub x: Range<u32>,
    /// Rows of the picture.
    pub y: Range<u32>,
    /// Mean differences.
    pub means: [f64; 3],
    /// Mean differences divided by their deviations, as normal numbers.
    pub z: [f64; 3],
    /// Fraction of the variance that is noise, not quantisation or tolerance; `None` if the channel is not known.
    noise_share: [Option<f64>; 3],
}

impl Block {
    /// The largest `|z|` of the channels.
    pub fn largest(&self) -> f64 {
        self.z.iter().fold(0.0, |most, z| most.max(z.abs()))
    }

    /// Whether a channel is known in all pixels of the block.
    pub fn is_known(&self, channel: usize) -> bool {
        self.noise_share[channel].is_some()
    }
}

/// The result of the test.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockTest {
    /// All blocks, row by row.
    pub blocks: Vec<Block>,
    /// Number of blocks in which each channel is known.
    pub counts: [usize; 3],
    /// Sum of `z^2` of each channel.
    pub sums: [f64; 3],
    /// By how many deviations each sum exceeds that of noise.
    pub excess: [f64; 3],
    /// The same, relative to what noise alone would give without quantisation and tolerance: the least possible.
    shortfall: [f64; 3],
    /// The largest `|z|`.
    pub largest: f64,
    /// The limit for the largest `|z|`.
    pub largest_limit: f64,
}

impl BlockTest {
    /// Tests the differences.
    pub fn of(differences: &Differences) -> Self {
        let width = differences.width.max(1);
        let height = (differences.values.len() / width as usize) as u32;
        let columns = cuts(width);
        let blocks: Vec<Block> = cuts(height)
            .into_iter()
            .flat_map(|y| columns.iter().map(move |x| (x.clone(), y.clone())))
            .map(|(x, y)| block(differences, x, y))
            .collect();
        let shares = |channel: usize| blocks.iter().filter_map(move |block| block.noise_share[channel]);
        let counts = [0, 1, 2].map(|channel| shares(channel).count());
        let sums = [0, 1, 2].map(|c: usize| blocks.iter().map(|block| block.z[c].powi(2)).sum::<f64>());
        let deviations = |channel: usize, expected: f64| {
            (sums[channel] - expected) / (2.0 * counts[channel].max(1) as f64).sqrt()
        };
        BlockTest {
            counts,
            sums,
            excess: [0, 1, 2].map(|channel| deviations(channel, counts[channel] as f64)),
            shortfall: [0, 1, 2].map(|channel| deviations(channel, shares(channel).sum())),
            largest: blocks.iter().map(Block::largest).fold(0.0, f64::max),
            largest_limit: largest_of(counts.iter().sum(), CHANCE),
            blocks,
        }
    }

    /// Whether all differences are within the noise.
    pub fn is_within(&self) -> bool {
        self.largest_excess() <= SUM_DEVIATIONS && self.largest <= self.largest_limit
    }

    /// Whether the blocks are closer to each other than noise allows, so the pictures cannot be independent.
    pub fn is_too_near(&self) -> bool {
        self.shortfall.iter().any(|deviations| *deviations < -SUM_DEVIATIONS)
    }

    /// By how many deviations the sum of `z^2` exceeds that of noise, in the worst channel.
    pub fn largest_excess(&self) -> f64 {
        self.excess.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Root mean square of `z` over the blocks, in the worst channel: 1 for noise alone.
    pub fn ratio(&self) -> f64 {
        let means = self.sums.iter().zip(self.counts).map(|(sum, count)| sum / count.max(1) as f64);
        means.fold(0.0, f64::max).sqrt()
    }

    /// The `count` blocks with the largest differences, the largest first.
    pub fn worst(&self, count: usize) -> Vec<&Block> {
        let mut blocks: Vec<&Block> = self.blocks.iter().collect();
        blocks.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
        blocks.truncate(count);
        blocks
    }
}

/// Divides a side into pieces of about [`SIDE`] pixels.
fn cuts(length: u32) -> Vec<Range<u32>> {
    let count = ((length + SIDE / 2) / SIDE).max(1);
    let at = |index: u32| (u64::from(length) * u64::from(index) / u64::from(count)) as u32;
    (0..count).map(|index| at(index)..at(index + 1)).collect()
}

fn block(differences: &Differences, x: Range<u32>, y: Range<u32>) -> Block {
    let width = differences.width;
    let (mut means, mut z, mut noise_share) = ([0.0; 3], [0.0; 3], [None; 3]);
    for channel in 0..3 {
        let pixels =
            || y.clone().flat_map(|row| x.clone().map(move |column| (row * width + column) as usize));
        let value = |pixel: usize| differences.values[pixel][channel];
        let count = pixels().count() as f64;
        let mean = pixels().map(value).sum::<f64>() / count;
        if !mean.is_finite() {
            continue;
        }
        let (told, freedom) = match differences.noise {
            Noise::Variances(variances) => {
                let sum: f64 = pixels().map(|pixel| variances[pixel][channel]).sum();
                let squares: f64 = pixels().map(|pixel| variances[pixel][channel].powi(2)).sum();
                // If v is the true variance of a pixel, E sum^2 = (sum of v)^2 + 2 (sum of v^2) and E squares = 3
                // (sum of v^2). So this estimates (sum of v)^2 / (sum of v^2) without bias; it is 1 if a single pixel
                // has all the noise.
                let freedom = if squares > 0.0 { 3.0 * sum * sum / squares - 2.0 } else { count };
                (sum / (count * count), freedom)
            }
            Noise::Spread => {
                let squares: f64 = pixels().map(|pixel| (value(pixel) - mean).powi(2)).sum();
                (squares / (count * (count - 1.0).max(1.0)), (count - 1.0).max(1.0))
            }
        };
        let step = differences
            .steps
            .map_or(0.0, |steps| pixels().map(|pixel| steps[pixel][channel]).sum::<f64>() / count);
        // In a smooth block, all pixels may be at the same end of their step, so the whole step counts as one
        // deviation.
        let known = step * step + differences.tolerance.powi(2);
        // What both halves may miss is a guess, so it has no more degrees of freedom than their estimate.
        let variance = told + (differences.rare / count).powi(2);
        let total = variance + known;
        means[channel] = mean;
        if total > 0.0 {
            // Known variance counts as having infinitely many degrees of freedom (Welch and Satterthwaite).
            let freedom = freedom * (total / variance.max(1e-9 * total)).powi(2);
            z[channel] = from_student(mean / total.sqrt(), freedom);
            noise_share[channel] = Some(told / total);
        } else if mean != 0.0 {
            z[channel] = f64::INFINITY.copysign(mean);
            noise_share[channel] = Some(1.0);
        } else {
            noise_share[channel] = Some(0.0);
        }
    }
    Block { x, y, means, z, noise_share }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::pcg4d;
    use proptest::prelude::*;

    /// Normal numbers by Box and Muller, two for each counter.
    fn normal(counter: u32, seed: u32) -> [f64; 2] {
        let [a, b, _, _] = pcg4d([counter, seed, 7, 11]).map(|x| (f64::from(x) + 0.5) / 4_294_967_296.0);
        let (radius, turn) = ((-2.0 * a.ln()).sqrt(), std::f64::consts::TAU * b);
        [radius * turn.cos(), radius * turn.sin()]
    }

    /// Differences with deviation 1 per pixel, and the variances that two halves would estimate.
    fn noise(width: u32, height: u32, seed: u32) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        (0..width * height)
            .map(|pixel| {
                let of = |channel: u32| normal(3 * pixel + channel, seed);
                let pairs = [of(0), of(1), of(2)];
                (pairs.map(|pair| pair[0]), pairs.map(|pair| pair[1].powi(2)))
            })
            .unzip()
    }

    fn test(width: u32, values: &[[f64; 3]], noise: Noise) -> BlockTest {
        BlockTest::of(&Differences { width, values, noise, steps: None, tolerance: 0.0, rare: 0.0 })
    }

    #[test]
    fn noise_passes_as_often_as_it_should() {
        let (mut failed_by_halves, mut failed_by_spread) = (0, 0);
        for seed in 0..200 {
            let (values, variances) = noise(96, 64, seed);
            let halves = test(96, &values, Noise::Variances(&variances));
            assert!(!halves.is_too_near());
            failed_by_halves += usize::from(!halves.is_within());
            failed_by_spread += usize::from(!test(96, &values, Noise::Spread).is_within());
        }
        // 2 of 200 are expected; the probability of 9 or more is 2e-4.
        assert!(failed_by_halves < 9 && failed_by_spread < 9, "{failed_by_halves}, {failed_by_spread}");
    }

    #[test]
    fn noise_of_one_pixel_passes_as_often_as_it_should() {
        // One pixel of each block has all the noise.
        let failed = (0..200)
            .filter(|seed| {
                let (mut values, mut variances) = noise(96, 64, *seed);
                for pixel in (0..96 * 64).filter(|pixel| pixel % 8 != 3 || pixel / 96 % 8 != 5) {
                    values[pixel] = [0.0; 3];
                    variances[pixel] = [0.0; 3];
                }
                !test(96, &values, Noise::Variances(&variances)).is_within()
            })
            .count();
        assert!(failed < 9, "{failed} of 200 instead of about 2");
    }

    #[test]
    fn a_shift_of_one_block_and_a_faint_shift_of_all_are_found() {
        let (values, variances) = noise(96, 64, 1);
        let noises = [Noise::Variances(&variances), Noise::Spread];
        let mut one = values.clone();
        for (x, y) in (16..24).flat_map(|x| (8..16).map(move |y| (x, y))) {
            one[y * 96 + x][1] += 1.0;
        }
        let all: Vec<[f64; 3]> = values.iter().map(|v| [v[0] + 0.12, v[1], v[2]]).collect();
        for noise in noises {
            let found = test(96, &one, noise);
            assert!(!found.is_within());
            assert_eq!((found.worst(1)[0].x.clone(), found.worst(1)[0].y.clone()), (16..24, 8..16));
            let found = test(96, &all, noise);
            assert!(
                found.excess[0] > SUM_DEVIATIONS && found.excess[1] < SUM_DEVIATIONS,
                "{:?}",
                found.excess
            );
        }
    }

    #[test]
    fn noise_that_is_said_to_be_twice_as_large_is_too_near() {
        let (values, variances) = noise(96, 64, 2);
        let larger: Vec<[f64; 3]> = variances.iter().map(|v| v.map(|x| 4.0 * x)).collect();
        assert!(test(96, &values, Noise::Variances(&larger)).is_too_near());
    }

    #[test]
    fn steps_and_tolerance_excuse_what_they_explain() {
        let shifted = vec![[0.004; 3]; 64 * 64];
        let none = vec![[0.0; 3]; 64 * 64];
        let with = |steps, tolerance| {
            let noise = Noise::Variances(&none);
            BlockTest::of(&Differences { width: 64, values: &shifted, noise, steps, tolerance, rare: 0.0 })
        };
        assert!(!with(None, 0.0).is_within());
        assert!(with(None, 0.005).is_within());
        let steps = vec![[0.004; 3]; 64 * 64];
        let by_steps = with(Some(&steps), 0.0);
        assert!(by_steps.largest < 1.01 && !by_steps.is_too_near(), "{}", by_steps.largest);
    }

    #[test]
    fn what_is_known_counts_as_endless_freedom() {
        // One pixel has all the noise, with one degree of freedom, and half the variance is known: 4 degrees by Welch
        // and Satterthwaite. Student's two-sided quantile at 5 % is then 2.7764; that of a normal number is 1.960.
        let share = 8.0 * 8.0;
        let mut variances = vec![[0.0; 3]; 64];
        variances[20] = [share * share; 3];
        let of = |tolerance: f64, deviations: f64| {
            let total = (1.0 + tolerance * tolerance).sqrt();
            let values = vec![[deviations * total; 3]; 64];
            let noise = Noise::Variances(&variances);
            BlockTest::of(&Differences {
                width: 8,
                values: &values,
                noise,
                steps: None,
                tolerance,
                rare: 0.0,
            })
        };
        for (tolerance, quantile) in [(1.0, 2.7764), (2.0_f64.sqrt(), 2.2622)] {
            let z = of(tolerance, quantile).blocks[0].z;
            assert!(z.iter().all(|z| (z - 1.960).abs() < 0.03), "{tolerance}: {z:?}");
        }
    }

    #[test]
    fn a_rare_path_that_both_halves_hold_is_no_difference() {
        let none = vec![[0.0; 3]; 64];
        let mut values = none.clone();
        values[9] = [-1.0 / 32.0; 3];
        let noise = Noise::Variances(&none);
        let test = |rare| {
            BlockTest::of(&Differences {
                width: 8,
                values: &values,
                noise,
                steps: None,
                tolerance: 2e-6,
                rare,
            })
        };
        assert!(!test(0.0).is_within());
        assert!(test(2.0 / 64.0).is_within());
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let mut values = vec![[0.0; 3]; 64];
        values[5] = [f64::NAN, 0.0, 0.0];
        let found = test(8, &values, Noise::Spread);
        assert!(found.is_within() && found.counts == [0, 1, 1], "{found:?}");
        assert!(test(8, &[[f64::NAN; 3]; 64], Noise::Spread).is_within());
    }

    proptest! {
        #[test]
        fn blocks_cover_every_pixel_once(width in 1_u32..70, height in 1_u32..70) {
            let values = vec![[1.0; 3]; (width * height) as usize];
            let found = test(width, &values, Noise::Spread);
            let area = |b: &Block| (b.x.end - b.x.start) * (b.y.end - b.y.start);
            prop_assert_eq!(found.blocks.iter().map(area).sum::<u32>(), width * height);
            prop_assert!(found.blocks.iter().all(|b| area(b) > 0 && b.x.end <= width && b.y.end <= height));
        }
    }
}
