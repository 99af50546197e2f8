//! Netpbm's formats as any program writes them: PGM and PPM (`P2`, `P3`, `P5`, `P6`), and PFM (`PF`, `Pf`).
//!
//! Common faults are repaired and reported. Sources: the manual pages of netpbm; Paul Debevec, "PFM Portable FloatMap
//! Image Format".

use super::decoded::{Damage, Incomplete, ReadPicture, Values, pixel_count};
use crate::film::Film;
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::borrow::Cow;
use std::io::{self, Write};

/// Reads a picture from the bytes of a file; of several in one file, the last.
pub(super) fn read(file: &[u8]) -> Result<ReadPicture> {
    ensure!(!file.is_empty(), "it is empty: the program that writes it has ended early, or not begun");
    let text_of_bytes = from_utf16(file);
    let whole = text_of_bytes.as_deref().unwrap_or(file);
    let unmarked = whole.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(whole);
    let first = header(unmarked).with_context(|| foreign(unmarked))?;
    let last = std::iter::successors(Some(first), |rest| next_picture(rest)).last().unwrap_or(first);
    let mut picture = match last[1] {
        b'2' => text(last, "P2", 1),
        b'3' => text(last, "P3", 3),
        b'f' => floats(last, 1),
        b'F' => floats(last, 3),
        _ => bytes(last),
    }?;
    let around = [
        (
            text_of_bytes.is_some(),
            "the file is text of two bytes per letter (UTF-16), which no viewer takes for a PPM",
            "PowerShell's > writes it so: use cmd /c \"program > picture.ppm\", or PowerShell 7, or let the program open the \
             file itself",
        ),
        (
            unmarked.len() < whole.len(),
            "the file begins with a byte order mark",
            "write it without one (UTF-8 without BOM): a PPM begins with P3 or P6",
        ),
        (
            first.len() < unmarked.len(),
            "there is other text before the header",
            "write only the picture to standard output; messages belong to std::clog",
        ),
        (
            last.len() < first.len(),
            "the file has several pictures, one after the other; this is the last",
            "write it with > instead of >>, which appends",
        ),
    ];
    let around = around.into_iter().filter(|(is_so, ..)| *is_so);
    picture.damages.splice(..0, around.map(|(_, title, remedy)| Damage::new(title, remedy)));
    Ok(picture)
}

/// The file from its second picture on, if it has several.
fn next_picture(file: &[u8]) -> Option<&[u8]> {
    if matches!(file[1], b'2' | b'3') {
        return lines(file).skip(1).find(|rest| is_header(rest));
    }
    let (_, data, needed) = byte_header(file).ok()?;
    let rest = data.get(needed..)?.trim_ascii_start();
    is_header(rest).then_some(rest)
}

/// The file from each of its lines on.
fn lines(file: &[u8]) -> impl Iterator<Item = &[u8]> {
    let ends = file.split_inclusive(|byte| matches!(byte, b'\n' | b'\r'));
    ends.scan(file, |rest, line| Some(std::mem::replace(rest, &rest[line.len()..])))
}

/// A picture of integers while it is read.
#[derive(Default)]
struct Integers {
    format: &'static str,
    channels: usize,
    width: u32,
    height: u32,
    most: u16,
    damages: Vec<Damage>,
    notes: Vec<String>,
}

impl Integers {
    /// Sets width, height and largest value.
    fn set_head(&mut self, [width, height, most]: [u64; 3]) -> Result<()> {
        (self.width, self.height, _) = checked([width, height])?;
        self.most = match u16::try_from(most) {
            Ok(256) => {
                let note = "its largest value is 256, which is read as 255; write 255 to the header";
                self.notes.push(note.to_owned());
                255
            }
            Ok(most @ 1..) => most,
            _ => bail!("its largest value is {most}; write 255 after width and height"),
        };
        Ok(())
    }

    /// How many values the picture needs.
    fn count(&self) -> usize {
        self.width as usize * self.height as usize * self.channels
    }

    fn bytes_per_value(&self) -> usize {
        if self.most > 255 { 2 } else { 1 }
    }

    /// Notes a fault if there `is` one.
    fn fault(&mut self, is: bool, title: impl Into<String>, remedy: &'static str) {
        self.damages.extend(is.then(|| Damage::new(title, remedy)));
    }

    /// Removes every fourth value if there are four per pixel.
    fn drop_alpha(&mut self, values: &mut Vec<i64>) {
        let has_alpha = self.channels == 3 && values.len() == self.count() / 3 * 4;
        self.fault(
            has_alpha,
            "there are four numbers per pixel, probably with an alpha channel, and a PPM has three",
            "write only red, green and blue",
        );
        if has_alpha {
            *values = values.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
        }
    }

