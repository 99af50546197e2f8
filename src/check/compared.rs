//! My picture next to that of a hypothesis, block by block.

use super::hypothesis::{Expected, Hypothesis};
use super::picture::Mine;
use crate::statistics::blocks::{BlockTest, Differences, Noise};

/// By how many deviations the sum of squares of a right picture may differ. Noise alone stays below 4; the rest is for
/// random numbers that are not quite independent and noise that is far from normal.
const EXCESS_LIMIT: f64 = 10.0;

/// By what factor a block of a right picture may exceed the limit for normal noise.
const LARGEST_FACTOR: f64 = 1.6;

/// A picture that was compared with a hypothesis.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The hypothesis.
    pub hypothesis: Hypothesis,
    /// Mean squared error beyond noise, of blocks as they are displayed.
    pub misfit: f64,
    /// Whether the rest is noise.
    pub is_noise: bool,
    /// The rendered picture.
    pub expected: Expected,
}

/// Compares a picture with a hypothesis.
pub fn compare(mine: &Mine, hypothesis: Hypothesis, expected: Expected) -> Compared {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let mut values = Vec::with_capacity(mine.bytes.len());
    let mut steps = Vec::with_capacity(mine.bytes.len());
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&expected.pixels).enumerate() {
        let row = index / width;
        let [least, most] = [0, 255].map(|byte| hypothesis.linear(byte, row, height)[0]);
        let (mut value, mut step) = ([0.0; 3], [0.0; 3]);
        for channel in 0..3 {
            let [linear, half_step] = hypothesis.linear(bytes[channel], row, height);
            value[channel] = linear - expected[channel].clamp(least, most);
            step[channel] = half_step;
        }
        values.push(value);
        steps.push(step);
    }
    let test = BlockTest::of(&Differences {
        width: mine.width,
        values: &values,
        noise: Noise::Spread,
        steps: Some(&steps),
        tolerance: 1e-4,
        rare: 0.0,
    });
    let is_noise =
        test.largest_excess() <= EXCESS_LIMIT && test.largest <= LARGEST_FACTOR * test.largest_limit;
    let misfit = misfit(&test, &values, &expected, width);
    Compared { hypothesis, misfit, is_noise, expected }
}

/// Mean over blocks and channels of the squared error beyond noise, as displayed.
fn misfit(test: &BlockTest, values: &[[f64; 3]], expected: &Expected, width: usize) -> f64 {
    let mut sum = 0.0;
    for block in &test.blocks {
        let pixels =
            || block.y.clone().flat_map(|y| block.x.clone().map(move |x| y as usize * width + x as usize));
        let count = pixels().count() as f64;
        for (channel, mean) in block.means.into_iter().enumerate() {
            let bright = pixels().map(|pixel| expected.pixels[pixel][channel]).sum::<f64>() / count;
            let spread: f64 = pixels().map(|pixel| (values[pixel][channel] - mean).powi(2)).sum();
            let noise = spread / (count * (count - 1.0).max(1.0));
            // The derivative of the square root takes linear errors to displayed ones.
            sum += (mean * mean - noise) / (4.0 * bright.max(0.02));
        }
    }
    sum / (3 * test.blocks.len().max(1)) as f64
}
