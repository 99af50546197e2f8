//! Reads pictures that readers' programs wrote, also those with damages that can be repaired.

use crate::files::{self, InputError};
use image::ImageDecoder;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Longest file that is read, bytes.
const LENGTH_LIMIT: u64 = 256 << 20;

/// Least width and height, pixels: those of the book's first picture. In fewer pixels, almost any picture could be right.
const SIZE_MIN: [u32; 2] = [16, 9];

/// Most pixels of a picture.
pub const PIXEL_LIMIT: u64 = 4_000_000;

/// A picture of 8 bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Mine {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// RGB, row by row from the top.
    pub bytes: Vec<[u8; 3]>,
    /// The format of the file, in words.
    pub format: &'static str,
    /// What is wrong with the file, although the picture could be read.
    pub damages: Vec<Damage>,
}

/// A damage of a file that could be repaired.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Damage {
    /// What is wrong.
    pub title: String,
    /// What to change.
    pub remedy: &'static str,
}

/// Why a picture cannot be read.
#[derive(Debug, Error)]
pub enum ReadError {
    /// The file cannot be opened.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The content makes no picture.
    #[error("{} cannot be read: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// The picture shows nothing.
    #[error("{} cannot be checked: {reason}", path.display())]
    Nothing {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        reason: String,
    },
}

impl Mine {
    /// Reads a P3, P6 or PNG file; its first bytes tell the format.
    ///
    /// # Errors
    /// [`ReadError`], which says what to do.
    pub fn read(path: &Path) -> Result<Mine, ReadError> {
        let bytes = files::read(path, "a picture", LENGTH_LIMIT)?;
        let content = |reason| ReadError::Content { path: path.to_owned(), reason };
        let mine = Mine::decode(&bytes).and_then(Mine::large_enough).map_err(content)?;
        mine.worth_checking().map_err(|reason| ReadError::Nothing { path: path.to_owned(), reason })
    }

    fn large_enough(self) -> Result<Mine, String> {
        let ([least_width, least_height], Mine { width, height, .. }) = (SIZE_MIN, &self);
        if *width >= least_width && *height >= least_height {
            return Ok(self);
        }
        Err(format!(
            "it has {width} x {height} pixels, fewer than {least_width} x {least_height}, too few to tell whether it is \
             right; render it at 400 x 225"
        ))
    }

    /// Refuses a picture that has the same value everywhere.
    fn worth_checking(self) -> Result<Mine, String> {
        let Some(first) = self.bytes.first().copied() else { return Ok(self) };
        if self.bytes.iter().any(|pixel| *pixel != first) {
            return Ok(self);
        }
        let remedy = match self.damages.first() {
            Some(damage) => format!("{}; {}", damage.title, damage.remedy),
            None => look_at(first).to_owned(),
        };
        let [r, g, b] = first;
        Err(format!("all its pixels are {r} {g} {b}, so there is nothing to compare; {remedy}"))
    }

    /// The same from the bytes of a file.
    ///
    /// # Errors
    /// What is wrong, and what to do.
    pub fn decode(bytes: &[u8]) -> Result<Mine, String> {
        let mut damages = Vec::new();
        let text = unicode(bytes);
        if text.is_some() {
            damages.push(Damage {
                title: "the file is text of two bytes per letter (UTF-16), which no viewer takes for a PPM".to_owned(),
                remedy: "PowerShell's > writes it so: use cmd /c \"program > picture.ppm\", or PowerShell 7, or let the \
                         program open the file itself",
            });
        }
        let bytes = text.as_deref().unwrap_or(bytes);
        let bytes = match bytes.strip_prefix(b"\xEF\xBB\xBF") {
            Some(rest) => {
                damages.push(Damage {
                    title: "the file begins with a byte order mark".to_owned(),
                    remedy: "write it without one (UTF-8 without BOM): a PPM begins with P3 or P6",
                });
                rest
            }
            None => bytes,
        };
        let mut mine = match bytes {
            [0x89, b'P', b'N', b'G', ..] => png(bytes),
            [b'P', b'6', ..] => binary(bytes, &mut damages),
            _ => plain(bytes, &mut damages),
        }?;
        mine.damages.splice(0..0, damages);
        Ok(mine)
    }
}