    /// The picture of values that may be out of range. `missing` says what the file lacks if they are too few.
    fn picture(mut self, values: &[i64], missing: impl FnOnce() -> String) -> Result<ReadPicture> {
        let (count, most) = (self.count(), i64::from(self.most));
        let values = &values[..count.min(values.len())];
        let outside = values.iter().filter(|value| !(0..=most).contains(*value)).count();
        self.fault(
            outside > 0,
            format!("{outside} numbers are below 0 or above {most}"),
            "clamp each channel before it is scaled: int(256 * clamp(x, 0, 0.999)); negative integers often come from NaN",
        );
        let Integers { format, channels, width, height, most, damages, notes } = self;
        let value =
            |pixel: &[i64], channel: usize| pixel[channel.min(channels - 1)].clamp(0, most.into()) as u16;
        let rgb = values.chunks_exact(channels).map(|pixel| [0, 1, 2].map(|c| value(pixel, c))).collect();
        let is_whole = values.len() == count;
        let values = Values::Integers { most, rgb };
        let picture = ReadPicture { width, height, format, values, damages, notes, stated: None };
        if is_whole {
            return Ok(picture);
        }
        let picture = Box::new(ReadPicture { damages: Vec::new(), ..picture });
        Err(Incomplete { picture, reason: missing() }.into())
    }
}

/// A picture of bytes without its values, what follows its header, and how many bytes of this the picture needs.
fn byte_header(file: &[u8]) -> Result<(Integers, &[u8], usize)> {
    let (format, channels) = if file[1] == b'5' { ("P5", 1) } else { ("P6", 3) };
    let mut picture = Integers { format, channels, ..Integers::default() };
    let mut words = Words { file, at: 2 };
    let head = [words.number("width")?, words.number("height")?, words.number("largest value")?];
    picture.set_head(head)?;
    let needed = picture.count() * picture.bytes_per_value();
    Ok((picture, words.payload(needed), needed))
}

/// Reads numbers of one or two bytes.
fn bytes(file: &[u8]) -> Result<ReadPicture> {
    let (mut picture, data, needed) = byte_header(file)?;
    let Integers { format, channels, width, height, most, .. } = picture;
    if let Some(body) = text_of(data) {
        let as_text = format!("P3 {width} {height} {most}\n{body}");
        if let Ok(mut read) = text(as_text.as_bytes(), format, channels) {
            let title = format!("the header says {format}, bytes, but numbers follow as text");
            let remedy = "write P3 to the header, or the bytes themselves instead of numbers as text";
            read.damages.insert(0, Damage::new(title, remedy));
            return Ok(read);
        }
    }
    let repaired = without_returns(data, needed);
    picture.fault(
        repaired.is_some(),
        "the file was written in text mode: each byte 10 has become 13 and 10",
        "open the file in binary mode (std::ios::binary); for standard output, _setmode(_fileno(stdout), _O_BINARY)",
    );
    let data = repaired.as_deref().unwrap_or(data);
    let mut values = values_of(data, picture.bytes_per_value());
    picture.drop_alpha(&mut values);
    if values.len() > picture.count() {
        picture.notes.push(format!("{} bytes after the pixels are ignored", data.len() - needed));
    }
    picture.picture(&values, || {
        format!(
            "it has {} of the {needed} bytes that {width} x {height} pixels need; write all rows, in binary mode, and not \
             through PowerShell's >, which changes bytes",
            data.len()
        )
    })
}

fn values_of(data: &[u8], bytes_per_value: usize) -> Vec<i64> {
    match bytes_per_value {
        1 => data.iter().copied().map(i64::from).collect(),
        _ => data.as_chunks::<2>().0.iter().map(|pair| u16::from_be_bytes(*pair).into()).collect(),
    }
}

/// The body of a file as text, if it contains only numbers.
fn text_of(data: &[u8]) -> Option<&str> {
    let is_text =
        |byte: &u8| byte.is_ascii_digit() || byte.is_ascii_whitespace() || matches!(byte, b'.' | b',' | b'-');
    let is_all = data.len() > 64 && data.iter().all(is_text);
    std::str::from_utf8(data).ok().filter(|_| is_all)
}

