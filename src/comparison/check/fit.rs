//! The one question that a check asks: could this picture have come from this hypothesis, with some number of samples?
//!
//! A byte has an expected value and a variance: both follow from mean and variance of one sample, the number of samples,
//! and rounding. The number of samples is fitted to the differences of neighbours. What is left must then be white in
//! blocks of four sizes, and lead nowhere.

use super::hypothesis::{Hypothesis, Rendered};
use super::written::{Levels, Seen, Written};
use rayon::prelude::*;

/// Deviations by which what is left may exceed noise. Of right pictures none exceeded 7, and of wrong ones none stayed below
/// 9.
pub const SCORE_LIMIT: f64 = 8.0;

/// Sides of the blocks, pixels.
const SIDES: [usize; 4] = [4, 8, 16, 32];

/// Side of the blocks that tell where a picture differs.
const PLACE: usize = 8;

/// A block of [`PLACE`] differs if its channels' squares exceed this, in squared deviations.
const DIFFERS: f64 = 40.0;

/// The most that a single block counts, in squared deviations: rare paths are not in every render.
const MOST: f64 = 40.0;

/// The most of a block's excess that counts, in squared bytes.
const EXCESS_MOST: f64 = 10_000.0;

/// Bytes by which the mean of a block may be off.
const TOLERANCE: f64 = 0.03;

/// Variance that every byte has, such as rounding of another kind.
const VARIANCE: f64 = 1e-3;

/// The largest number of samples that noise can tell.
const SAMPLES_MOST: f64 = 20_000.0;

/// Slopes this many deviations from 0 are no chance.
const SLOPE_DEVIATIONS: f64 = 6.0;

/// The reader's picture compared with a hypothesis.
#[derive(Clone, Debug)]
pub struct Compared {
    pub hypothesis: Hypothesis,
    pub rendered: Rendered,
    pub fit: Fit,
}

/// How a picture fits a hypothesis. All errors are in bytes.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The reader's samples per pixel; `None` if no noise tells.
    pub samples: Option<f64>,
    /// Deviations by which what is left exceeds noise, in blocks of the worst size.
    pub score: f64,
    /// Where what is left leads: pixels to the right and down, squared pixels of blur, and a share of brightness; 0 unless
    /// it is no chance.
    pub slopes: [f64; 4],
    /// Mean square beyond noise of the means of blocks.
    pub excess: f64,
    /// Share of the blocks that differ by more than noise.
    pub differing: f64,
    /// The middle of each of these blocks, the worst first: column and row.
    pub places: Vec<[u32; 2]>,
    /// The residual of each pixel and its variance; NaN where it is not known.
    pub left: Vec<[f64; 3]>,
    pub variance: Vec<[f64; 3]>,
    /// Linear radiance by which what is left is divided: about that of one byte.
    pub steps: Vec<[f64; 3]>,
}

impl Fit {
    /// Whether the hypothesis alone explains the picture.
    pub fn is_enough(&self) -> bool {
        self.score < limit_of(self.samples) && self.slopes == [0.0; 4]
    }

    /// The sums of a picture's pixels over blocks that are known.
    pub fn in_blocks(&self, seen: &Seen, pixels: &[[f64; 3]]) -> Vec<f64> {
        let [width, height] = seen.size.map(|side| side as usize);
        let mut sums = vec![0.0; (width / PLACE) * (height / PLACE) * 3];
        for (pixel, value) in pixels.iter().enumerate() {
            let (x, y) = (pixel % width / PLACE, pixel / width / PLACE);
            if x >= width / PLACE || y >= height / PLACE {
                continue;
            }
            for channel in 0..3 {
                sums[3 * (y * (width / PLACE) + x) + channel] +=
                    value[channel] + 0.0 * self.left[pixel][channel];
            }
        }
        sums
    }

