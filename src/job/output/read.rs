//! Reads pictures of any program: PNG, EXR, and Netpbm's formats.

use super::decoded::{Incomplete, PIXEL_LIMIT, ReadPicture, Values, note_on_alpha, pixel_count};
use super::{exr, netpbm, png};
use crate::film::checkpoint;
use crate::system::files::{self, ShownPath};
use anyhow::{Result, anyhow, ensure};
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder};
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

/// Reads a picture, of an EXR file the `layer` with this name or the only one. The first bytes of the file tell its
/// format; the name does not matter.
///
/// # Errors
/// If the file cannot be read or is not such a picture.
pub fn read_picture(path: &Path, layer: Option<&str>) -> Result<ReadPicture> {
    let (file, length) = files::open(path)?;
    decode_picture(BufReader::new(file), length, layer).map_err(|error| {
        match error.downcast::<Incomplete>() {
            Ok(Incomplete { picture, reason }) => {
                Incomplete { picture, reason: format!("cannot read {}: {reason}", path.shown()) }.into()
            }
            Err(reason) => anyhow!("cannot read {}: {reason}", path.shown()),
        }
    })
}

/// As [`read_picture`], from a reader of `length` bytes.
///
/// # Errors
/// A description of what is wrong with the file and what to do, or the reader's error.
pub fn decode_picture(
    mut reader: impl BufRead + Seek,
    length: u64,
    layer: Option<&str>,
) -> Result<ReadPicture> {
    let start = super::start_of(&mut reader)?;
    if start.starts_with(&checkpoint::MAGIC) {
        return exr::read(reader, length, layer);
    }
    if start.starts_with(b"\x89PNG") {
        return read_png(reader, length);
    }
    ensure!(length <= LENGTH_LIMIT, "it has {length} bytes; pictures have at most {LENGTH_LIMIT}");
    let mut file = Vec::new();
    reader.take(LENGTH_LIMIT).read_to_end(&mut file)?;
    netpbm::read(&file)
}

/// Largest file that is read into memory, bytes: 16 for each pixel.
const LENGTH_LIMIT: u64 = 16 * PIXEL_LIMIT;

/// Largest expansion of a byte: deflate expands up to 1032 times, and one bit of a palette index becomes 3 bytes.
const LARGEST_RATIO: u64 = 1032 * 24;