/// Reads numbers written as text, leaving out what does not belong.
fn text(file: &[u8], format: &'static str, channels: usize) -> Result<ReadPicture> {
    let mut picture = Integers { format, channels, ..Integers::default() };
    let (mut messages, mut is_bracketed, mut lines) = (0, false, Vec::new());
    for line in file[2..].split(|byte| matches!(byte, b'\n' | b'\r')) {
        let content = line.split(|byte| *byte == b'#').next().unwrap_or_default();
        let mut content = String::from_utf8_lossy(content.trim_ascii());
        if let Some(bare) = without_brackets(&content) {
            is_bracketed = true;
            content = Cow::Owned(bare);
        }
        if content.starts_with(char::is_alphabetic) && !content.starts_with("nan") {
            messages += 1;
        } else if !content.is_empty() {
            lines.push(content);
        }
    }
    picture.fault(
        messages > 0,
        format!("{messages} lines of the file are messages, not numbers"),
        "write messages such as \"Scanlines remaining\" to std::clog, not to std::cout",
    );
    picture.fault(
        is_bracketed,
        "there are brackets or semicolons between the numbers",
        "write the three numbers of a pixel alone, separated by spaces: in Python, print(r, g, b) and not print((r, g, b))",
    );
    let mut words = lines.iter().flat_map(|line| line.split_ascii_whitespace());
    let head = words.by_ref().take(3).filter_map(|word| word.trim_matches(',').parse().ok());
    let Ok(mut head) = <[i64; 3]>::try_from(head.collect::<Vec<i64>>()) else {
        bail!("its header is not complete; {HEADER}");
    };
    // The largest value may come first, as the number of values shows.
    let numbers = head[1].checked_mul(head[2]).and_then(|pixels| pixels.checked_mul(channels as i64));
    let is_rotated = head[0] == 255 && numbers == Some(words.clone().count() as i64);
    picture.fault(is_rotated, "the largest value stands before width and height", HEADER);
    head.rotate_left(usize::from(is_rotated));
    picture.set_head(head.map(|number| number.max(0) as u64))?;
    if let Some(bytes) = body_of_bytes(file, picture.count()) {
        picture.damages.clear();
        let title = format!("the header says {format}, text, but bytes follow");
        picture.fault(true, title, "write P6 to the header, or numbers as text");
        return picture.picture(&values_of(bytes, 1), String::new);
    }
    let has_commas = words.clone().any(|word| word.trim_end_matches(',').contains(','));
    // With decimal commas, there are as many words as numbers.
    let has_decimal_commas = has_commas && words.clone().count() >= picture.count();
    let mut odd = 0;
    let mut values: Vec<i64> = Vec::new();
    let mut add = |word: &str| {
        values.push(word.parse().unwrap_or_else(|_| {
            odd += 1;
            word.parse::<f64>().map_or(-1, |x| if x.is_nan() { -1 } else { x as i64 })
        }));
    };
    for word in words.clone() {
        if has_decimal_commas {
            add(&word.trim_end_matches(',').replace(',', "."));
        } else {
            word.split(',').filter(|part| !part.is_empty()).for_each(&mut add);
        }
    }
    picture.fault(
        has_decimal_commas,
        "numbers have decimal commas",
        "write whole numbers, and a point in any other; the program's locale should be \"C\"",
    );
    let has_commas = !has_decimal_commas && words.any(|word| word.contains(','));
    picture.fault(has_commas, "there are commas between the numbers", "separate them by spaces");
    picture.fault(
        odd > 0 && !has_decimal_commas,
        format!("{odd} values are not whole numbers"),
        "convert each channel with int(256 * clamp(x, 0, 0.999)) before it is written",
    );
    let (really, title, remedy) = match channels {
        1 => (3, "the header says P2, grey, but there are three numbers per pixel", "write P3"),
        _ => (1, "the header says P3, colours, but there is one number per pixel", "write P2"),
    };
    let pixels = picture.count() / channels;
    let is_otherwise = pixels > 1 && values.len() == pixels * really;
    picture.fault(is_otherwise, title, remedy);
    picture.channels = if is_otherwise { really } else { channels };
    picture.drop_alpha(&mut values);
    let Integers { width, height, most, channels, .. } = picture;
    let (found, needed) = (values.len(), picture.count());
    let together = values.iter().filter(|value| **value > 1000 * i64::from(most)).count();
    ensure!(
        found >= needed || 2 * together < found || together == 0,
        "its numbers run together; write a space or a new line after each"
    );
    picture.fault(
        found > needed,
        format!("there are {found} numbers, but {width} x {height} pixels need {needed}"),
        "let the loops run to image_width - 1 and image_height - 1, and write the same sizes to the header",
    );
    picture.picture(&values, || {
        format!(
            "{width} x {height} pixels need {needed} numbers, but there are {found}: {} of {height} rows; check the loops, \
             width and height of the header, and whether the program ended early",
            found / (channels * width as usize)
        )
    })
}

