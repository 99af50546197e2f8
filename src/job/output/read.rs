//! Reads pictures of any program as linear radiance: PFM, EXR, PNG and binary PPM.

use super::OutputError;
use super::limits::{PIXEL_LIMIT, check_memory, invalid, pixel_count};
use super::pfm;
use crate::film::checkpoint;
use crate::stages::Transfer;
use crate::system::files;
use image::codecs::{png::PngDecoder, pnm::PnmDecoder};
use image::{DynamicImage, ImageDecoder, ImageFormat};
use std::io::{self, BufRead, BufReader, Seek};
use std::path::Path;

/// What integer values mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// As Weekender and the book write them: the transfer, then `floor(256 v)`. Values with another number of levels than
    /// 256 or 65536 may also be rounded.
    Book(Transfer),
    /// The sRGB curve, rounded, as most other programs write pictures.
    Srgb,
}

/// A picture that was read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPicture {
    pub width: u32,
    pub height: u32,
    /// Linear RGB, row by row from the top. A channel at the top of its integer range is NaN, since it only gives a
    /// lower bound.
    pub pixels: Vec<[f64; 3]>,
    /// Largest quantisation error of each channel in either direction, linear; `None` for float files.
    pub steps: Option<Vec<[f64; 3]>>,
    /// Linear value from which channels are NaN; infinite for float files.
    pub limit: f64,
}

/// Reads a picture. The first bytes of the file tell its format; the name does not matter. `encoding` is the meaning
/// of integer values.
///
/// # Errors
/// [`OutputError::Input`] or [`OutputError::Read`].
pub fn read_picture(path: &Path, encoding: Encoding) -> Result<ReadPicture, OutputError> {
    let (file, length) = files::open(path)?;
    decode_picture(BufReader::new(file), length, encoding)
        .map_err(|reason| OutputError::Read { path: path.to_owned(), reason })
}

/// As [`read_picture`], from a reader of `length` bytes.
///
/// # Errors
/// A description of what is wrong with the file, or the reader's error.
pub fn decode_picture(
    mut reader: impl BufRead + Seek,
    length: u64,
    encoding: Encoding,
) -> io::Result<ReadPicture> {
    let start = super::start_of(&mut reader)?;
    match start.as_slice() {
        [b'P', b'F' | b'f', ..] => pfm::read(reader, length).map(float),
        start if start.starts_with(&checkpoint::MAGIC) => read_exr(reader, length).map(float),
        [0x89, b'P', b'N', b'G', ..] => read_whole(reader, length, ImageFormat::Png, encoding),
        [b'P', b'2'..=b'6', ..] => read_whole(reader, length, ImageFormat::Pnm, encoding),
        _ => Err(invalid("it is not a PFM, EXR, PNG or PPM file")),
    }
}

/// Reads a PNG as bytes: its width and height in pixels, and RGB row by row from the top.
///
/// # Errors
/// [`OutputError::Input`] or [`OutputError::Read`].
pub fn read_rgb8(path: &Path) -> Result<([u32; 2], Vec<u8>), OutputError> {
    let (file, length) = files::open(path)?;
    let (image, _) = decode(BufReader::new(file), length, ImageFormat::Png)
        .map_err(|reason| OutputError::Read { path: path.to_owned(), reason })?;
    Ok(([image.width(), image.height()], image.into_rgb8().into_raw()))
}

fn float((width, height, pixels): (u32, u32, Vec<[f32; 3]>)) -> ReadPicture {
    let pixels = pixels.into_iter().map(|pixel| pixel.map(f64::from)).collect();
    ReadPicture { width, height, pixels, steps: None, limit: f64::INFINITY }
}

