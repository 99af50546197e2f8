//! Analyses the noise of a picture: its number of samples, whether something has altered the picture since, and whether
//! all pixels share their random numbers.

use super::Mine;
use super::hypothesis::{Compared, Hypothesis, Mistake, blocks_of, pixels_of};
use super::tracer::Tracer;
use super::written::Seen;
use crate::numbers::statistics::blocks::Block;
use std::collections::HashSet;

/// Ratio of differences two pixels apart to those one pixel apart, squared, above which noise has been smoothed. It is 1
/// for independent pixels, and 4 for a slope.
const SMOOTHED: f64 = 1.25;

/// JPEG compresses blocks of 8 x 8 pixels separately. Differences across their borders exceed those across any other
/// eighth column and row by this factor.
const SQUARES: f64 = 1.15;

/// Maximum number of colours in a palette, and how many times as many our picture must have.
const PALETTE: [usize; 2] = [256, 4];

/// The grain of a picture, compared with the right one.
#[derive(Clone, Copy, Debug)]
pub struct Grain {
    /// Samples per pixel that give such noise.
    pub samples: f64,
    /// Why the file did not come straight from a ray tracer.
    pub altered: Option<&'static str>,
}

/// The part of a difference that noise makes.
struct Field {
    /// Sums over the noisy blocks: of squared means, of squared differences of neighbours one and two pixels apart, and
    /// of squared spreads; each over the number of terms.
    means: f64,
    near: f64,
    far: f64,
    /// How evenly the means are spread over the blocks, relative to the noise there: the median of their squares over
    /// the average.
    evenness: f64,
}

/// Blocks of a rendered picture with noise, and the variance of a sample there.
fn noisy(right: &Compared) -> Vec<(Block, [f64; 3])> {
    let samples = right.rendered.samples as f64;
    let [a, b] = &right.rendered.halves;
    let half = |(a, b): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|c| 0.5 * (a[c] - b[c]));
    let values: Vec<[f64; 3]> = a.iter().zip(b).map(half).collect();
    let width = right.hypothesis.size()[0];
    let variance = |block: &Block| {
        let pixels = || pixels_of(block, width as usize);
        let count = pixels().count() as f64;
        [0, 1, 2].map(|c| samples * pixels().map(|p| values[p][c] * values[p][c]).sum::<f64>() / count)
    };
    let of = |block: Block| {
        let variance = variance(&block);
        (block, variance)
    };
    let mut found: Vec<(Block, [f64; 3])> = blocks_of(width, values.len()).into_iter().map(of).collect();
    found.retain(|(_, variance)| variance.iter().sum::<f64>() > 3e-3);
    found
}

fn field(blocks: &[(Block, [f64; 3])], width: usize, value: impl Fn(usize, usize) -> f64) -> Field {
    let (mut means, mut near, mut far, mut count) = (0.0, 0.0, 0.0, 0.0);
    let mut relatives = Vec::new();
    for (block, variance) in blocks {
        for (channel, variance) in variance.iter().enumerate() {
            let value = |x: u32, y: u32| value(y as usize * width + x as usize, channel);
            let pixels = || block.y.clone().flat_map(|y| block.x.clone().map(move |x| (x, y)));
            let number = pixels().count() as f64;
            let mean = pixels().map(|(x, y)| value(x, y)).sum::<f64>() / number;
            let apart = |by: u32| {
                let inside = pixels().filter(|(x, _)| x + 2 < block.x.end);
                inside.map(|(x, y)| (value(x + by, y) - value(x, y)).powi(2)).sum::<f64>() / number
            };
            let (one, two) = (apart(1), apart(2));
            if !(mean + one + two).is_finite() {
                continue;
            }
            means += mean * mean;
            near += one;
            far += two;
            count += 1.0;
            relatives.push(mean * mean / variance.max(1e-6));
        }
    }
    let count: f64 = f64::max(count, 1.0);
    relatives.sort_by(f64::total_cmp);
    let median = relatives.get(relatives.len() / 2).copied().unwrap_or_default();
    Field {
        means: means / count,
        near: near / count,
        far: far / count,
        evenness: median * count / relatives.iter().sum::<f64>().max(1e-30),
    }
}