/// A line without brackets, semicolons and the names before brackets, if it has some and only numbers remain.
fn without_brackets(line: &str) -> Option<String> {
    let is_bracket = |letter: char| "()[]{}<>;".contains(letter);
    if !line.contains(is_bracket) {
        return None;
    }
    let mut bare = String::new();
    for part in line.split(is_bracket) {
        let before = part.trim_end_matches(|letter: char| letter.is_alphanumeric() || "_.:".contains(letter));
        // A name is what stands right before a bracket and begins with a letter.
        let is_named = part[before.len()..].starts_with(char::is_alphabetic);
        bare.extend([if is_named { before } else { part }, " "]);
    }
    let is_number =
        |letter: char| letter.is_ascii_digit() || letter.is_ascii_whitespace() || "+-.,eE".contains(letter);
    (bare.chars().all(is_number) && bare.contains(|letter: char| letter.is_ascii_digit()))
        .then(|| bare.replace(',', " "))
}

/// The bytes after a text header, if they are as many as the pixels need and are not text.
fn body_of_bytes(file: &[u8], needed: usize) -> Option<&[u8]> {
    let mut words = Words { file, at: 2 };
    (0..3).for_each(|_| drop(words.next()));
    let data = words.payload(needed);
    let binary =
        data.iter().filter(|byte| !byte.is_ascii() || byte.is_ascii_control() && !byte.is_ascii_whitespace());
    (data.len() == needed && 10 * binary.count() > needed).then_some(data)
}

/// Reads a PFM, whose lowest row comes first.
fn floats(file: &[u8], channels: usize) -> Result<ReadPicture> {
    let mut words = Words { file, at: 2 };
    let size = [words.number("width")?, words.number("height")?];
    let word = words.next();
    let scale: f32 = word.parse().unwrap_or(0.0);
    ensure!(
        scale.is_finite() && scale != 0.0,
        "its scale is {word:?}; write -1.0 after width and height if the lowest byte of a number comes first, else 1.0"
    );
    let (width, height, count) = checked(size)?;
    let count = count * channels;
    let data = words.payload(4 * count);
    let Some(pixels) = data.get(..4 * count) else {
        bail!(
            "it has {} of the {} bytes that {width} x {height} pixels need; write all rows, in binary mode",
            data.len(),
            4 * count
        );
    };
    let (numbers, _) = pixels.as_chunks::<4>();
    let value = |is_little: bool, bytes: &[u8; 4]| {
        if is_little { f32::from_le_bytes(*bytes) } else { f32::from_be_bytes(*bytes) }
    };
    // The wrong byte order makes nearly all numbers absurd.
    let is_usual = |x: f32| x == 0.0 || (1e-9..1e9).contains(&x.abs());
    let usual = |is_little: bool| numbers.iter().filter(|bytes| is_usual(value(is_little, bytes))).count();
    let declared = scale < 0.0;
    let is_swapped = 2 * usual(declared) < count && usual(!declared) == count;
    let mut notes = Vec::new();
    let mut note = |is_so: bool, text: String| notes.extend(is_so.then_some(text));
    note(is_swapped, "its numbers have the other byte order, not the one that its scale states".to_owned());
    note(scale.abs() != 1.0, format!("its values are multiplied by its scale, {}", scale.abs()));
    let after = data.len() - pixels.len();
    note(after > 0, format!("{after} bytes after the pixels are ignored"));
    let rgb = numbers
        .chunks_exact(width as usize * channels)
        .rev()
        .flat_map(|row| row.chunks_exact(channels))
        .map(|pixel| [0, 1, 2].map(|channel: usize| &pixel[channel.min(channels - 1)]))
        .map(|pixel| pixel.map(|bytes| value(declared != is_swapped, bytes) * scale.abs()))
        .collect();
    let values = Values::Floats { rgb, halves: [false; 3] };
    Ok(ReadPicture { width, height, format: "PFM", values, damages: Vec::new(), notes, stated: None })
}

/// Writes the mean as a PFM with the lowest byte first. The format has no place for a description.
pub(super) fn write_pfm(film: &Film, writer: &mut impl Write) -> io::Result<()> {
    write!(writer, "PF\n{} {}\n-1.0\n", film.width(), film.height())?;
    for row in film.means().chunks_exact(film.width() as usize).rev() {
        let bytes: Vec<u8> = row.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        writer.write_all(&bytes)?;
    }
    Ok(())
}

