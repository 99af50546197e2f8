//! A heat map of the difference between two pictures.

use super::bounds::capped_difference;
use super::non_finite::differs_in_kind;
use super::side::Side;
use crate::heat::HeatScale;
use crate::statistics::blocks::BlockTest;
use image::{ImageFormat, RgbImage};
use std::io::{self, Seek, Write};

/// Number of blocks that are framed.
const FRAMED: usize = 5;

/// The colour of the frames, which does not occur in the map.
const FRAME: [u8; 3] = [0, 220, 255];

/// Writes a PNG of each pixel's difference, the root mean square of its channels, from dark (1e-4) to bright (1). Frames
/// mark the blocks that are farthest off. A clipped channel counts as the least value that it can have. Pixels that
/// [differ in kind](differs_in_kind) have the brightest colour; other channels that could not be compared count as equal.
pub(super) fn write(
    a: &Side,
    b: &Side,
    test: &BlockTest,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let mut image = RgbImage::from_fn(a.width, a.height, |x, y| {
        let pixel = (y * a.width + x) as usize;
        let of_channel = |channel: usize| {
            let exact = b.pixels[pixel][channel] - a.pixels[pixel][channel];
            let known = if exact.is_nan() { capped_difference(a, b, pixel, channel) } else { exact };
            if known.is_nan() { 0.0 } else { known }
        };
        let squares: f64 = (0..3).map(|channel| of_channel(channel).powi(2)).sum();
        let difference = match differs_in_kind(a, b, pixel) {
            true => f64::INFINITY,
            false => (squares / 3.0).sqrt(),
        };
        image::Rgb(HeatScale::ERROR.colour(difference))
    });
    for block in test.worst(FRAMED) {
        for y in block.y.clone() {
            for x in block.x.clone() {
                let is_edge = [block.x.start, block.x.end - 1].contains(&x)
                    || [block.y.start, block.y.end - 1].contains(&y);
                if is_edge {
                    image.put_pixel(x, y, image::Rgb(FRAME));
                }
            }
        }
    }
    image.write_to(writer, ImageFormat::Png).map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Film;
    use crate::statistics::blocks::{Differences, Noise};
    use std::io::Cursor;

    #[test]
    fn a_known_difference_has_its_colour() {
        let side = |pixels: Vec<[f64; 3]>| {
            let film = Film::new(48, 8, 1);
            Side { film: None, pixels, ..Side::of_film(String::new(), String::new(), film) }
        };
        let black = vec![[0.0; 3]; 48 * 8];
        let mut other = black.clone();
        // Blocks have 8 columns. Those that are farthest off are framed, so the test looks at pixels inside.
        other[3 * 48 + 4] = [0.01, -0.01, 0.01];
        other[3 * 48 + 12] = [0.0, 0.0, 0.01 * 3.0_f64.sqrt()];
        other[3 * 48 + 20] = [1e-4; 3];
        let noise = Noise::Spread;
        let test = BlockTest::of(&Differences {
            width: 48,
            values: &other,
            noise,
            steps: None,
            tolerance: 0.0,
            rare: 0.0,
        });
        let mut png = Cursor::new(Vec::new());
        write(&side(black), &side(other.clone()), &test, &mut png).unwrap();
        let map = image::load_from_memory(png.get_ref()).unwrap().to_rgb8();
        let colours = [4, 12, 20, 28].map(|x| map.get_pixel(x, 3).0);
        // The middle of the scale twice, and its dark end.
        assert_eq!(colours, [[159, 42, 99], [159, 42, 99], [0, 0, 4], [0, 0, 4]]);
    }

    /// A picture of floats that is grey but for some pixels.
    fn floats([width, height]: [u32; 2], others: &[(usize, f64)]) -> Side {
        let side = Side::of_film(String::new(), String::new(), Film::new(width, height, 1));
        let mut pixels = vec![[0.5; 3]; (width * height) as usize];
        others.iter().for_each(|(pixel, value)| pixels[*pixel] = [*value; 3]);
        Side { film: None, pixels, ..side }
    }

    /// The map of two pictures, with frames around the blocks that are farthest off by `values`.
    fn map(a: &Side, b: &Side, values: &[[f64; 3]]) -> RgbImage {
        let (noise, steps) = (Noise::Spread, None);
        let differences = Differences { width: a.width, values, noise, steps, tolerance: 1.0, rare: 0.0 };
        let mut png = Cursor::new(Vec::new());
        write(a, b, &BlockTest::of(&differences), &mut png).unwrap();
        image::load_from_memory(png.get_ref()).unwrap().to_rgb8()
    }

    #[test]
    fn the_five_blocks_that_are_farthest_off_have_frames_one_pixel_wide() {
        // Two rows of three blocks, of which the one in the middle of the upper row is off least.
        let off = [6.0, 1.0, 5.0, -4.0, 3.0, -2.0];
        let block = |pixel: usize| pixel / 24 / 8 * 3 + pixel % 24 / 8;
        let values: Vec<[f64; 3]> = (0..24 * 16).map(|pixel| [0.1 * off[block(pixel)]; 3]).collect();
        let grey = floats([24, 16], &[]);
        let map = map(&grey, &grey, &values);
        for (x, y, colour) in map.enumerate_pixels() {
            let is_edge = [0, 7].contains(&(x % 8)) || [0, 7].contains(&(y % 8));
            let is_framed = is_edge && block((y * 24 + x) as usize) != 1;
            assert_eq!(colour.0 == FRAME, is_framed, "{x},{y}");
        }
    }

    #[test]
    fn what_is_clipped_counts_as_the_least_that_it_can_be_and_what_is_unknown_as_equal() {
        let nan = f64::NAN;
        // Each value stands alone in the middle of a block.
        let places = [3, 11, 19, 27, 35].map(|x| 3 * 40 + x);
        let a = floats([40, 8], &[(places[0], 0.75), (places[1], 5.0), (places[2], nan), (places[4], nan)]);
        let at_end = [places[0], places[1], places[2], places[3]].map(|place| (place, nan));
        let steps = Some(vec![[0.01; 3]; 40 * 8]);
        let b = Side { steps, limit: 0.875, ..floats([40, 8], &at_end) };
        let map = map(&a, &b, &[[0.0; 3]; 40 * 8]);
        let colours = places.map(|place| map.get_pixel(place as u32 % 40, 3).0);
        let of = |difference: f64| HeatScale::ERROR.colour(difference);
        // In turn: an eighth darker than the end of the format, brighter than it, no number beside it, three eighths
        // darker, and no number beside a number.
        let kind = of(f64::INFINITY);
        assert_eq!(colours, [of(0.125), of(0.0), kind, of(0.375), kind]);
        let both = floats([40, 8], &[(places[0], nan)]);
        let map = self::map(&both, &both, &[[0.0; 3]; 40 * 8]);
        assert_eq!(map.get_pixel(3, 3).0, of(0.0), "no number in both is equal");
    }
}
