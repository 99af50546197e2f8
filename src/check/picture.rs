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
}

impl Mine {
    /// Reads a P3, P6 or PNG file; its first bytes tell the format.
    ///
    /// # Errors
    /// [`ReadError`], which says what to do.
    pub fn read(path: &Path) -> Result<Mine, ReadError> {
        let bytes = files::read(path, "a picture", LENGTH_LIMIT)?;
        let mine = Mine::decode(&bytes).and_then(Mine::large_enough);
        mine.map_err(|reason| ReadError::Content { path: path.to_owned(), reason })
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
    let image = image::DynamicImage::from_decoder(decoder).map_err(unreadable)?.to_rgb8();
    let bytes = image.pixels().map(|pixel| pixel.0).collect();
    Ok(Mine { width, height, bytes, format: "PNG", damages: Vec::new() })
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
mod tests {
    use super::*;

    fn bytes(file: &str) -> Vec<[u8; 3]> {
        Mine::decode(file.as_bytes()).unwrap().bytes
    }

    fn reason(file: &[u8]) -> String {
        Mine::decode(file).unwrap_err()
    }

    #[test]
    fn values_are_scaled_by_the_largest_one() {
        assert_eq!(bytes("P3 1 1 255 0 128 255"), [[0, 128, 255]]);
        assert_eq!(bytes("P3 1 1 1 0 1 1"), [[0, 255, 255]]);
        assert_eq!(bytes("P3 1 1 65535 0 32768 65535"), [[0, 127, 255]]);
        assert_eq!(bytes("P3 1 1 100 50 99 -7"), [[127, 252, 0]]);
        for most in ["0", "65536", "-1"] {
            let told = reason(format!("P3 1 1 {most} 0 0 0").as_bytes());
            assert!(told.contains(&format!("its largest value is {most};")), "{told}");
        }
        assert!(reason(b"P6 1 1 254 abc").contains("its largest value is 254"));
    }

    #[test]
    fn a_size_is_refused_from_one_pixel_above_the_limit_on() {
        for (size, part) in [
            ("2000 2000", "need 12000000"),
            ("4000001 1", "more than 4000000"),
            ("1 4000001", "more than 4000000"),
            ("5 0", "header says 5 x 0"),
        ] {
            for kind in ["P3", "P6"] {
                let told = reason(format!("{kind} {size} 255\n1").as_bytes());
                assert!(told.contains(part), "{kind}: {told}");
            }
        }
        let told = reason(b"P3 2 3 255 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17");
        assert!(told.contains("need 18 numbers, but there are 17: 2 of 3 rows"), "{told}");
    }

    #[test]
    fn comments_and_line_ends_do_not_matter() {
        let expected = [[1, 2, 3], [4, 5, 6]];
        for file in [
            "P3\n# a\n2 # b\n1\n# c 9 9\n255\n1 2 3 4 5 6",
            "P3\r2 1\r255\r1 2 3\r4 5 6",
            "P3\r\n2\t1 255\r\n1 2 3\r\n4 5 6\r\n",
        ] {
            let mine = Mine::decode(file.as_bytes()).unwrap();
            assert_eq!(
                (&mine.bytes[..], mine.damages.len(), mine.format),
                (&expected[..], 0, "P3"),
                "{file:?}"
            );
        }
        let mine = Mine::decode(b"P6 # a\n2\n#b\n# c\n1 255\n\x01\x02\x03\x04\x05\x06and more").unwrap();
        assert_eq!((&mine.bytes[..], mine.damages.len(), mine.format), (&expected[..], 0, "P6"));
        // White space after the header is one byte; more of it belongs to the pixels.
        let mine = Mine::decode(b"P6 1 1 255\n\n\r\n").unwrap();
        assert_eq!(mine.bytes, [[b'\n', b'\r', b'\n']]);
        assert!(reason(b"P6 2 # no end").contains("header is not complete"));
        assert!(reason(b"P6 2 -1 255").contains("header is not complete"));
    }

    #[test]
    fn a_binary_file_that_was_written_as_text_is_repaired() {
        let mine = Mine::decode(b"P6\r\n1 1\r\n255\r\n\r\n\r\x07").unwrap();
        assert_eq!((mine.bytes, mine.damages.len()), (vec![[b'\n', b'\r', 7]], 1));
        // Without a byte too many there is nothing to repair.
        let mine = Mine::decode(b"P6\r\n1 1\r\n255\r\n\r\n\x07").unwrap();
        assert_eq!((mine.bytes, mine.damages.len()), (vec![[b'\r', b'\n', 7]], 0));
    }

    #[test]
    fn damages_are_counted() {
        let file = "hello\nP3\n2 1\n255\nScanlines: 2\n1 2.5 3\nDone.\n\n300 -1 1e3 8 9";
        let mine = Mine::decode(file.as_bytes()).unwrap();
        let titles: Vec<&str> = mine.damages.iter().map(|damage| damage.title.as_str()).collect();
        assert_eq!(
            titles,
            [
                "there is other text before the header",
                "2 lines of the file are messages, not numbers",
                "2 values are not whole numbers",
                "there are 8 numbers, but 2 x 1 pixels need 6",
                "3 numbers are below 0 or above 255",
            ]
        );
        assert_eq!(mine.bytes, [[1, 2, 3], [255, 0, 255]]);
    }
}