/// Where to look for the cause of a picture that has this value everywhere.
fn look_at(value: [u8; 3]) -> &'static str {
    match value {
        [0, 0, 0] => {
            "look at what ray_color returns, and scale before you convert: int(x) * 256 is 0 for all x below 1"
        }
        [255, 255, 255] => {
            "look at what ray_color returns, and divide the sum of a pixel by its number of samples before clamping"
        }
        _ => "look at what ray_color returns, and write each pixel's own colour",
    }
}

/// The bytes of a text that is encoded as UTF-16, if it is.
fn unicode(bytes: &[u8]) -> Option<Vec<u8>> {
    let (rest, is_little) = match bytes {
        [0xFF, 0xFE, rest @ ..] => (rest, true),
        [0xFE, 0xFF, rest @ ..] => (rest, false),
        [b'P', 0, ..] => (bytes, true),
        [0, b'P', ..] => (bytes, false),
        _ => return None,
    };
    let unit = |pair: &[u8]| match (pair, is_little) {
        ([low, high], true) | ([high, low], false) => u16::from_le_bytes([*low, *high]),
        _ => 0,
    };
    Some(rest.chunks_exact(2).map(|pair| u8::try_from(unit(pair)).unwrap_or(b'?')).collect())
}

fn checked(width: u64, height: u64) -> Result<(u32, u32), String> {
    let pixels = width.saturating_mul(height);
    if pixels == 0 {
        return Err(format!(
            "its header says {width} x {height} pixels; write the width and height of the picture"
        ));
    }
    if pixels > PIXEL_LIMIT {
        return Err(format!(
            "it has {width} x {height} pixels, more than {PIXEL_LIMIT}; the book's 400 x 225 are enough for a check"
        ));
    }
    let side = |side: u64| {
        u32::try_from(side).map_err(|_| "a side is too long; render a smaller picture".to_owned())
    };
    Ok((side(width)?, side(height)?))
}

fn png(bytes: &[u8]) -> Result<Mine, String> {
    let unreadable = |reason: image::ImageError| format!("{reason}; write it again");
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(16 * PIXEL_LIMIT);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(unreadable)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = checked(width.into(), height.into())?;
    let image = image::DynamicImage::from_decoder(decoder).map_err(unreadable)?.to_rgba8();
    let transparent = image.pixels().filter(|pixel| pixel.0[3] < 255).count();
    let mut damages = Vec::new();
    if transparent > 0 {
        damages.push(Damage {
            title: format!("{transparent} pixels are transparent, so viewers mix them with their background"),
            remedy: "write RGB without alpha, or an alpha of 255",
        });
    }
    let bytes = image.pixels().map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]).collect();
    Ok(Mine { width, height, bytes, format: "PNG", damages })
}

/// Reads `count` numbers of a header and returns them with the rest of the file.
fn header<const COUNT: usize>(mut rest: &[u8]) -> Option<([u64; COUNT], &[u8])> {
    let mut numbers = [0; COUNT];
    for number in &mut numbers {
        loop {
            match rest {
                [first, after @ ..] if first.is_ascii_whitespace() => rest = after,
                [b'#', ..] => {
                    let end = rest.iter().position(|byte| *byte == b'\n')?;
                    rest = &rest[end..];
                }
                _ => break,
            }
        }
        let digits = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
        *number = std::str::from_utf8(&rest[..digits]).ok()?.parse().ok()?;
        rest = &rest[digits..];
    }
    Some((numbers, rest))
}

const HEADER: &str = "a PPM begins with P3 or P6, the width, the height and 255, in this order";

