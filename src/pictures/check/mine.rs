//! Reads the reader's 8-bit picture, repairing common damage to the file.

use crate::job::output::{Encoding, ReadPicture, decode_picture};
use crate::stages::Transfer;
use crate::system::files;
use anyhow::{Result, anyhow};
use std::borrow::Cow;
use std::io::Cursor;
use std::path::Path;

/// Largest file read, bytes.
const LENGTH_LIMIT: u64 = 256 << 20;

/// Minimum width and height, pixels: the book's first picture. With fewer pixels, almost any picture could pass.
const SIZE_MIN: [u32; 2] = [16, 9];

const PIXEL_LIMIT: u64 = 4_000_000;

/// An 8-bit picture, as the reader's program wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mine {
    pub width: u32,
    pub height: u32,
    /// RGB, row by row from the top.
    pub bytes: Vec<[u8; 3]>,
    /// Name of the file format, for messages.
    pub format: &'static str,
    /// Damage that was repaired to read the picture.
    pub damages: Vec<Damage>,
}

/// A repaired fault of the file.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Damage {
    pub title: String,
    pub remedy: &'static str,
}

impl Mine {
    /// Reads a file and detects its format from the first bytes.
    pub fn read(path: &Path) -> Result<Mine> {
        let bytes = files::read(path, "a picture", LENGTH_LIMIT)?;
        let unreadable = |reason| anyhow!("{} cannot be read: {reason}", path.display());
        let mine = Mine::decode(&bytes).map_err(unreadable)?;
        let (Mine { width, height, .. }, [least_width, least_height]) = (&mine, SIZE_MIN);
        if *width < least_width || *height < least_height {
            return Err(unreadable(format!(
                "it has {width} x {height} pixels, fewer than {least_width} x {least_height}, too few to tell whether it is \
                 right; render it at 400 x 225"
            )));
        }
        match mine.blank() {
            Some(reason) => Err(anyhow!("{} cannot be checked: {reason}", path.display())),
            None => Ok(mine),
        }
    }

    /// Reads the picture from the bytes of a file.
    pub fn decode(bytes: &[u8]) -> Result<Mine, String> {
        let (file, format, damages) = repaired(bytes)?;
        let picture = decoded(&file).map_err(|reason| {
            format!("{reason}; write all rows, in binary mode, and not through PowerShell's >, which changes bytes")
        })?;
        check_size(picture.width.into(), picture.height.into())?;
        let steps = picture.steps.ok_or("it holds floating-point numbers; write 8 bits per channel")?;
        let byte =
            |(middle, step): (f64, f64)| if middle.is_nan() { 255 } else { (256.0 * (middle - step)) as u8 };
        let pixels = picture.pixels.iter().zip(&steps);
        let bytes = pixels.map(|(middles, steps)| [0, 1, 2].map(|c| byte((middles[c], steps[c])))).collect();
        Ok(Mine { width: picture.width, height: picture.height, bytes, format, damages })
    }

    /// Why a picture of a single colour cannot be checked.
    fn blank(&self) -> Option<String> {
        let first @ [r, g, b] = *self.bytes.first()?;
        if self.bytes.iter().any(|pixel| *pixel != first) {
            return None;
        }
        let remedy = self.damages.first().map_or_else(
            || {
                "look at what ray_color returns; scale before you convert, as int(x) * 256 is 0 for all x below 1; divide by \
                 the number of samples before clamping"
                    .to_owned()
            },
            |damage| format!("{}; {}", damage.title, damage.remedy),
        );
        Some(format!("all its pixels are {r} {g} {b}, so there is nothing to compare; {remedy}"))
    }
}

fn decoded(file: &[u8]) -> std::io::Result<ReadPicture> {
    // The transfer does not matter, because only bytes are used.
    decode_picture(Cursor::new(file), file.len() as u64, Encoding::Book(Transfer::Linear))
}

/// A well-formed file with the same picture, its original format, and the damage.
type Repaired<'a> = (Cow<'a, [u8]>, &'static str, Vec<Damage>);

fn repaired(bytes: &[u8]) -> Result<Repaired<'_>, String> {
    let mut damages = Vec::new();
    let mut damaged = |title: String, remedy| damages.push(Damage { title, remedy });
    let mut bytes = Cow::Borrowed(bytes);
    if let Some(text) = from_utf16(&bytes) {
        damaged(
            "the file is text of two bytes per letter (UTF-16), which no viewer takes for a PPM".to_owned(),
            "PowerShell's > writes it so: use cmd /c \"program > picture.ppm\", or PowerShell 7, or let the program open the \
             file itself",
        );
        bytes = Cow::Owned(text);
    } else if let Some(rest) = bytes.strip_prefix(b"\xEF\xBB\xBF") {
        damaged(
            "the file begins with a byte order mark".to_owned(),
            "write it without one (UTF-8 without BOM): a PPM begins with P3 or P6",
        );
        bytes = Cow::Owned(rest.to_owned());
    }
    let (bytes, format) = match &*bytes {
        [0x89, b'P', b'N', b'G', ..] => (bytes, "PNG"),
        [b'P', b'6', ..] => (bytes, "P6"),
        _ => (Cow::Owned(repaired_text(&bytes, damaged)?), "P3"),
    };
    Ok((bytes, format, damages))
}

