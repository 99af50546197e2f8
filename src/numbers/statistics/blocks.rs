//! Tests whether two pictures differ by more than their noise.
//!
//! The picture is divided into blocks of about 8 x 8 pixels. A block's `z` is its mean difference over the deviation of
//! that mean; with noise alone, it is a standard normal number. Over `m` blocks the sum of `z^2` then lies within
//! `m +- 4 sqrt(2 m)`, and the largest `z` within a limit that 99 of 100 pairs of equal pictures keep. The channels are
//! tested separately, because their noise is correlated.

use super::normal::{from_student, largest_of};
use std::ops::Range;

/// Approximate side of a block, pixels: blocks divide the picture evenly.
pub const SIDE: u32 = 8;

/// Probability that equal pictures exceed the limit of `z`.
pub const CHANCE: f64 = 0.01;

/// Deviations by which the sum of `z^2` may differ.
pub const SUM_DEVIATIONS: f64 = 4.0;

/// The difference of two pictures, row by row from the top, and what is known about its noise.
#[derive(Clone, Debug)]
pub struct Differences<'a> {
    pub width: u32,
    /// Difference of each pixel. A channel that is not finite in one pixel is left out of the whole block: near a
    /// limit, noise decides which values are known, so the known ones would be biased.
    pub values: &'a [[f64; 3]],
    /// Independent noise of each pixel.
    pub noise: Noise<'a>,
    /// Largest error of each pixel, either way, that a whole block may share, such as 8-bit quantisation.
    pub steps: Option<&'a [[f64; 3]]>,
    /// Additional deviation allowed for the mean of a block.
    pub tolerance: f64,
    /// Additional deviation allowed for a single pixel of a block: rare paths that both halves happen to contain
    /// equally often, so that the halves' difference does not show them.
    pub rare: f64,
}

#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// Estimates of each pixel's variance, with one degree of freedom each.
    Variances(&'a [[f64; 3]]),
    /// Nothing. The noise is taken from the spread of the differences within a block, so differences finer than a block
    /// count as noise.
    Spread,
}

/// A block and its channels' differences.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    pub x: Range<u32>,
    pub y: Range<u32>,
    pub means: [f64; 3],
    /// Mean differences divided by their deviations, as normal numbers.
    pub z: [f64; 3],
    /// Share of the variance that is noise, not quantisation or tolerance; `None` if the channel is unknown.
    noise_share: [Option<f64>; 3],
}

impl Block {
    /// The channels' largest `|z|`.
    pub fn largest(&self) -> f64 {
        self.z.iter().fold(0.0, |most, z| most.max(z.abs()))
    }

    /// Whether a channel is known in all pixels of the block.
    pub fn is_known(&self, channel: usize) -> bool {
        self.noise_share[channel].is_some()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct BlockTest {
    /// Row by row.
    pub blocks: Vec<Block>,
    /// Number of blocks in which each channel is known.
    pub counts: [usize; 3],
    /// Sum of `z^2` of each channel.
    pub sums: [f64; 3],
    /// Deviations by which each sum exceeds that of noise.
    pub excess: [f64; 3],
    /// The same, relative to what noise would give without quantisation and tolerance: a lower bound.
    shortfall: [f64; 3],
    /// The largest `|z|`.
    pub largest: f64,
    /// The limit of the largest `|z|`.
    pub largest_limit: f64,
}

impl BlockTest {
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

    /// Deviations by which the sum of `z^2` exceeds that of noise, in the worst channel.
    pub fn largest_excess(&self) -> f64 {
        self.excess.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Root mean square of `z` over the blocks, in the worst channel: 1 for noise alone.
    pub fn ratio(&self) -> f64 {
        let means = self.sums.iter().zip(self.counts).map(|(sum, count)| sum / count.max(1) as f64);
        means.fold(0.0, f64::max).sqrt()
    }

    /// The `count` blocks with the largest differences, largest first.
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
        let (noise_variance, freedom) = match differences.noise {
            Noise::Variances(variances) => {
                let sum: f64 = pixels().map(|pixel| variances[pixel][channel]).sum();
                let squares: f64 = pixels().map(|pixel| variances[pixel][channel].powi(2)).sum();
                // If v is a pixel's true variance, E sum^2 = (sum of v)^2 + 2 (sum of v^2) and E squares = 3 (sum of
                // v^2). So this is an unbiased estimate of (sum of v)^2 / (sum of v^2), which is 1 if a single pixel
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
        // The rare paths are a guess, so they add no degrees of freedom.
        let variance = noise_variance + (differences.rare / count).powi(2);
        let total = variance + known;
        means[channel] = mean;
        if total > 0.0 {
            // Known variance has infinitely many degrees of freedom (Welch and Satterthwaite).
            let freedom = freedom * (total / variance.max(1e-9 * total)).powi(2);
            z[channel] = from_student(mean / total.sqrt(), freedom);
            noise_share[channel] = Some(noise_variance / total);
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
mod tests;
