//! Where two pictures differ, as a picture.

use super::side::Side;
use crate::heat::HeatScale;
use crate::statistics::blocks::BlockTest;
use image::{ImageFormat, RgbImage};
use std::io::{self, Seek, Write};

/// Blocks that are framed.
const FRAMED: usize = 5;

/// What frames are drawn in: a colour that the map has not.
const FRAME: [u8; 3] = [0, 220, 255];

/// Writes a PNG: each pixel's difference, root of the mean square of its channels, from dark (1e-4) to bright (1),
/// with frames around the blocks that are farthest off. Pixels that are a number in one picture alone are as bright as
/// any; others that could not be compared are black.
pub(super) fn write(
    a: &Side,
    b: &Side,
    test: &BlockTest,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let mut image = RgbImage::from_fn(a.width, a.height, |x, y| {
        let pixel = (y * a.width + x) as usize;
        let squares: f64 = (0..3).map(|i| (b.pixels[pixel][i] - a.pixels[pixel][i]).powi(2)).sum();
        let is_number = |side: &Side| side.pixels[pixel].iter().all(|x| x.is_finite());
        let are_floats = a.steps.is_none() && b.steps.is_none();
        let difference = match (is_number(a), is_number(b)) {
            (true, true) => (squares / 3.0).sqrt(),
            (false, false) => 0.0,
            _ if are_floats => f64::INFINITY,
            _ => 0.0,
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
