//! Whether two pictures differ by more than their noise.
//!
//! The picture is cut into blocks of about 8 x 8 pixels. A block's `z` is its mean difference over that
//! difference's deviation; with nothing but noise it is a normal number. So over `m` blocks the sum of `z^2` lies
//! within `m +- 4 sqrt(2 m)` and the largest within a limit that 99 of 100 equal pictures keep. The three
//! channels, whose noise is much alike, are tested apart.

use super::normal::{from_student, largest_of};
use std::ops::Range;

/// Pixels along a block's side, about: blocks share a picture's side evenly.
pub const SIDE: u32 = 8;

/// How often equal pictures have a larger `z` than the limit.
const CHANCE: f64 = 0.01;

/// How many deviations the sum of `z^2` may be off.
pub const SUM_DEVIATIONS: f64 = 4.0;

/// Two pictures' difference, row by row from the top, with what is known of its noise.
#[derive(Clone, Debug)]
pub struct Differences<'a> {
    /// Pixels across.
    pub width: u32,
    /// Of each pixel's channels. Where one is not finite, its block leaves out that channel: values near a limit
    /// are known or not by their noise, and those that are known would not stand for all.
    pub values: &'a [[f64; 3]],
    /// Noise that is every pixel's own.
    pub noise: Noise<'a>,
    /// Largest possible error, to either side, of each pixel that a whole block may share, such as that of 8-bit
    /// steps.
    pub steps: Option<&'a [[f64; 3]]>,
    /// Deviation that a block's mean may have besides.
    pub tolerance: f64,
    /// Deviation that a single pixel of a block may have besides: what rare paths bring of which both halves
    /// happen to hold as many, so that their difference does not tell them.
    pub rare: f64,
}

/// What is known of each pixel's noise.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// Estimates of each pixel's variance, of one degree of freedom each.
    Variances(&'a [[f64; 3]]),
    /// Nothing: the spread of the differences within a block tells it, so that differences finer than a block
    /// pass for noise.
    Spread,
}

/// A block and how far its channels are off.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Columns.
    pub x: Range<u32>,
    /// Rows.
    pub y: Range<u32>,
    /// Mean differences.
    pub means: [f64; 3],
    /// Mean differences over their deviations, as normal numbers.
    pub z: [f64; 3],
    /// Share of the deviation's square that is noise, and not steps or tolerance; `None` where nothing is known.
    noise_share: [Option<f64>; 3],
}

impl Block {
    /// The channel that is farthest off.
    pub fn largest(&self) -> f64 {
        self.z.iter().fold(0.0, |most, z| most.max(z.abs()))
    }
}

/// What the blocks say.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockTest {
    /// All blocks, row by row.
    pub blocks: Vec<Block>,
    /// Blocks in which each channel is known.
    pub counts: [usize; 3],
    /// Sum of `z^2` of each channel.
    pub sums: [f64; 3],
    /// By how many deviations each sum is above that of noise.
    pub excess: [f64; 3],
    /// The same against what noise leaves besides steps and tolerance: the least that noise gives.
    shortfall: [f64; 3],
    /// The largest `|z|`.
    pub largest: f64,
    /// What it may be.
    pub largest_limit: f64,
}

impl BlockTest {
    /// Tests the differences of a picture of `differences.width` columns.
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

    /// Whether nothing is farther off than noise puts it.
    pub fn is_within(&self) -> bool {
        self.largest_excess() <= SUM_DEVIATIONS && self.largest <= self.largest_limit
    }

    /// Whether the blocks are nearer to each other than their noise allows: it is not the noise of pictures
    /// that have nothing in common.
    pub fn is_too_near(&self) -> bool {
        self.shortfall.iter().any(|deviations| *deviations < -SUM_DEVIATIONS)
    }

    /// By how many deviations the sum of `z^2` is above that of noise, in the channel where it is most.
    pub fn largest_excess(&self) -> f64 {
        self.excess.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Root of the mean of `z^2` over blocks, of the channel where it is largest: 1 for noise alone.
    pub fn ratio(&self) -> f64 {
        let means = self.sums.iter().zip(self.counts).map(|(sum, count)| sum / count.max(1) as f64);
        means.fold(0.0, f64::max).sqrt()
    }

    /// The `count` blocks that are farthest off, the farthest first.
    pub fn worst(&self, count: usize) -> Vec<&Block> {
        let mut blocks: Vec<&Block> = self.blocks.iter().collect();
        blocks.sort_by(|a, b| b.largest().total_cmp(&a.largest()));
        blocks.truncate(count);
        blocks
    }
}

/// Cuts a side into pieces of about [`SIDE`] pixels.
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
                // Where each true variance is v, E sum^2 = (sum of v)^2 + 2 (sum of v^2), and E squares = 3 (sum of v^2).
                // So this estimates (sum of v)^2 / (sum of v^2) without bias: 1 where a single pixel has all the noise.
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
        // In a smooth block all pixels may be at the same end of their step, so its whole length is one deviation.
        let known = step * step + differences.tolerance.powi(2);
        // What the halves may both miss is a guess, and no better known than what they tell.
        let variance = told + (differences.rare / count).powi(2);
        let total = variance + known;
        means[channel] = mean;
        if total > 0.0 {
            // What is not estimated but known counts as having endless freedom (Welch and Satterthwaite).
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

    /// Normal numbers by Box and Muller, a pair for each counter.
    fn normal(counter: u32, seed: u32) -> [f64; 2] {
        let [a, b, _, _] = pcg4d([counter, seed, 7, 11]).map(|x| (f64::from(x) + 0.5) / 4_294_967_296.0);
        let (radius, turn) = ((-2.0 * a.ln()).sqrt(), std::f64::consts::TAU * b);
        [radius * turn.cos(), radius * turn.sin()]
    }

    /// A difference of deviation 1 a pixel, and what two halves would say of its variance.
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
        // 2 of 200 are expected; 9 or more have a chance of 2e-4.
        assert!(failed_by_halves < 9 && failed_by_spread < 9, "{failed_by_halves}, {failed_by_spread}");
    }

    #[test]
    fn noise_of_one_pixel_passes_as_often_as_it_should() {
        // A single pixel of each block has all the noise.
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
        assert!(failed < 9, "{failed} of 200, where 2 are expected");
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
        // One pixel has all the noise, which is of one degree of freedom, and half the variance is known: by Welch and
        // Satterthwaite 4 degrees. Student's two-sided quantile there is 2.7764 at 5 %, that of a normal number 1.960.
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
