//! What noise says besides the number of samples: whether something has changed the file since it was written, and whether
//! all pixels share their random numbers.

use super::Mine;
use super::fit::Compared;
use super::hypothesis::Hypothesis;
use super::tracer::Tracer;
use super::written::Seen;
use glam::DVec2;
use std::collections::HashSet;
use std::sync::atomic::AtomicBool;

/// Side of a block, pixels; that of JPEG.
const SIDE: usize = 8;

/// Differences across the borders of JPEG's blocks exceed those across any other eighth column and row by this factor.
const SQUARES: f64 = 1.15;

/// The most colours of a palette, and the fewest pixels of each.
const PALETTE: [usize; 2] = [256, 100];

/// Correlation of a pixel's second differences with those of the next one: -2/3 for independent noise, more if it was
/// smoothed. Blocks count whose second differences exceed this, in bytes.
const SMOOTHED: f64 = -0.4;
const NOISY: f64 = 4.0;

/// What seems to have changed a file since it was written.
pub fn altered(mine: &Mine) -> Option<&'static str> {
    if mine.bytes.iter().collect::<HashSet<_>>().len() <= PALETTE[0] && is_grainy(mine) {
        return Some("it has a palette of few colours");
    }
    if has_squares(mine) {
        return Some("it has the blocks of JPEG");
    }
    is_smoothed(mine).then_some("its noise has been smoothed, as by a filter or by scaling")
}

/// Whether neighbours differ often, though there are few colours.
fn is_grainy(mine: &Mine) -> bool {
    let differing = mine.bytes.windows(2).filter(|pair| pair[0] != pair[1]).count();
    4 * differing > mine.bytes.len() && mine.bytes.len() > PALETTE[0] * PALETTE[1]
}

/// Whether pixels differ most at the borders of squares of 8 x 8.
fn has_squares(mine: &Mine) -> bool {
    let [width, rows] = [mine.width as usize, mine.rows as usize];
    let is_most_at_borders = |[right, down]: [usize; 2]| {
        let (mut sums, mut counts) = ([0_u64; SIDE], [1_u64; SIDE]);
        for y in 0..rows.saturating_sub(down) {
            for x in 0..width - right {
                let [from, to] = [y * width + x, (y + down) * width + x + right].map(|at| mine.bytes[at]);
                let place = if right > 0 { x } else { y } % SIDE;
                sums[place] += (0..3).map(|c| u64::from(from[c].abs_diff(to[c]).min(24))).sum::<u64>();
                counts[place] += 1;
            }
        }
        let means: [f64; SIDE] = std::array::from_fn(|at| sums[at] as f64 / counts[at] as f64);
        means[SIDE - 1] > SQUARES * means[..SIDE - 1].iter().copied().fold(0.0, f64::max)
    };
    is_most_at_borders([1, 0]) && is_most_at_borders([0, 1])
}

/// Whether the noise of most blocks that have any is correlated.
fn is_smoothed(mine: &Mine) -> bool {
    let width = mine.width as usize;
    let (mut smooth, mut noisy) = (0, 0);
    for y0 in (0..mine.rows as usize / SIDE).map(|y| y * SIDE) {
        for x0 in (0..width / SIDE).map(|x| x * SIDE) {
            let (mut square, mut product, mut most) = (0.0, 0.0, 0.0_f64);
            for y in y0..y0 + SIDE {
                let second = |x: usize| {
                    let at = |x: usize| f64::from(mine.bytes[y * width + x][1]);
                    at(x - 1) - 2.0 * at(x) + at(x + 1)
                };
                for x in x0 + 1..x0 + SIDE - 2 {
                    square += second(x) * second(x);
                    product += second(x) * second(x + 1);
                    most = most.max(second(x).abs());
                }
            }
            let mean = square / (SIDE * (SIDE - 3)) as f64;
            // An edge is no noise.
            if mean > NOISY * NOISY && most * most < 16.0 * mean {
                noisy += 1;
                smooth += usize::from(product > SMOOTHED * square);
            }
        }
    }
    noisy > 20 && 2 * smooth > noisy
}

/// Blocks of a rendered picture where a sample's variance exceeds this, linear.
const VARIANCE_LEAST: f64 = 3e-3;

/// Number of pictures with shared random numbers that the reader's is compared with.
const REALISATIONS: u32 = 4;

/// How far the reader's smoothness and evenness may be from theirs. Paths of different lengths draw different numbers of random
/// numbers, so neighbours fall out of step and differ more; with independent noise, the smoothness is about 100.
const LIKE: [[f64; 2]; 2] = [[0.3, 8.0], [0.6, 2.2]];

/// How smooth the difference of a picture from ours is, and how evenly it is spread: each a ratio, in noisy blocks. The two halves
/// of ours have independent noise, so that it adds nothing.
fn texture(right: &Compared, width: usize, value: impl Fn(usize, usize) -> f64) -> [f64; 2] {
    let (mut means, mut near, mut relatives) = (0.0, 0.0, Vec::new());
    let height = right.rendered.variance.len() / width;
    for y0 in (0..height / SIDE).map(|y| y * SIDE) {
        for x0 in (0..width / SIDE).map(|x| x * SIDE) {
            for channel in 0..3 {
                let left = |pixel: usize| {
                    let of = |half: &Vec<[f64; 3]>| value(pixel, channel) - half[pixel][channel];
                    DVec2::from(right.rendered.halves.each_ref().map(of))
                };
                let (mut sum, mut noise, mut apart) = (DVec2::ZERO, 0.0, 0.0);
                for y in y0..y0 + SIDE {
                    for x in x0..x0 + SIDE {
                        let pixel = y * width + x;
                        sum += left(pixel);
                        noise += right.rendered.variance[pixel][channel];
                        if x + 1 < x0 + SIDE {
                            apart += (left(pixel + 1) - left(pixel)).element_product();
                        }
                    }
                }
                let count = (SIDE * SIDE) as f64;
                let square = sum.element_product() / (count * count);
                if noise / count > VARIANCE_LEAST / 3.0 && (square + apart).is_finite() {
                    means += square;
                    near += apart / count;
                    relatives.push(square * count / noise);
                }
            }
        }
    }
    if relatives.len() < 24 {
        return [f64::NAN; 2];
    }
    relatives.sort_by(f64::total_cmp);
    let average = relatives.iter().sum::<f64>() / relatives.len() as f64;
    [near / means, relatives[relatives.len() / 2] / average]
}

/// Whether the reader's picture differs from the right one as if its pixels shared random numbers, as `shared` has them. Each
/// generator gives a different picture, so only the texture of the difference is compared.
pub fn is_shared(seen: &Seen, right: &Compared, shared: &Hypothesis, stop: &AtomicBool) -> bool {
    let Some(steps) = shared.steps else { return false };
    let width = seen.size[0] as usize;
    let mine = texture(right, width, |pixel, channel| seen.values[pixel][channel]);
    let tracer = Tracer::new(&shared.recipe, steps, &shared.viewport, 1);
    let others: Vec<[f64; 2]> = (0..REALISATIONS)
        .map(|number| {
            let made = tracer.moments(12 * number..12 * (number + 1), None, stop);
            texture(right, width, |pixel, channel| made[pixel][0][channel])
        })
        .collect();
    (0..2).all(|index| {
        let all = others.iter().map(|other| other[index]);
        let [least, most] = all.fold([f64::INFINITY, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
        (LIKE[index][0] * least..=LIKE[index][1] * most).contains(&mine[index])
    })
}
