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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::{Stage, Transfer};

    fn right(transfer: Transfer) -> Hypothesis {
        let mut recipe = Stage::find("sky").unwrap().recipe();
        recipe.rules.transfer = transfer;
        Hypothesis::right(&recipe)
    }

    /// Compares bytes with linear values; both are functions of column and row.
    fn compared(
        [width, height]: [u32; 2],
        transfer: Transfer,
        bytes: impl Fn(u32, u32) -> [u8; 3],
        linear: impl Fn(u32, u32) -> [f64; 3],
    ) -> Compared {
        let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let bytes = places().map(|(x, y)| bytes(x, y)).collect();
        let pixels = places().map(|(x, y)| linear(x, y)).collect();
        let mine = Mine { width, height, bytes, format: "P3", damages: Vec::new() };
        compare(&mine, right(transfer), Expected { pixels })
    }

    fn misfit(bytes: impl Fn(u32, u32) -> [u8; 3], linear: impl Fn(u32, u32) -> [f64; 3]) -> f64 {
        compared([16, 8], Transfer::Linear, bytes, linear).misfit
    }

    #[test]
    fn the_misfit_is_the_squared_error_beyond_noise_as_it_is_displayed() {
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        let middle = |byte: f64| (byte + 0.5) / 256.0;
        close(misfit(|_, _| [153; 3], |_, _| [0.5; 3]), (middle(153.0) - 0.5).powi(2) / 2.0);
        // In the dark, errors count as at 0.02.
        close(misfit(|_, _| [2; 3], |_, _| [0.01; 3]), (middle(2.0) - 0.01).powi(2) / 0.08);
        // Noise of a block is what its pixels are apart; the mean of 64 pixels has a 64th of its variance.
        let chequers = |x: u32, y: u32| [[140, 160][((x + y) % 2) as usize]; 3];
        let (mean, apart) = (middle(150.0) - 0.5, 10.0_f64 / 256.0);
        close(misfit(chequers, |_, _| [0.5; 3]), (mean * mean - apart * apart / 63.0) / 2.0);
        // Two blocks of 8 columns, and three channels.
        let linear = |x: u32| if x < 8 { [0.25, 0.5, 0.125] } else { [0.75, 0.0625, 0.5] };
        let bytes = |x: u32| -> [u8; 3] { if x < 8 { [80, 120, 40] } else { [200, 10, 130] } };
        let part = |x: u32, channel: usize| {
            let expected = linear(x)[channel];
            (middle(f64::from(bytes(x)[channel])) - expected).powi(2) / (4.0 * expected)
        };
        let all: f64 = [0, 8].into_iter().flat_map(|x| (0..3).map(move |c| part(x, c))).sum();
        close(misfit(|x, _| bytes(x), |x, _| linear(x)), all / 6.0);
        // What is brighter or darker than bytes can tell is no error.
        close(misfit(|_, _| [255, 0, 255], |_, _| [2.0, 0.0, 1.0]), 0.0);
    }

    #[test]
    fn each_row_has_its_own_curve() {
        let bytes = |_: u32, y: u32| if y < 8 { [64; 3] } else { [128; 3] };
        let found = compared([16, 16], Transfer::LinearAboveGamma2, bytes, |_, _| [0.25; 3]);
        assert!(found.misfit < 1e-5 && found.is_noise, "{}", found.misfit);
    }
}
