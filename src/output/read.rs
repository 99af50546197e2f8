//! Reads pictures of any program as linear radiance: PFM, EXR, PNG and binary PPM.

use super::OutputError;
use super::pfm;
use crate::files;
use crate::film::checkpoint;
use crate::memory;
use crate::stages::Transfer;
use image::codecs::{png::PngDecoder, pnm::PnmDecoder};
use image::{ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageFormat};
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
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Linear RGB, row by row from the top. A channel at the top of its integer range is NaN, since it only tells a
    /// limit.
    pub pixels: Vec<[f64; 3]>,
    /// Largest quantisation error of each channel in either direction, linear; `None` for float files.
    pub steps: Option<Vec<[f64; 3]>>,
    /// Linear value from which on a channel is NaN; infinite for float files.
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

/// The same from a reader of `length` bytes.
///
/// # Errors
/// What is wrong with the file, or the reader's error.
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

pub(super) fn invalid(reason: impl ToString) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason.to_string())
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
            // Nothing is allocated for a size beyond the limit; such a size is refused below.
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
    reader: impl BufRead + Seek,
    length: u64,
    format: ImageFormat,
) -> io::Result<(DynamicImage, u32)> {
    if format != ImageFormat::Png {
        let decoder = PnmDecoder::new(reader).map_err(invalid)?;
        let most = decoder.header().maximal_sample().clamp(1, u16::MAX.into());
        return Ok((image_of(decoder, length, 8)?, most + 1));
    }
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(8 * PIXEL_LIMIT);
    let decoder = PngDecoder::with_limits(reader, limits).map_err(invalid)?;
    let levels = match (decoder.original_color_type(), decoder.color_type()) {
        (ExtendedColorType::L1, _) => 1 << 1,
        (ExtendedColorType::L2, _) => 1 << 2,
        (ExtendedColorType::L4, _) => 1 << 4,
        (_, ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16) => 1 << 16,
        _ => 1 << 8,
    };
    Ok((image_of(decoder, length, LARGEST_RATIO)?, levels))
}

/// Decodes a picture if its size is within the limits and its file is long enough: a byte becomes at most `ratio`.
fn image_of(decoder: impl ImageDecoder, length: u64, ratio: u64) -> io::Result<DynamicImage> {
    let (width, height) = decoder.dimensions();
    pixel_count(width, height)?;
    let least = decoder.total_bytes() / ratio;
    if least > length {
        return Err(invalid(format!("it has {length} bytes, but {width}x{height} pixels need at least {least}")));
    }
    check_memory(width, height)?;
    DynamicImage::from_decoder(decoder).map_err(invalid)
}

/// Largest number of pixels that is read.
const PIXEL_LIMIT: u64 = 1 << 28;

/// Number of pixels, or an error if the size is out of range.
pub(super) fn pixel_count(width: u32, height: u32) -> io::Result<usize> {
    let count = u64::from(width) * u64::from(height);
    if !(1..=PIXEL_LIMIT).contains(&count) {
        return Err(invalid(format!("its size is {width}x{height}; only 1 to {PIXEL_LIMIT} pixels can be read")));
    }
    Ok(count as usize)
}

/// Most memory per pixel while a picture is read: for the file's data, the decoded data, and the numbers with their
/// quantisation steps.
const BYTES_PER_PIXEL: u64 = 80;

/// Returns an error if the picture would not fit into memory.
pub(super) fn check_memory(width: u32, height: u32) -> io::Result<()> {
    let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL;
    let what = || format!("a picture of {width}x{height} pixels");
    memory::check(what, bytes, "close other programs or make it smaller")
        .map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))
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
mod tests;