fn binary(bytes: &[u8], damages: &mut Vec<Damage>) -> Result<Mine, String> {
    let ([width, height, most], rest) =
        header::<3>(&bytes[2..]).ok_or_else(|| format!("its header is not complete; {HEADER}"))?;
    let (width, height) = checked(width, height)?;
    if most != 255 {
        return Err(format!("its largest value is {most}; write 255 and one byte per channel"));
    }
    let is_cr_lf = rest.starts_with(b"\r\n");
    let data = rest.get(if is_cr_lf { 2 } else { 1 }..).unwrap_or_default();
    let needed = 3 * width as usize * height as usize;
    let mut repaired = Vec::new();
    let data = if data.len() > needed && is_cr_lf {
        let mut rest = data;
        while let [first, after @ ..] = rest {
            let is_pair = rest.starts_with(b"\r\n");
            repaired.push(if is_pair { b'\n' } else { *first });
            rest = if is_pair { &after[1..] } else { after };
        }
        damages.push(Damage {
            title: "the file was written as text: every byte 10 has become 13 and 10".to_owned(),
            remedy: "open the file in binary mode: std::ofstream(name, std::ios::binary), or fopen(name, \"wb\")",
        });
        &repaired[..]
    } else {
        data
    };
    if data.len() < needed {
        return Err(format!(
            "{width} x {height} pixels need {needed} bytes, but there are {}; write all rows, in binary mode, and not \
             through PowerShell's >, which changes bytes",
            data.len()
        ));
    }
    let bytes = data[..needed].chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
    Ok(Mine { width, height, bytes, format: "P6", damages: Vec::new() })
}

fn plain(bytes: &[u8], damages: &mut Vec<Damage>) -> Result<Mine, String> {
    let text = String::from_utf8_lossy(bytes);
    let Some(begin) = text.find("P3") else {
        return Err(format!("it is neither a PNG nor a PPM file; {HEADER}"));
    };
    if begin > 0 {
        damages.push(Damage {
            title: "there is other text before the header".to_owned(),
            remedy: "write nothing but the picture to standard output; messages belong to std::clog",
        });
    }
    let mut words = 0;
    let mut odd = 0;
    let mut numbers: Vec<i64> = Vec::new();
    for line in text[begin + 2..].split(['\n', '\r']) {
        let line = line.split('#').next().unwrap_or_default();
        if line.trim_start().starts_with(|c: char| c.is_alphabetic() && !line.trim_start().starts_with("nan"))
        {
            words += usize::from(!line.trim().is_empty());
            continue;
        }
        for word in line.split_ascii_whitespace() {
            match word.parse::<i64>() {
                Ok(number) => numbers.push(number),
                Err(_) => {
                    odd += 1;
                    numbers.push(word.parse::<f64>().map_or(-1, |x| if x.is_nan() { -1 } else { x as i64 }));
                }
            }
        }
    }
    if words > 0 {
        damages.push(Damage {
            title: format!("{words} lines of the file are messages, not numbers"),
            remedy: "write messages such as \"Scanlines remaining\" to std::clog, not to std::cout",
        });
    }
    if odd > 0 {
        damages.push(Damage {
            title: format!("{odd} values are not whole numbers"),
            remedy: "convert each channel with int(256 * clamp(x, 0, 0.999)) before it is written",
        });
    }
    let [width, height, most, values @ ..] = numbers.as_slice() else {
        return Err(format!("its header is not complete; {HEADER}"));
    };
    let side = |side: i64| u64::try_from(side).unwrap_or(0);
    let (width, height) = checked(side(*width), side(*height))?;
    if !(1..=65_535).contains(most) {
        return Err(format!("its largest value is {most}; write 255 after width and height"));
    }
    let needed = 3 * width as usize * height as usize;
    if values.len() < needed {
        let rows = values.len() / (3 * width as usize);
        return Err(format!(
            "{width} x {height} pixels need {needed} numbers, but there are {}: {rows} of {height} rows; check the loops, \
             width and height of the header, and whether the program ended early",
            values.len()
        ));
    }
    if values.len() > needed {
        damages.push(Damage {
            title: format!("there are {} numbers, but {width} x {height} pixels need {needed}", values.len()),
            remedy: "let the loops run to image_width - 1 and image_height - 1, and write the same sizes to the header",
        });
    }
    let values = &values[..needed];
    let outside = values.iter().filter(|value| !(0..=*most).contains(*value)).count();
    if outside > 0 {
        damages.push(Damage {
            title: format!("{outside} numbers are below 0 or above {most}"),
            remedy: "clamp each channel before it is scaled: int(256 * clamp(x, 0, 0.999)); negative ones often were NaN",
        });
    }
    let byte = |value: i64| (value.clamp(0, *most) * 255 / most) as u8;
    let bytes = values.chunks_exact(3).map(|rgb| [byte(rgb[0]), byte(rgb[1]), byte(rgb[2])]).collect();
    Ok(Mine { width, height, bytes, format: "P3", damages: Vec::new() })
}

#[cfg(test)]
mod tests;