fn read_png(mut reader: impl BufRead + Seek, length: u64) -> Result<ReadPicture> {
    let (stated, mut notes) = png::colours(&mut reader);
    reader.rewind()?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(8 * PIXEL_LIMIT);
    let incomplete = |error| anyhow!("{error}; check whether the file is complete");
    let decoder = PngDecoder::with_limits(reader, limits).map_err(incomplete)?;
    let (width, height) = decoder.dimensions();
    pixel_count(width, height, 0)?;
    let least = decoder.total_bytes() / LARGEST_RATIO;
    ensure!(
        least <= length,
        "it has {length} bytes, but {width}x{height} pixels need at least {least}; check whether the file is complete"
    );
    let image = DynamicImage::from_decoder(decoder).map_err(incomplete)?;
    let translucent = if image.color().has_alpha() {
        image.to_rgba16().pixels().filter(|pixel| pixel.0[3] != u16::MAX).count()
    } else {
        0
    };
    notes.extend(note_on_alpha(translucent));
    let is_deep = image.color().bytes_per_pixel() > image.color().channel_count();
    let (most, values): (u16, Vec<u16>) = if is_deep {
        (u16::MAX, image.to_rgb16().into_raw())
    } else {
        (u16::from(u8::MAX), image.to_rgb8().into_raw().into_iter().map(u16::from).collect())
    };
    let rgb = values.as_chunks::<3>().0.to_vec();
    let values = Values::Integers { most, rgb };
    Ok(ReadPicture { width, height, format: "PNG", values, damages: Vec::new(), notes, stated })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::to_byte;
    use crate::job::output::{Encoding, Linear};
    use crate::stages::Transfer;
    use proptest::prelude::*;
    use std::io;

    fn read(file: &[u8]) -> ReadPicture {
        decode_picture(io::Cursor::new(file), file.len() as u64, None).unwrap()
    }

    /// Reads a PPM whose only row has these bytes.
    fn of_bytes(bytes: &[u8], encoding: Encoding) -> Linear {
        let header = format!("P6 {} 1 255 ", bytes.len() / 3);
        read(&[header.as_bytes(), bytes].concat()).linear(encoding)
    }

    #[test]
    fn limit_is_the_start_of_the_last_level() {
        let srgb = ((254.5 / 255.0_f64 + 0.055) / 1.055).powf(2.4);
        for (encoding, limit) in [
            (Encoding::Book(Transfer::Linear), 255.0 / 256.0),
            (Encoding::Book(Transfer::Gamma2), (255.0_f64 / 256.0).powi(2)),
            (Encoding::Srgb, srgb),
        ] {
            let read = of_bytes(&[254, 255, 0], encoding);
            assert!((read.limit - limit).abs() < 1e-12, "{encoding:?}: {}", read.limit);
            let [below, end, zero] = read.pixels[0];
            assert!(below < read.limit && end.is_nan() && zero < below, "{:?}", read.pixels);
        }
    }

    proptest! {
        #[test]
        fn bytes_decode_to_the_values_they_encode(x in 0.0..1.2_f64) {
            for transfer in [Transfer::Linear, Transfer::Gamma2] {
                let byte = to_byte(x, transfer, 0, 1);
                let [low, high] = Encoding::Book(transfer).interval(byte.into(), 255, 0, 1);
                if byte == 255 {
                    prop_assert!(low.is_nan());
                } else {
                    prop_assert!(low <= x && x < high, "{x}: {low} to {high}");
                }
            }
        }

        #[test]
        fn srgb_is_read_within_its_steps(x in 0.0..0.99_f64) {
            let byte = (255.0 * Encoding::Srgb.displayed(x, 0, 1)).round() as u16;
            if byte < 255 {
                let [low, high] = Encoding::Srgb.interval(byte, 255, 0, 1);
                prop_assert!(low - 1e-9 <= x && x <= high + 1e-9, "{x}: {low} to {high}");
            }
        }
    }

    /// Checks that a picture of one row of gray pixels, in linear values, has these intervals.
    fn assert_intervals(file: &[u8], intervals: &[[f64; 2]], limit: f64) {
        let read = read(file).linear(Encoding::Book(Transfer::Linear));
        let steps = read.steps.unwrap();
        assert_eq!(read.pixels.len(), intervals.len());
        for (index, [low, high]) in intervals.iter().enumerate() {
            let found = read.pixels[index].iter().zip(steps[index]);
            for [from, to] in found.map(|(middle, step)| [middle - step, middle + step]) {
                let is_near =
                    |found: f64, end: f64| (found - end).abs() < 1e-12 || (found.is_nan() && end.is_nan());
                assert!(
                    is_near(from, *low) && is_near(to, *high),
                    "{index}: {from} to {to}, not {low} to {high}"
                );
            }
        }
        assert!((read.limit - limit).abs() < 1e-12, "{}", read.limit);
    }

    #[test]
    fn pnm_levels_follow_the_header() {
        let unknown = [f64::NAN; 2];
        let of_32 = [[0.0, 1.0 / 32.0], [15.5 / 31.0, 16.5 / 31.0], [30.0 / 32.0, 30.5 / 31.0], unknown];
        assert_intervals(b"P5 4 1 31 \x00\x10\x1e\x1f", &of_32, 31.0 / 32.0);
        assert_intervals(b"P3 4 1 31 0 0 0 16 16 16 30 30 30 31 31 31 ", &of_32, 31.0 / 32.0);
        let of_1024 = [[511.5 / 1023.0, 512.5 / 1023.0], unknown];
        assert_intervals(b"P5 2 1 1023 \x02\x00\x03\xff", &of_1024, 1023.0 / 1024.0);
        let of_65536 = [32_768.0, 0.0].map(|level| [level / 65_536.0, (level + 1.0) / 65_536.0]);
        let file = b"P5 3 1 65535 \x80\x00\x00\x00\xff\xff";
        assert_intervals(file, &[of_65536[0], of_65536[1], unknown], 65_535.0 / 65_536.0);
    }
}
