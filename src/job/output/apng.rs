//! Animated PNG, assembled from frames that are PNG files.

use super::png;
use super::{Description, OutputError};
use crate::system::files::{self, replace_file};
use ::png::EncodingError;
use std::io::{self, BufReader, Write};
use std::path::{Path, PathBuf};

/// Frames per second as a fraction, such as 30000/1001. A PNG holds its inverse, the time of a frame, as two such numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRate {
    /// Numerator, at least 1.
    pub frames: u16,
    /// Denominator, at least 1.
    pub seconds: u16,
}

impl FrameRate {
    pub fn per_second(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }
}

/// Writes an animated PNG that repeats without end, replacing an existing file. `frames` are the files of its frames: 8-bit
/// RGB PNG of `size`, width and height in pixels. One frame at a time is in memory.
///
/// # Errors
/// [`OutputError::Write`]; an existing file is then unchanged.
pub fn write_animation(
    path: &Path,
    size: [u32; 2],
    rate: FrameRate,
    frames: impl ExactSizeIterator<Item = PathBuf>,
    description: &Description,
) -> Result<(), OutputError> {
    replace_file(path, |writer| {
        encode(writer, size, rate, frames, description).map_err(|error| match error {
            EncodingError::IoError(error) => error,
            other => other.into(),
        })
    })?;
    Ok(())
}

fn encode(
    writer: impl Write,
    size: [u32; 2],
    rate: FrameRate,
    frames: impl ExactSizeIterator<Item = PathBuf>,
    description: &Description,
) -> Result<(), EncodingError> {
    let mut encoder = ::png::Encoder::new(writer, size[0], size[1]);
    encoder.set_color(::png::ColorType::Rgb);
    let count = u32::try_from(frames.len()).map_err(io::Error::other)?;
    encoder.set_animated(count, 0)?;
    encoder.set_frame_delay(rate.seconds, rate.frames)?;
    let mut writer = png::begin(encoder, description)?;
    for frame in frames {
        let pixels = pixels_of(&frame, size).map_err(|error| io::Error::other(error.to_string()))?;
        writer.write_image_data(&pixels)?;
    }
    writer.finish()?;
    Ok(())
}

/// The frame count of an animated PNG, and its rate if the first frame tells one. `None` for other and for unreadable
/// files.
pub fn animation_in(path: &Path) -> Option<(u32, Option<FrameRate>)> {
    let (file, _) = files::open(path).ok()?;
    let mut decoder = ::png::Decoder::new(BufReader::new(file));
    decoder.set_ignore_text_chunk(true);
    let reader = decoder.read_info().ok()?;
    let count = reader.info().animation_control()?.num_frames;
    // A denominator of 0 stands for 100.
    let rate = reader.info().frame_control().map(|control| FrameRate {
        frames: if control.delay_den == 0 { 100 } else { control.delay_den },
        seconds: control.delay_num,
    });
    Some((count, rate.filter(|rate| rate.seconds > 0)))
}

/// Checks that a file is a complete 8-bit RGB PNG of `size`.
///
/// # Errors
/// [`OutputError::Input`] or [`OutputError::Read`].
pub fn check_frame(path: &Path, size: [u32; 2]) -> Result<(), OutputError> {
    pixels_of(path, size).map(drop)
}

fn pixels_of(path: &Path, size: [u32; 2]) -> Result<Vec<u8>, OutputError> {
    let (file, _) = files::open(path)?;
    png::read_pixels(BufReader::new(file), size).map_err(|reason| OutputError::unreadable(path, &reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::File;

    #[test]
    fn a_time_without_a_denominator_is_in_hundredths_of_a_second() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("other.png");
        for (written, read) in [([4, 0], [4, 100]), ([4, 25], [4, 25])] {
            let mut encoder = ::png::Encoder::new(File::create(&path).unwrap(), 1, 1);
            encoder.set_animated(1, 0).unwrap();
            encoder.set_frame_delay(written[0], written[1]).unwrap();
            let mut writer = encoder.write_header().unwrap();
            writer.write_image_data(&[0]).unwrap();
            writer.finish().unwrap();
            let rate = FrameRate { frames: read[1], seconds: read[0] };
            assert_eq!(animation_in(&path), Some((1, Some(rate))), "{written:?}");
        }
    }
}
