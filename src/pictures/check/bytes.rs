//! Mistakes that show in the bytes of a picture, compared with the right one.

use super::Mine;
use super::hypothesis::Compared;

/// Whether nearly all bytes are 0 or 255, though the picture should have values in between. Converting to an integer
/// too early turns dark values into 0 but never into 255.
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
