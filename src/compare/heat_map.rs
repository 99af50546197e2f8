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
}
