//! Mistakes that show in the bytes or the noise of a picture, compared with the right one.

use super::Mine;
use super::hypothesis::Compared;

/// Whether nearly all bytes are 0 or 255, though the picture should have values in between. Converting to an integer
/// too early turns dark values into 0 but never into 255.
pub fn is_truncated(mine: &Mine, right: &Compared) -> bool {
    let ours = right.hypothesis.written.bytes_of(&right.expected, [mine.width, mine.height]);
    let (mine, ours) = (mine.bytes.as_flattened(), ours.as_flattened());
    let ends = |bytes: &[u8]| bytes.iter().filter(|byte| **byte <= 1 || **byte >= 254).count();
    let too_bright = mine.iter().zip(ours).filter(|(mine, ours)| **mine >= 254 && **ours < 128).count();
    let all = mine.len();
    !right.is_noise && 100 * ends(mine) >= 99 * all && 2 * ends(ours) < all && 100 * too_bright <= all
}

/// Whether bytes were scaled by 255 instead of 256 and truncated: all values are then smaller by 1/256.
pub fn is_times_255(mine: &Mine, right: &Compared) -> bool {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let written = &right.hypothesis.written;
    // Noise is unbiased in linear values, so the loss is fitted there.
    let (mut product, mut square, mut scaled, mut count) = (0.0, 0.0, 0.0, 0);
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&right.expected).enumerate() {
        let row = index / width;
        for (byte, x) in bytes.iter().copied().zip(expected.iter().copied()) {
            // At the upper end, 255 is a bound, not a value.
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
    mine.most == 255
        && right.is_noise
        && count >= 1000
        && (slope - 1.0).abs() < 0.4
        && slope > 6.0 * deviation
}

/// Whether the difference looks like noise that neighbouring pixels share: as large everywhere as that of some number of
/// samples, but smooth. `single` is a picture of one sample a pixel.
pub fn is_same_seed(mine: &Mine, right: &Compared, single: &[[f64; 3]]) -> bool {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let (mut means, mut spreads, mut singles, mut ratios) = (0.0, 0.0, 0.0, Vec::new());
    let corners = (0..height / 8).flat_map(|y| (0..width / 8).map(move |x| (8 * x, 8 * y)));
    for ((left, top), channel) in corners.flat_map(|corner| (0..3).map(move |channel| (corner, channel))) {
        // Mean square of the block's mean, and variance within the block.
        let moments = |value: &dyn Fn(usize) -> f64| {
            let places = (0..64).map(|place| (top + place / 8) * width + left + place % 8);
            let (sum, squares) =
                places.map(value).fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
            [(sum / 64.0).powi(2), squares / 64.0 - (sum / 64.0).powi(2)]
        };
        let [mean, spread] = moments(&|index| {
            let [linear, _] =
                right.hypothesis.written.linear(mine.bytes[index][channel], index / width, height);
            linear - right.expected[index][channel]
        });
        let [_, noise] = moments(&|index| single[index][channel] - right.expected[index][channel]);
        (means, spreads, singles) = (means + mean, spreads + spread, singles + noise);
        ratios.push((noise, mean));
    }
    // The samples that give noise of this size.
    let samples = singles / means;
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let noisy = &ratios[ratios.len() / 2..];
    let average = noisy.iter().map(|(noise, mean)| mean / noise).sum::<f64>() / noisy.len().max(1) as f64;
    let usual = noisy.iter().filter(|(noise, mean)| *mean > 0.25 * average * noise).count();
    // Blocks of independent pixels have a spread of 64 times the square of their mean.
    (4.0..1e4).contains(&samples) && spreads < 4.0 * means && 2 * usual > noisy.len()
}