/// The grain of the reader's picture; `None` if the closest picture has no noise.
pub fn grain(mine: &Mine, seen: &Seen, right: &Compared) -> Option<Grain> {
    let blocks = noisy(right);
    if blocks.len() < 8 {
        return None;
    }
    let width = seen.size[0] as usize;
    let mean = right.rendered.mean();
    let found = field(&blocks, width, |pixel, channel| {
        let value = seen.values[pixel][channel];
        // A value at the top of its range is only a bound.
        if value > 0.98 { f64::NAN } else { value - mean[pixel][channel] }
    });
    let single = blocks.iter().map(|(_, variance)| variance.iter().sum::<f64>() / 3.0).sum::<f64>()
        / blocks.len() as f64;
    // The difference of two independent pixels has twice the variance; three quarters of the pixels have a neighbour two
    // pixels to the right.
    let own = 2.0 * 0.75 * single / right.rendered.samples as f64;
    let [near, far] = [found.near - own, found.far - own];
    let altered = if has_squares(mine) {
        Some("it has the blocks of JPEG")
    } else if has_palette(mine, &right.hypothesis.written.bytes_of(&mean, right.hypothesis.size())) {
        Some("it has a palette of few colours")
    } else if far > SMOOTHED * near.max(0.1 * own) {
        Some("its noise has been smoothed")
    } else {
        None
    };
    Some(Grain { samples: 2.0 * 0.75 * single / near.max(1e-9), altered })
}

/// Whether pixels differ most at the borders of squares of 8 x 8.
fn has_squares(mine: &Mine) -> bool {
    let [width, rows] = [mine.width as usize, mine.rows as usize];
    let is_most_at_borders = |[right, down]: [usize; 2]| {
        let (mut sums, mut counts) = ([0_u64; 8], [1_u64; 8]);
        for y in 0..rows.saturating_sub(down) {
            for x in 0..width - right {
                let [from, to] = [y * width + x, (y + down) * width + x + right].map(|at| mine.bytes[at]);
                let place = if right > 0 { x } else { y } % 8;
                sums[place] += (0..3).map(|c| u64::from(from[c].abs_diff(to[c]).min(24))).sum::<u64>();
                counts[place] += 1;
            }
        }
        let means: [f64; 8] = std::array::from_fn(|at| sums[at] as f64 / counts[at] as f64);
        means[7] > SQUARES * means[..7].iter().copied().fold(0.0, f64::max)
    };
    is_most_at_borders([1, 0]) && is_most_at_borders([0, 1])
}

fn has_palette(mine: &Mine, ours: &[[u8; 3]]) -> bool {
    let [most, times] = PALETTE;
    let colours = |bytes: &[[u8; 3]]| bytes.iter().collect::<HashSet<_>>().len();
    let found = colours(&mine.bytes);
    found <= most && colours(ours) > times * found
}

/// Number of pictures with shared random numbers that the reader's is compared with.
const REALISATIONS: u32 = 4;

/// Largest excess over the realisations: more samples have less noise, so the steps of bytes show.
const LIKE: f64 = 2.2;

/// Whether the reader's picture differs from the right one as if its pixels shared random numbers. Each generator gives
/// a different picture, so only the smoothness of the difference and how evenly it is spread are compared.
pub fn is_shared(seen: &Seen, right: &Compared, mistake: &'static Mistake) -> bool {
    let blocks = noisy(right);
    if blocks.len() < 8 {
        return false;
    }
    let Some(Hypothesis { recipe, steps: Some(steps), .. }) =
        mistake.pictures(&right.hypothesis.recipe).pop()
    else {
        return false;
    };
    let (width, mean) = (seen.size[0] as usize, right.rendered.mean());
    let mine = field(&blocks, width, |pixel, channel| seen.values[pixel][channel] - mean[pixel][channel]);
    let tracer = Tracer::new(&recipe, steps, 1);
    let mut mask = vec![false; mean.len()];
    blocks.iter().for_each(|(block, _)| pixels_of(block, width).for_each(|pixel| mask[pixel] = true));
    let others: Vec<Field> = (0..REALISATIONS)
        .map(|number| {
            let made = tracer.means(12, number, Some(&mask));
            field(&blocks, width, |pixel, channel| made[pixel][channel] - mean[pixel][channel])
        })
        .collect();
    let is_within = |of: fn(&Field) -> f64| {
        let least = others.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = others.iter().map(of).fold(0.0, f64::max);
        (0.6 * least..=LIKE * most).contains(&of(&mine))
    };
    is_within(|field| field.near / field.means) && is_within(|field| field.evenness)
}