    pub fn new(seen: &Seen, written: &Written, rendered: &Rendered) -> Fit {
        let mean = rendered.mean();
        // Rare light in the dark would count too much if it were measured by the darkness.
        let steps_of = |samples: f64| {
            by_row(seen, written, |levels, pixel| {
                let rare = rendered.variance[pixel].map(|variance| 2.0 * (variance / samples).sqrt());
                [0, 1, 2].map(|channel| levels.step(mean[pixel][channel] + rare[channel]))
            })
        };
        let mut steps = steps_of(100.0);
        let mut samples = samples_of(seen, &mean, &steps, rendered);
        if let Some(few) = samples.filter(|samples| *samples < 50.0) {
            steps = steps_of(few);
            samples = samples_of(seen, &mean, &steps, rendered);
        }
        let of = |mean: &[[f64; 3]], times: f64| {
            by_row(seen, written, |levels, pixel| {
                [0, 1, 2].map(|channel| {
                    let (x, step) = (mean[pixel][channel], steps[pixel][channel]);
                    let noise = rendered.variance[pixel][channel] / samples.unwrap_or(SAMPLES_MOST);
                    let [expected, variance] = levels.expected(x, noise.sqrt());
                    // Where all are white, it does not matter how white.
                    let doubt = if x < levels.most() { times * rendered.error[pixel][channel] } else { 0.0 };
                    let coarse = (seen.step * seen.step - 1.0) / 12.0;
                    let left = (seen.values[pixel][channel] - expected) / step;
                    [left, (variance + doubt) / (step * step) + coarse + VARIANCE]
                })
            })
        };
        let part = |both: &[[[f64; 2]; 3]], index: usize| -> Vec<[f64; 3]> {
            both.iter().map(|pixel| pixel.map(|of| of[index])).collect()
        };
        let both = of(&mean, 1.0);
        let (left, variance) = (part(&both, 0), part(&both, 1));
        let scores = SIDES.map(|side| blocks(seen, &left, &variance, side).0.score());
        let (sums, mut worst) = blocks(seen, &left, &variance, PLACE);
        let differing = worst.len() as f64 / (sums.blocks as f64).max(1.0);
        worst.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let score = scores.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let slopes = if score < limit_of(samples) {
            let halves = [0, 1].map(|half| part(&of(&rendered.halves[half], 2.0), 0));
            slopes(seen, rendered, &steps, &halves, &variance)
        } else {
            [0.0; 4]
        };
        Fit {
            samples,
            score,
            slopes,
            excess: if sums.count > 0.0 { sums.excess / sums.count } else { f64::INFINITY },
            differing,
            places: worst.into_iter().map(|(_, place)| place).collect(),
            left,
            variance,
            steps,
        }
    }
}

/// The limit of the score: with few samples, bytes are far from normal.
fn limit_of(samples: Option<f64>) -> f64 {
    SCORE_LIMIT * (1.0 + 5.0 / samples.unwrap_or(f64::INFINITY))
}

/// Maps each pixel, with the levels of its row.
fn by_row<T: Send>(seen: &Seen, written: &Written, of: impl Fn(&Levels, usize) -> T + Sync) -> Vec<T> {
    let [width, height] = seen.size.map(|side| side as usize);
    let rows = (0..height).into_par_iter().flat_map_iter(|row| {
        let (levels, of) = (Levels::new(written, row, height), &of);
        (row * width..(row + 1) * width).map(move |pixel| of(&levels, pixel))
    });
    rows.collect()
}

/// The reader's samples per pixel, from the differences of neighbours.
fn samples_of(seen: &Seen, mean: &[[f64; 3]], steps: &[[f64; 3]], rendered: &Rendered) -> Option<f64> {
    /// Pairs with noise of less than this many squared bytes tell little, as do fewer pairs than this.
    const NOISE_LEAST: f64 = 1.0;
    const PAIRS_LEAST: usize = 200;
    /// A pair that differs by more, in squared deviations, shows an edge that is elsewhere.
    const EDGE: f64 = 60.0;
    let width = seen.size[0] as usize;
    let rounding = 2.0 * seen.step * seen.step / 12.0;
    let mut pairs = Vec::new();
    for pixel in 0..mean.len().saturating_sub(width) {
        for other in [pixel + 1, pixel + width] {
            if other == pixel + 1 && other % width == 0 {
                continue;
            }
            for channel in 0..3 {
                let (a, b) = (seen.values[pixel][channel], seen.values[other][channel]);
                if a.max(b) >= 0.99 || (a + b).is_nan() {
                    continue;
                }
                let squares = [pixel, other].map(|at| steps[at][channel].powi(2));
                let of = |of: &[[f64; 3]]| of[pixel][channel] / squares[0] + of[other][channel] / squares[1];
                let [left, right] = [pixel, other]
                    .map(|at| (seen.values[at][channel] - mean[at][channel]) / steps[at][channel]);
                pairs.push([(left - right).powi(2), of(&rendered.variance), of(&rendered.error) + rounding]);
            }
        }
    }
    let mut one = 0.02;
    for _ in 0..8 {
        let (mut squares, mut noise, mut count) = (0.0, 0.0, 0);
        for [square, sample, own] in &pairs {
            let expected = sample * one + own;
            if expected > NOISE_LEAST && *square < EDGE * expected {
                squares += (square - own) / expected;
                noise += sample / expected;
                count += 1;
            }
        }
        if count < PAIRS_LEAST {
            return None;
        }
        one = (squares / noise).clamp(1.0 / SAMPLES_MOST, 1.0);
    }
    Some(1.0 / one)
}