/// Decodes a text in UTF-16; `None` if it is not UTF-16.
fn from_utf16(bytes: &[u8]) -> Option<Vec<u8>> {
    let (rest, is_little) = match bytes {
        [0xFF, 0xFE, rest @ ..] => (rest, true),
        [0xFE, 0xFF, rest @ ..] => (rest, false),
        [b'P', 0, ..] => (bytes, true),
        [0, b'P', ..] => (bytes, false),
        _ => return None,
    };
    let (pairs, _) = rest.as_chunks::<2>();
    let unit = |pair: &[u8; 2]| if is_little { u16::from_le_bytes(*pair) } else { u16::from_be_bytes(*pair) };
    Some(pairs.iter().map(|pair| u8::try_from(unit(pair)).unwrap_or(b'?')).collect())
}

fn check_size(width: u64, height: u64) -> Result<(), String> {
    match width.saturating_mul(height) {
        0 => Err(format!(
            "its header says {width} x {height} pixels; write the width and height of the picture"
        )),
        1..=PIXEL_LIMIT => Ok(()),
        _ => Err(format!(
            "it has {width} x {height} pixels, more than {PIXEL_LIMIT}; the book's 400 x 225 are enough for a check"
        )),
    }
}

const HEADER: &str = "a PPM begins with P3 or P6, the width, the height and 255, in this order";

/// Converts P3 to P6, dropping anything that does not belong.
fn repaired_text(bytes: &[u8], mut damaged: impl FnMut(String, &'static str)) -> Result<Vec<u8>, String> {
    let text = String::from_utf8_lossy(bytes);
    let begin = text.find("P3").ok_or_else(|| format!("it is neither a PNG nor a PPM file; {HEADER}"))?;
    if begin > 0 {
        damaged(
            "there is other text before the header".to_owned(),
            "write nothing but the picture to standard output; messages belong to std::clog",
        );
    }
    let (mut messages, mut odd, mut numbers) = (0, 0, Vec::new());
    for line in text[begin + 2..].split(['\n', '\r']) {
        let line = line.split('#').next().unwrap_or_default().trim_start();
        if line.starts_with(char::is_alphabetic) && !line.starts_with("nan") {
            messages += 1;
            continue;
        }
        for word in line.split_ascii_whitespace() {
            numbers.push(word.parse::<i64>().unwrap_or_else(|_| {
                odd += 1;
                word.parse::<f64>().map_or(-1, |x| if x.is_nan() { -1 } else { x as i64 })
            }));
        }
    }
    if messages > 0 {
        damaged(
            format!("{messages} lines of the file are messages, not numbers"),
            "write messages such as \"Scanlines remaining\" to std::clog, not to std::cout",
        );
    }
    if odd > 0 {
        damaged(
            format!("{odd} values are not whole numbers"),
            "convert each channel with int(256 * clamp(x, 0, 0.999)) before it is written",
        );
    }
    let [width, height, most, values @ ..] = numbers.as_slice() else {
        return Err(format!("its header is not complete; {HEADER}"));
    };
    let [width, height] = [width, height].map(|side| u64::try_from(*side).unwrap_or(0));
    check_size(width, height)?;
    if !(1..=65_535).contains(most) {
        return Err(format!("its largest value is {most}; write 255 after width and height"));
    }
    let needed = 3 * (width * height) as usize;
    if values.len() < needed {
        return Err(format!(
            "{width} x {height} pixels need {needed} numbers, but there are {}: {} of {height} rows; check the loops, \
             width and height of the header, and whether the program ended early",
            values.len(),
            values.len() / (3 * width as usize)
        ));
    }
    if values.len() > needed {
        damaged(
            format!("there are {} numbers, but {width} x {height} pixels need {needed}", values.len()),
            "let the loops run to image_width - 1 and image_height - 1, and write the same sizes to the header",
        );
    }
    let values = &values[..needed];
    let outside = values.iter().filter(|value| !(0..=*most).contains(*value)).count();
    if outside > 0 {
        damaged(
            format!("{outside} numbers are below 0 or above {most}"),
            "clamp each channel before it is scaled: int(256 * clamp(x, 0, 0.999)); negative ones often were NaN",
        );
    }
    let bytes = values.iter().map(|value| (value.clamp(&0, most) * 255 / most) as u8);
    Ok(format!("P6 {width} {height} 255\n").into_bytes().into_iter().chain(bytes).collect())
}
