//! What the noise of a picture tells: how many samples it has, whether something has smoothed it, and whether all pixels
//! share their random numbers.

use super::hypothesis::{Compared, Hypothesis, Mistake, blocks_of, pixels_of};
use super::tracer::Tracer;
use super::written::Seen;
use crate::numbers::statistics::blocks::Block;

/// Ratio of differences two pixels apart to those one pixel apart, squared, above which noise has been smoothed. It is 1
/// for independent pixels, and 4 for a slope.
const SMOOTHED: f64 = 1.25;

/// The grain of a picture beside the right one.
#[derive(Clone, Copy, Debug)]
pub struct Grain {
    /// Samples per pixel that give such noise.
    pub samples: f64,
    /// Whether neighbouring pixels share noise.
    pub is_smoothed: bool,
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

/// The grain of what is seen, if the picture that comes closest has noise.
pub fn grain(seen: &Seen, right: &Compared) -> Option<Grain> {
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
    let spread = found.near / (2.0 * 0.75) - single / right.rendered.samples as f64;
    Some(Grain { samples: single / spread.max(1e-9), is_smoothed: found.far > SMOOTHED * found.near })
}

/// Realisations of a picture whose pixels share their random numbers, with which the reader's is compared.
const REALISATIONS: u32 = 4;

/// Largest excess over the realisations: more samples have less noise, so the steps of bytes show.
const LIKE: f64 = 2.2;

/// Whether what is seen differs from the right picture as pictures do whose pixels share random numbers: each of those
/// is another picture, so the smoothness of the difference and how evenly it is spread are compared.
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