const HEADER: &str = "a PPM begins with P3 or P6, the width, the height and 255, in this order";

/// Width, height and number of pixels.
fn checked([width, height]: [u64; 2]) -> Result<(u32, u32, usize)> {
    ensure!(
        width.min(height) > 0,
        "its header says {width} x {height} pixels; write the width and height of the picture"
    );
    let [width, height] = [width, height].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
    Ok((width, height, pixel_count(width, height, 0)?))
}

/// The white-space separated words of a header, without comments.
struct Words<'a> {
    file: &'a [u8],
    at: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Cow<'a, str> {
        let file = self.file;
        let rest = |at: usize| file.get(at..).unwrap_or_default();
        let skip = |at: usize, is_skipped: fn(u8) -> bool| {
            at + rest(at).iter().take_while(|byte| is_skipped(**byte)).count()
        };
        let is_blank = |byte: u8| byte.is_ascii_whitespace() || byte == 0x0b;
        self.at = skip(self.at, is_blank);
        while rest(self.at).first() == Some(&b'#') {
            self.at = skip(skip(self.at, |byte| !matches!(byte, b'\n' | b'\r')), is_blank);
        }
        let end = skip(self.at, |byte| !byte.is_ascii_whitespace() && !matches!(byte, b'#' | 0x0b));
        let word = &file[self.at..end];
        self.at = end;
        String::from_utf8_lossy(&word[..word.len().min(32)])
    }

    fn number(&mut self, what: &str) -> Result<u64> {
        let word = self.next();
        word.parse().map_err(|_| anyhow!("its {what} is {word:?}; {HEADER}"))
    }

    /// The data after the white space that ends the header: one character, or everything up to a line end if that
    /// leaves enough.
    fn payload(&self, needed: usize) -> &'a [u8] {
        let mut rest = self.file.get(self.at..).unwrap_or_default();
        if rest.first() == Some(&b'#') {
            let end = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len() - 1);
            rest = &rest[end..];
        }
        let blanks = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'\r')).count();
        let is_line = rest.get(blanks) == Some(&b'\n') && rest.len() - blanks > needed;
        rest.get(if is_line { blanks + 1 } else { 1 }..).unwrap_or_default()
    }
}

/// Removes the carriage returns that text mode puts before each line feed, if their number is that of the excess bytes.
fn without_returns(data: &[u8], needed: usize) -> Option<Vec<u8>> {
    let feeds = data.iter().filter(|byte| **byte == b'\n').count();
    let pairs = data.windows(2).filter(|pair| pair == b"\r\n").count();
    if pairs == 0 || feeds != pairs || data.len() != needed + pairs {
        return None;
    }
    let is_kept = |at: &usize| data[*at] != b'\r' || data.get(at + 1) != Some(&b'\n');
    Some((0..data.len()).filter(is_kept).map(|at| data[at]).collect())
}

/// Whether a picture of one of these formats begins here.
fn is_header(bytes: &[u8]) -> bool {
    let is_end = |next: &u8| next.is_ascii_whitespace() || *next == b'#';
    matches!(bytes, [b'P', b'2' | b'3' | b'5' | b'6' | b'F' | b'f', rest @ ..] if rest.first().is_some_and(is_end))
}

/// The file from its picture on, which begins at once, or at a line after some text.
fn header(file: &[u8]) -> Option<&[u8]> {
    // At the start, the first number may follow the letters directly.
    if let [b'P', b'2' | b'3' | b'5' | b'6' | b'F' | b'f', ..] = file {
        return Some(file);
    }
    let is_binary = |rest: &&[u8]| {
        let mut line = rest.iter().take_while(|byte| **byte != b'\n');
        line.any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace())
    };
    lines(file).find(|rest| is_header(rest) || is_binary(rest)).filter(|rest| is_header(rest))
}

/// The format of a file without a header.
fn foreign(file: &[u8]) -> String {
    let known = image::guess_format(file).ok().and_then(|format| format.extensions_str().first().copied());
    // A TGA has no signature at its start.
    let is_tga = matches!(file, [_, 0 | 1, 1..=3 | 9..=11, _, _, _, _, 0 | 8 | 15..=32, ..])
        && matches!(file.get(16), Some(8 | 15 | 16 | 24 | 32));
    match known.or(is_tga.then_some("tga")) {
        Some(name) => format!("it is a {} file; save it as PNG or PPM", name.to_uppercase()),
        None => format!("it is not a PNG, PPM, PFM or EXR file; {HEADER}"),
    }
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
