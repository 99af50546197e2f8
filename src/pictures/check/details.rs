//! Mistakes that the means of blocks cannot show: at edges, pixel by pixel, and in the bytes.

use super::Mine;
use super::hypothesis::{Compared, Studio, compare};
use super::mistakes::Mistake;
use anyhow::Result;

/// Least difference of a pixel's neighbours at an edge, linear radiance.
const EDGE: f64 = 0.1;

/// A mistake must leave less than this part of the squared error at edges.
const BETTER: f64 = 0.8;

/// Decides pixel by pixel among the right picture and those that differ from it at edges only.
pub fn at_edges(
    mine: &Mine,
    studio: &mut Studio,
    right: &Compared,
    samples: u64,
) -> Result<Option<Compared>> {
    let recipe = studio.recipe().clone();
    let mistakes = Mistake::applying_to(&recipe).filter(|mistake| mistake.is_at_edges());
    let edges = edges(&right.expected, [mine.width as usize, mine.height as usize]);
    let error = |expected: &[[f64; 3]]| -> f64 {
        let square = |(index, channel): &(usize, usize)| {
            let row = index / mine.width as usize;
            let byte = mine.bytes[*index][*channel];
            let [linear, _] = right.hypothesis.written.linear(byte, row, mine.height as usize);
            (linear - expected[*index][*channel]).powi(2)
        };
        edges.iter().map(square).sum()
    };
    let mut best = (BETTER * error(&right.expected), None);
    for hypothesis in mistakes.flat_map(|mistake| mistake.pictures(&recipe)) {
        let expected = studio.render(&hypothesis, samples)?;
        let error = error(&expected);
        if error < best.0 {
            best = (error, Some((hypothesis, expected)));
        }
    }
    Ok(best.1.map(|(hypothesis, expected)| compare(mine, hypothesis, expected)))
}

/// Pixels and channels with an edge.
fn edges(expected: &[[f64; 3]], [width, height]: [usize; 2]) -> Vec<(usize, usize)> {
    let inside = |index: &usize| {
        let (column, row) = (index % width, index / width);
        column > 0 && row > 0 && column + 1 < width && row + 1 < height
    };
    let is_edge = |(index, channel): &(usize, usize)| {
        let step = |by: usize| (expected[index + by][*channel] - expected[index - by][*channel]).abs();
        step(1).max(step(width)) >= EDGE
    };
    let places = (0..expected.len()).filter(inside).flat_map(|index| (0..3).map(move |c| (index, c)));
    places.filter(is_edge).collect()
}

/// Whether nearly all bytes are 0 or 255, though the picture should have values between. Cutting turns dark values into
/// 0, but none of them into 255.
pub fn is_truncated(mine: &Mine, right: &Compared) -> bool {
    let is_end = |byte: u8| byte <= 1 || byte >= 254;
    let should_be = right.hypothesis.written.bytes_of(&right.expected, [mine.width, mine.height]);
    let bytes = || mine.bytes.iter().flatten().copied().zip(should_be.iter().flatten().copied());
    let count = |is_so: &dyn Fn(u8, u8) -> bool| bytes().filter(|(mine, ours)| is_so(*mine, *ours)).count();
    let all = bytes().count();
    let ends = count(&|mine, _| is_end(mine));
    let expected_ends = count(&|_, ours| is_end(ours));
    let too_bright = count(&|mine, ours| mine >= 254 && ours < 128);
    !right.is_noise && 100 * ends >= 99 * all && 2 * expected_ends < all && 100 * too_bright <= all
}

/// Whether bytes are 255 times the value instead of 256 times, cut off: values are then smaller by 1/256 everywhere.
pub fn is_times_255(mine: &Mine, right: &Compared) -> bool {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let written = &right.hypothesis.written;
    // Noise is without bias in linear values, so the loss is fitted there.
    let (mut product, mut square, mut scaled, mut count) = (0.0, 0.0, 0.0, 0);
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&right.expected).enumerate() {
        let row = index / width;
        for (byte, x) in bytes.iter().copied().zip(expected.iter().copied()) {
            // At the upper end, 255 is a limit and not a value.
            if byte >= 254 || !(0.05..=0.98).contains(&x) {
                continue;
            }
            let [linear, _] = written.linear(byte, row, height);
            let loss = x - written.times_255(x, row, height);
            product += (linear - x) * loss;
            square += loss * loss;
            scaled += (linear - x).powi(2) * loss * loss;
            count += 1;
        }
    }
    let (slope, deviation) = (-product / square, scaled.sqrt() / square);
    right.is_noise && count >= 1000 && (slope - 1.0).abs() < 0.4 && slope > 6.0 * deviation
}