fn read_exr(mut reader: impl BufRead + Seek, length: u64) -> io::Result<(u32, u32, Vec<[f32; 3]>)> {
    use exr::prelude::*;
    type Pixels = (usize, Vec<[f32; 3]>);
    // All layers are checked, because the EXR library chooses which one to read.
    let meta = MetaData::read_from_buffered(&mut reader, false).map_err(invalid)?;
    for header in &meta.headers {
        checkpoint::check_length(header, length).map_err(invalid)?;
        let (width, height) = size_of_layer(header.layer_size)?;
        pixel_count(width, height)?;
        check_memory(width, height)?;
    }
    reader.rewind()?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            // Allocate nothing for a size beyond the limit; it is refused below.
            |size: Vec2<usize>, _: &RgbChannels| {
                let fits = size.x().checked_mul(size.y()).filter(|count| *count as u64 <= PIXEL_LIMIT);
                (size.x(), vec![[0.0_f32; 3]; fits.unwrap_or(0)])
            },
            |(width, pixels): &mut Pixels, at: Vec2<usize>, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width + at.x()) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(reader)
        .map_err(invalid)?;
    let (width, height) = size_of_layer(image.layer_data.size)?;
    pixel_count(width, height)?;
    Ok((width, height, image.layer_data.channel_data.pixels.1))
}

fn size_of_layer(size: exr::prelude::Vec2<usize>) -> io::Result<(u32, u32)> {
    match (u32::try_from(size.x()), u32::try_from(size.y())) {
        (Ok(width), Ok(height)) => Ok((width, height)),
        _ => Err(invalid(format!("its size is {}x{}", size.x(), size.y()))),
    }
}

/// Largest expansion of a byte: deflate expands up to 1032 times, and one bit of a palette index becomes 3 bytes.
const LARGEST_RATIO: u64 = 1032 * 24;

fn read_whole(
    reader: impl BufRead + Seek,
    length: u64,
    format: ImageFormat,
    encoding: Encoding,
) -> io::Result<ReadPicture> {
    let (image, levels) = decode(reader, length, format)?;
    let (width, height) = (image.width(), image.height());
    let is_deep = image.color().bytes_per_pixel() > image.color().channel_count();
    let (most, values): (u16, Vec<u16>) = if is_deep {
        (u16::MAX, image.to_rgb16().into_raw())
    } else {
        (u16::from(u8::MAX), image.to_rgb8().into_raw().into_iter().map(u16::from).collect())
    };
    // The decoder has scaled the values up to 8 or 16 bits.
    let scale = f64::from(levels - 1) / f64::from(most);
    let stored = |value: u16| (f64::from(value) * scale).round() as u16;
    let (triples, _) = values.as_chunks::<3>();
    let intervals = triples.iter().enumerate().map(|(index, triple)| {
        let row = index / width as usize;
        triple.map(|value| encoding.interval(stored(value), levels, row, height as usize))
    });
    let (pixels, steps) = intervals
        .map(|pixel| {
            (pixel.map(|[low, high]| 0.5 * (low + high)), pixel.map(|[low, high]| 0.5 * (high - low)))
        })
        .unzip();
    let [limit, _] = encoding.ends((levels - 1) as u16, levels, height as usize - 1, height as usize);
    Ok(ReadPicture { width, height, pixels, steps: Some(steps), limit })
}

/// The picture, and the number of values that a sample in the file can have, 2 to 65536.
fn decode(
    mut reader: impl BufRead + Seek,
    length: u64,
    format: ImageFormat,
) -> io::Result<(DynamicImage, u32)> {
    if format != ImageFormat::Png {
        let decoder = PnmDecoder::new(reader).map_err(invalid)?;
        let most = decoder.header().maximal_sample().clamp(1, u16::MAX.into());
        return Ok((image_of(decoder, length, 8)?, most + 1));
    }
    let mut head = [0; 26];
    reader.read_exact(&mut head)?;
    reader.rewind()?;
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(8 * PIXEL_LIMIT);
    let decoder = PngDecoder::with_limits(reader, limits).map_err(invalid)?;
    let levels = match head[24..] {
        // The bits of a sample, unless it is the index of a colour in a palette.
        [bits @ (1 | 2 | 4 | 16), colour_type] if colour_type != 3 => 1 << bits,
        _ => 1 << 8,
    };
    Ok((image_of(decoder, length, LARGEST_RATIO)?, levels))
}

/// Decodes a picture if its size is within the limits and its file is long enough: a byte expands to at most `ratio`
/// bytes.
fn image_of(decoder: impl ImageDecoder, length: u64, ratio: u64) -> io::Result<DynamicImage> {
    let (width, height) = decoder.dimensions();
    pixel_count(width, height)?;
    let least = decoder.total_bytes() / ratio;
    if least > length {
        return Err(invalid(format!(
            "it has {length} bytes, but {width}x{height} pixels need at least {least}"
        )));
    }
    check_memory(width, height)?;
    DynamicImage::from_decoder(decoder).map_err(invalid)
}

