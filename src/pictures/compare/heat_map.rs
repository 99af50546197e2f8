//! A heat map of the difference between two pictures.

use super::verdict::Relation;
use crate::numbers::heat::HeatScale;
use crate::numbers::statistics::blocks::{Block, BlockTest};
use crate::pictures::Picture;
use image::{ImageFormat, Rgb, RgbImage};
use std::io::{self, Seek, Write};

/// Frame colour, which does not occur in the map.
const FRAME: Rgb<u8> = Rgb([0, 220, 255]);

/// Writes a PNG of each pixel's root mean square difference, from dark (1e-4) to bright (1), with frames around the
/// worst blocks. A clipped integer counts as its format's largest value.
pub(super) fn write(
    a: &Picture,
    b: &Picture,
    test: &BlockTest,
    writer: &mut (impl Write + Seek),
) -> io::Result<()> {
    let limit = a.limit.min(b.limit);
    let relations = Relation::of_all(a, b);
    let difference = |pixel: usize, channel: usize| match relations[pixel][channel] {
        Relation::Difference(difference) => difference,
        Relation::Alike => 0.0,
        Relation::Apart => f64::INFINITY,
        Relation::Unknown => {
            let [a, b] =
                [a, b].map(|side| side.value(pixel, channel).map_or(limit, |value| value.min(limit)));
            b - a
        }
    };
    let mut image = RgbImage::from_fn(a.width, a.height, |x, y| {
        let pixel = (y * a.width + x) as usize;
        let squares: f64 = (0..3).map(|channel| difference(pixel, channel).powi(2)).sum();
        Rgb(HeatScale::ERROR.colour((squares / 3.0).sqrt()))
    });
    for Block { x: columns, y: rows, .. } in test.worst(super::NAMED_BLOCKS) {
        for (x, y) in columns.clone().flat_map(|x| rows.clone().map(move |y| (x, y))) {
            if [columns.start, columns.end - 1].contains(&x) || [rows.start, rows.end - 1].contains(&y) {
                image.put_pixel(x, y, FRAME);
            }
        }
    }
    image.write_to(writer, ImageFormat::Png).map_err(io::Error::other)
}
