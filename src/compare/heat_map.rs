//! Where two pictures differ, as a picture.

use super::side::Side;
use super::verdict::differs_in_kind;
use crate::heat::HeatScale;
use crate::statistics::blocks::BlockTest;
use image::{ImageFormat, RgbImage};
use std::io::{self, Seek, Write};

/// Blocks that are framed.
const FRAMED: usize = 5;

/// What frames are drawn in: a colour that the map has not.
const FRAME: [u8; 3] = [0, 220, 255];

/// Writes a PNG: each pixel's difference, root of the mean square of its channels, from dark (1e-4) to bright (1),
/// with frames around the blocks that are farthest off. Pixels that are a number in one picture alone, or
/// another kind of none, are as bright as any; others that could not be compared are black.
pub(super) fn write(
    a: &Side,
    b: &Side,
    test: &BlockTest,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let mut image = RgbImage::from_fn(a.width, a.height, |x, y| {
        let pixel = (y * a.width + x) as usize;
        let squares: f64 = (0..3).map(|i| (b.pixels[pixel][i] - a.pixels[pixel][i]).powi(2)).sum();
        let difference = match differs_in_kind(a, b, pixel) {
            true => f64::INFINITY,
            false if squares.is_nan() => 0.0,
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