impl Encoding {
    /// The interval of linear values that are stored as `value` of `levels`. At the top it is NaN, as all brighter
    /// values are stored so.
    fn interval(self, value: u16, levels: u32, row: usize, height: usize) -> [f64; 2] {
        if u32::from(value) + 1 == levels {
            return [f64::NAN; 2];
        }
        self.ends(value, levels, row, height)
    }

    /// The least and the largest linear value that are stored as `value` of `levels`, if nothing is brighter.
    fn ends(self, value: u16, levels: u32, row: usize, height: usize) -> [f64; 2] {
        let is_cut_off = matches!(levels, 0x100 | 0x1_0000);
        let (value, levels) = (f64::from(value), f64::from(levels));
        let cut_off = [value, value + 1.0].map(|end| end / levels);
        let rounded = [value - 0.5, value + 0.5].map(|end| end.max(0.0) / (levels - 1.0));
        match self {
            Encoding::Book(transfer) => {
                let is_gamma = transfer.is_gamma(row, height);
                let [low, high] = if is_cut_off {
                    cut_off
                } else {
                    [cut_off[0].min(rounded[0]), cut_off[1].max(rounded[1])]
                };
                [low, high].map(|end| if is_gamma { end * end } else { end })
            }
            Encoding::Srgb => rounded.map(srgb_to_linear),
        }
    }
}