#[derive(Default)]
struct Sums {
    squares: f64,
    excess: f64,
    count: f64,
    blocks: usize,
}

impl Sums {
    fn score(&self) -> f64 {
        if self.count == 0.0 {
            return f64::NEG_INFINITY;
        }
        (self.squares / self.count - 1.0) * (self.count / 2.0).sqrt()
    }
}

/// Sums over blocks, and the middles of those that differ, with how much.
fn blocks(
    seen: &Seen,
    left: &[[f64; 3]],
    variance: &[[f64; 3]],
    side: usize,
) -> (Sums, Vec<(f64, [u32; 2])>) {
    let [width, height] = seen.size.map(|side| side as usize);
    let (mut sums, mut worst) = (Sums::default(), Vec::new());
    for y0 in (0..height / side).map(|y| y * side) {
        for x0 in (0..width / side).map(|x| x * side) {
            let mut all = 0.0;
            for channel in 0..3 {
                let (mut sum, mut noise, mut known) = (0.0, 0.0, 0.0);
                for y in y0..y0 + side {
                    for pixel in y * width + x0..y * width + x0 + side {
                        let value = left[pixel][channel];
                        if value.is_finite() {
                            sum += value;
                            noise += variance[pixel][channel];
                            known += 1.0;
                        }
                    }
                }
                if 2.0 * known < (side * side) as f64 {
                    continue;
                }
                let noise = noise + (TOLERANCE.max(seen.tolerance) * known).powi(2);
                sums.squares += (sum * sum / noise).min(MOST);
                sums.excess += ((sum * sum - noise) / (known * known)).min(EXCESS_MOST);
                sums.count += 1.0;
                all += sum * sum / noise;
            }
            sums.blocks += 1;
            if all > DIFFERS {
                worst.push((all, [x0, y0].map(|at| (at + side / 2) as u32)));
            }
        }
    }
    (sums, worst)
}

/// Where what is left leads. The direction is that of one half of the render and the rest that of the other, or its own
/// noise would look like a blur.
fn slopes(
    seen: &Seen,
    rendered: &Rendered,
    steps: &[[f64; 3]],
    left: &[Vec<[f64; 3]>; 2],
    variance: &[[f64; 3]],
) -> [f64; 4] {
    /// The least slopes that matter.
    const LEAST: [f64; 4] = [0.06, 0.06, 0.03, 0.003];
    let [width, height] = seen.size.map(|side| side as usize);
    let mut sums = [[0.0; 2]; 4];
    for (half, left) in left.iter().enumerate() {
        let mean = &rendered.halves[1 - half];
        for y in 1..height.saturating_sub(1) {
            for pixel in y * width + 1..(y + 1) * width - 1 {
                for channel in 0..3 {
                    let rest = left[pixel][channel];
                    if !rest.is_finite() {
                        continue;
                    }
                    let at = |pixel: usize| mean[pixel][channel];
                    let sides = [pixel - 1, pixel + 1, pixel - width, pixel + width];
                    let [l, r, u, d] = sides.map(at);
                    let noise = sides.into_iter().chain([pixel]).map(|pixel| variance[pixel][channel]);
                    let weight = 1.0 / noise.fold(0.0, f64::max);
                    let directions =
                        [(l - r) / 2.0, (u - d) / 2.0, l + r + u + d - 4.0 * at(pixel), at(pixel)];
                    for (sum, direction) in sums.iter_mut().zip(directions) {
                        let direction = direction / steps[pixel][channel];
                        sum[0] += weight * direction * rest / 2.0;
                        sum[1] += weight * direction * direction / 2.0;
                    }
                }
            }
        }
    }
    std::array::from_fn(|index| {
        let [along, square] = sums[index];
        let slope = along / square.max(1e-9);
        // Channels share their noise.
        let deviations = along / (3.0 * square).max(1e-9).sqrt();
        if slope.abs() > LEAST[index] && deviations.abs() > SLOPE_DEVIATIONS { slope } else { 0.0 }
    })
}