/// IEC 61966-2-1.
fn srgb_to_linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::to_byte;
    use proptest::prelude::*;

    /// Reads a PPM whose only row has these bytes.
    fn of_bytes(bytes: &[u8], encoding: Encoding) -> ReadPicture {
        let header = format!("P6 {} 1 255 ", bytes.len() / 3);
        let file = [header.as_bytes(), bytes].concat();
        decode_picture(io::Cursor::new(&file), file.len() as u64, encoding).unwrap()
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
        fn a_byte_stands_for_the_values_that_become_it(x in 0.0..1.2_f64) {
            for transfer in [Transfer::Linear, Transfer::Gamma2] {
                let byte = to_byte(x, transfer, 0, 1);
                let [low, high] = Encoding::Book(transfer).interval(byte.into(), 256, 0, 1);
                if byte == 255 {
                    prop_assert!(low.is_nan());
                } else {
                    prop_assert!(low <= x && x < high, "{x}: {low} to {high}");
                }
            }
        }

        #[test]
        fn srgb_is_read_within_its_steps(x in 0.0..0.99_f64) {
            let v = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
            let byte = (255.0 * v).round() as u16;
            if byte < 255 {
                let [low, high] = Encoding::Srgb.interval(byte, 256, 0, 1);
                prop_assert!(low - 1e-9 <= x && x <= high + 1e-9, "{x}: {low} to {high}");
            }
        }
    }

    #[test]
    fn an_exr_that_deflates_well_is_no_short_file() {
        use exr::prelude::*;
        let (width, height) = (512, 512);
        let black = SpecificChannels::rgb(|_: Vec2<usize>| (0.0_f32, 0.0_f32, 0.0_f32));
        for compression in [Compression::ZIP1, Compression::ZIP16] {
            let encoding = Encoding { compression, ..Encoding::FAST_LOSSLESS };
            let layer = Layer::new((width, height), LayerAttributes::default(), encoding, black.clone());
            let mut file = io::Cursor::new(Vec::new());
            Image::from_layer(layer).write().to_buffered(&mut file).unwrap();
            let bytes = file.into_inner();
            assert!(compression == Compression::ZIP1 || bytes.len() * 300 < width * height * 12);
            let (found_width, found_height, pixels) =
                read_exr(io::Cursor::new(&bytes), bytes.len() as u64).unwrap();
            assert_eq!((found_width as usize, found_height as usize), (width, height));
            assert!(pixels.iter().flatten().all(|x| *x == 0.0), "{compression:?}");
        }
    }

    #[test]
    fn sixteen_bits_have_as_many_levels() {
        let file = b"P6 1 1 65535 \xff\xff\x80\x00\x00\x00";
        let encoding = Encoding::Book(Transfer::Linear);
        let read = decode_picture(io::Cursor::new(file), file.len() as u64, encoding).unwrap();
        let [end, middle, zero] = read.pixels[0];
        assert!(end.is_nan());
        assert_eq!([middle, zero, read.limit], [32_768.5, 0.5, 65_535.0].map(|level| level / 65_536.0));
    }

    /// Checks that a picture of one row of gray pixels, in linear values, has these intervals.
    fn assert_intervals(file: &[u8], intervals: &[[f64; 2]], limit: f64) {
        let encoding = Encoding::Book(Transfer::Linear);
        let read = decode_picture(io::Cursor::new(file), file.len() as u64, encoding).unwrap();
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
    fn a_pnm_has_as_many_levels_as_its_header_says() {
        let unknown = [f64::NAN; 2];
        let of_32 = [[0.0, 1.0 / 32.0], [15.5 / 31.0, 16.5 / 31.0], [30.0 / 32.0, 30.5 / 31.0], unknown];
        assert_intervals(b"P5 4 1 31 \x00\x10\x1e\x1f", &of_32, 31.0 / 32.0);
        assert_intervals(b"P3 4 1 31 0 0 0 16 16 16 30 30 30 31 31 31 ", &of_32, 31.0 / 32.0);
        let of_1024 = [[511.5 / 1023.0, 512.5 / 1023.0], unknown];
        assert_intervals(b"P5 2 1 1023 \x02\x00\x03\xff", &of_1024, 1023.0 / 1024.0);
        // In a bitmap, 1 is black.
        assert_intervals(b"P4 2 1 \x80", &[[0.0, 0.5], unknown], 0.5);
    }

    /// A byte of a bitmap holds eight pixels, so no PNM is shorter than an eighth of its pixel count.
    #[test]
    fn short_pnm_is_refused_before_allocation() {
        let message = |length: u64| {
            let header = io::Cursor::new(b"P6 160 100 255 ");
            decode_picture(header, length, Encoding::Srgb).unwrap_err().to_string()
        };
        assert_eq!(message(5999), "it has 5999 bytes, but 160x100 pixels need at least 6000");
        assert!(!message(6000).contains("need at least"), "{}", message(6000));
    }

    #[test]
    fn png_levels_follow_bit_depth_and_palette() {
        use ::png::{
            BitDepth,
            ColorType::{self, Grayscale, Indexed},
        };
        let png_of = |colour: ColorType, depth: BitDepth, width: u32, row: &[u8]| {
            let mut file = Vec::new();
            let mut encoder = ::png::Encoder::new(&mut file, width, 1);
            encoder.set_color(colour);
            encoder.set_depth(depth);
            if colour == Indexed {
                encoder.set_palette(vec![0x80; 3]);
            }
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(row).unwrap();
            writer.finish().unwrap();
            file
        };
        let unknown = [f64::NAN; 2];
        let of_16 = [[0.0, 1.0 / 16.0], [6.5 / 15.0, 0.5], unknown];
        assert_intervals(&png_of(Grayscale, BitDepth::Four, 3, b"\x07\xf0"), &of_16, 15.0 / 16.0);
        assert_intervals(&png_of(Grayscale, BitDepth::Two, 2, b"\x30"), &[[0.0, 0.25], unknown], 0.75);
        assert_intervals(&png_of(Grayscale, BitDepth::One, 2, b"\x40"), &[[0.0, 0.5], unknown], 0.5);
        let of_256 = [[128.0 / 256.0, 129.0 / 256.0]];
        assert_intervals(&png_of(Grayscale, BitDepth::Eight, 1, b"\x80"), &of_256, 255.0 / 256.0);
        assert_intervals(&png_of(Indexed, BitDepth::One, 1, b"\x00"), &of_256, 255.0 / 256.0);
        let of_65536 = [[32_768.0 / 65_536.0, 32_769.0 / 65_536.0], unknown];
        let deep = png_of(Grayscale, BitDepth::Sixteen, 2, b"\x80\x00\xff\xff");
        assert_intervals(&deep, &of_65536, 65_535.0 / 65_536.0);
    }
}
