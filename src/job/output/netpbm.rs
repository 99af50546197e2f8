//! Netpbm's formats as any program writes them: PGM and PPM (`P2`, `P3`, `P5`, `P6`), and PFM (`PF`, `Pf`).
//!
//! Common faults are repaired and reported. Sources: the manual pages of netpbm; Paul Debevec, "PFM Portable FloatMap
//! Image Format".

use super::decoded::{Damage, Incomplete, ReadPicture, Values, check_memory, pixel_count};
use crate::film::Film;
use anyhow::{Context, Result, anyhow, bail, ensure};
use std::borrow::Cow;
use std::io::{self, Write};
use std::ops::ControlFlow;

/// Reads a picture from the bytes of a file; of several in one file, the last.
pub(super) fn read(file: &[u8]) -> Result<ReadPicture> {
    ensure!(!file.is_empty(), "it is empty: the program that writes it has ended early, or not begun");
    let mut damages = Vec::new();
    let mut file = Cow::Borrowed(file);
    if let Some(text) = from_utf16(&file) {
        damages.push(Damage::new(
            "the file is text of two bytes per letter (UTF-16), which no viewer takes for a PPM",
            "PowerShell's > writes it so: use cmd /c \"program > picture.ppm\", or PowerShell 7, or let the program open the \
             file itself",
        ));
        file = Cow::Owned(text);
    } else if let Some(rest) = file.strip_prefix(b"\xEF\xBB\xBF") {
        damages.push(Damage::new(
            "the file begins with a byte order mark",
            "write it without one (UTF-8 without BOM): a PPM begins with P3 or P6",
        ));
        file = Cow::Owned(rest.to_owned());
    }
    let mut start = header(&file).with_context(|| foreign(&file))?;
    if start > 0 {
        damages.push(Damage::new(
            "there is other text before the header",
            "write only the picture to standard output; messages belong to std::clog",
        ));
    }
    let mut is_appended = false;
    loop {
        let mut own = Vec::new();
        match read_at(&file[start..], &mut own)? {
            ControlFlow::Continue(offset) => {
                is_appended = true;
                start += offset;
            }
            ControlFlow::Break(picture) => {
                damages.extend(is_appended.then(|| {
                    Damage::new(
                        "the file has several pictures, one after the other; this is the last",
                        "write it with > instead of >>, which appends",
                    )
                }));
                damages.append(&mut own);
                return Ok(ReadPicture { damages, ..picture });
            }
        }
    }
}

/// The picture, or where the next one begins.
type Found = ControlFlow<ReadPicture, usize>;

fn read_at(file: &[u8], damages: &mut Vec<Damage>) -> Result<Found> {
    let mut words = Words { file, at: 2 };
    let (format, channels) = match file[1] {
        b'2' => return text(file, "P2", 1, damages),
        b'3' => return text(file, "P3", 3, damages),
        b'f' => return floats(words, 1).map(Found::Break),
        b'F' => return floats(words, 3).map(Found::Break),
        b'5' => ("P5", 1),
        _ => ("P6", 3),
    };
    let size = [words.number("width")?, words.number("height")?];
    let most = words.number("largest value")?;
    let mut notes = Vec::new();
    let ((width, height, count), most) = (checked(size)?, checked_most(most, &mut notes)?);
    let bytes_per_value = if most > 255 { 2 } else { 1 };
    let needed = count * channels * bytes_per_value;
    let mut data = Cow::Borrowed(words.payload(needed));
    if let Some(body) = text_of(&data) {
        let as_text = format!("P{} {width} {height} {most}\n{body}", if channels == 3 { 3 } else { 2 });
        let mut own = Vec::new();
        if let Ok(ControlFlow::Break(picture)) = text(as_text.as_bytes(), format, channels, &mut own) {
            let remedy = "write P3 to the header, or the bytes themselves instead of numbers as text";
            damages.push(Damage::new(
                format!("the header says {format}, bytes, but numbers follow as text"),
                remedy,
            ));
            damages.append(&mut own);
            return Ok(Found::Break(picture));
        }
    }
    if data.len() < needed {
        let known = data.len() / (channels * bytes_per_value);
        let reason = format!(
            "it has {} of the {needed} bytes that {width} x {height} pixels need; write all rows, in binary mode, and not \
             through PowerShell's >, which changes bytes",
            data.len()
        );
        let values: Vec<i64> = values_of(&data, bytes_per_value);
        let values = &values[..known * channels];
        let picture = integers([width, height], format, most, channels, values, notes, damages);
        return Err(Incomplete { picture: Box::new(picture), reason }.into());
    }
    if channels == 3 && data.len() == needed / 3 * 4 {
        damages.push(Damage::new(FOUR_VALUES, DROP_ALPHA));
        let values = values_of(&data, bytes_per_value);
        let values: Vec<i64> = without_fourth(&values);
        return Ok(Found::Break(integers([width, height], format, most, channels, &values, notes, damages)));
    }
    if let Some(repaired) = without_returns(&data, needed) {
        damages.push(Damage::new(
            "the file was written in text mode: each byte 10 has become 13 and 10",
            "open the file in binary mode (std::ios::binary); for standard output, _setmode(_fileno(stdout), _O_BINARY)",
        ));
        data = Cow::Owned(repaired);
    }
    let rest = &data[needed..];
    if !rest.is_empty() {
        let blanks = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        if matches!(data, Cow::Borrowed(_)) && is_header(&rest[blanks..]) {
            return Ok(Found::Continue(file.len() - rest.len() + blanks));
        }
        notes.push(format!("{} bytes after the pixels are ignored", rest.len()));
    }
    check_memory(width, height, 0)?;
    let values = values_of(&data[..needed], bytes_per_value);
    Ok(Found::Break(integers([width, height], format, most, channels, &values, notes, damages)))
}

const FOUR_VALUES: &str =
    "there are four numbers per pixel, probably with an alpha channel, and a PPM has three";
const DROP_ALPHA: &str = "write only red, green and blue";

fn without_fourth(values: &[i64]) -> Vec<i64> {
    values.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
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

/// The picture of values that may be out of range.
fn integers(
    [width, height]: [u32; 2],
    format: &'static str,
    most: u16,
    channels: usize,
    values: &[i64],
    notes: Vec<String>,
    damages: &mut Vec<Damage>,
) -> ReadPicture {
    let outside = values.iter().filter(|value| !(0..=most.into()).contains(*value)).count();
    if outside > 0 {
        damages.push(Damage::new(
            format!("{outside} numbers are below 0 or above {most}"),
            "clamp each channel before it is scaled: int(256 * clamp(x, 0, 0.999)); negative integers often come from NaN",
        ));
    }
    let value = |pixel: &[i64], channel: usize| pixel[channel.min(channels - 1)].clamp(0, most.into()) as u16;
    let rgb = values.chunks_exact(channels).map(|pixel| [0, 1, 2].map(|c| value(pixel, c))).collect();
    ReadPicture {
        width,
        height,
        format,
        values: Values::Integers { most, rgb },
        damages: Vec::new(),
        notes,
        stated: None,
    }
}

/// Reads numbers written as text, leaving out what does not belong.
fn text(file: &[u8], format: &'static str, channels: usize, damages: &mut Vec<Damage>) -> Result<Found> {
    let (mut messages, mut bracketed, mut lines, mut at) = (0, 0, Vec::new(), 0);
    for line in file.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')) {
        if at > 0 && is_header(line) {
            return Ok(Found::Continue(at));
        }
        let content = if at == 0 { &line[2..] } else { line };
        at += line.len();
        let content = content.split(|byte| *byte == b'#').next().unwrap_or_default();
        let mut content = String::from_utf8_lossy(content.trim_ascii());
        if let Some(bare) = without_brackets(&content) {
            bracketed += 1;
            content = Cow::Owned(bare);
        }
        if content.starts_with(char::is_alphabetic) && !content.starts_with("nan") {
            messages += 1;
        } else if !content.is_empty() {
            lines.push(content);
        }
    }
    if messages > 0 {
        damages.push(Damage::new(
            format!("{messages} lines of the file are messages, not numbers"),
            "write messages such as \"Scanlines remaining\" to std::clog, not to std::cout",
        ));
    }
    if bracketed > 0 {
        damages.push(Damage::new(
            "there are brackets or semicolons between the numbers",
            "write the three numbers of a pixel alone, separated by spaces: in Python, print(r, g, b) and not print((r, g, b))",
        ));
    }
    let words = || lines.iter().flat_map(|line| line.split_ascii_whitespace());
    let head: Vec<i64> = words().take(3).filter_map(|word| word.trim_matches(',').parse().ok()).collect();
    let [width, height, most] = *head.as_slice() else {
        bail!("its header is not complete; {HEADER}");
    };
    let mut head = [width, height, most].map(|number| number.max(0) as u64);
    let words = || words().skip(3);
    // The largest value may come first, as the number of values shows.
    let numbers = words().count() as u64;
    if head[0] == 255 && numbers == head[1].saturating_mul(head[2]).saturating_mul(channels as u64) {
        damages.push(Damage::new("the largest value stands before width and height", HEADER));
        head.rotate_left(1);
    }
    let mut notes = Vec::new();
    let [width, height, most] = head;
    let ((width, height, count), most) = (checked([width, height])?, checked_most(most, &mut notes)?);
    let needed = count * channels;
    if let Some(bytes) = body_of_bytes(file, needed) {
        damages.clear();
        let remedy = "write P6 to the header, or numbers as text";
        damages.push(Damage::new(format!("the header says {format}, text, but bytes follow"), remedy));
        let values = values_of(bytes, 1);
        return Ok(Found::Break(integers([width, height], format, most, channels, &values, notes, damages)));
    }
    let has_commas = words().any(|word| word.trim_end_matches(',').contains(','));
    // With decimal commas, there are as many words as numbers.
    let has_decimal_commas = has_commas && words().count() >= needed;
    let mut odd = 0;
    let mut values: Vec<i64> = Vec::new();
    let mut add = |word: &str| {
        values.push(word.parse().unwrap_or_else(|_| {
            odd += 1;
            word.parse::<f64>().map_or(-1, |x| if x.is_nan() { -1 } else { x as i64 })
        }));
    };
    for word in words() {
        if has_decimal_commas {
            add(&word.trim_end_matches(',').replace(',', "."));
        } else {
            word.split(',').filter(|part| !part.is_empty()).for_each(&mut add);
        }
    }
    if has_decimal_commas {
        damages.push(Damage::new(
            "numbers have decimal commas",
            "write whole numbers, and a point in any other; the program's locale should be \"C\"",
        ));
    } else if words().any(|word| word.contains(',')) {
        damages.push(Damage::new("there are commas between the numbers", "separate them by spaces"));
    }
    if odd > 0 && !has_decimal_commas {
        damages.push(Damage::new(
            format!("{odd} values are not whole numbers"),
            "convert each channel with int(256 * clamp(x, 0, 0.999)) before it is written",
        ));
    }
    let mut channels = channels;
    let as_read = [
        (1, 3, "P2, grey, but there are three numbers per pixel", "write P3"),
        (3, 1, "P3, colours, but there is one number per pixel", "write P2"),
    ];
    for (of, really, title, remedy) in as_read {
        if channels == of && count > 1 && values.len() == count * really {
            damages.push(Damage::new(format!("the header says {title}"), remedy));
            channels = really;
            break;
        }
    }
    let needed = count * channels;
    if channels == 3 && values.len() == needed / 3 * 4 {
        damages.push(Damage::new(FOUR_VALUES, DROP_ALPHA));
        values = without_fourth(&values);
    }
    if values.len() < needed {
        let together = values.iter().filter(|value| **value > 1000 * i64::from(most)).count();
        ensure!(
            2 * together < values.len() || together == 0,
            "its numbers run together; write a space or a new line after each"
        );
        let reason = format!(
            "{width} x {height} pixels need {needed} numbers, but there are {}: {} of {height} rows; check the loops, width \
             and height of the header, and whether the program ended early",
            values.len(),
            values.len() / (channels * width as usize)
        );
        values.truncate(values.len() / channels * channels);
        let picture = integers([width, height], format, most, channels, &values, notes, damages);
        return Err(Incomplete { picture: Box::new(picture), reason }.into());
    }
    if values.len() > needed {
        damages.push(Damage::new(
            format!("there are {} numbers, but {width} x {height} pixels need {needed}", values.len()),
            "let the loops run to image_width - 1 and image_height - 1, and write the same sizes to the header",
        ));
    }
    check_memory(width, height, 0)?;
    let values = &values[..needed];
    Ok(Found::Break(integers([width, height], format, most, channels, values, notes, damages)))
}

/// A line without brackets, semicolons and the names before brackets, if it has some and only numbers remain.
fn without_brackets(line: &str) -> Option<String> {
    let is_bracket = |letter: char| "()[]{}<>;".contains(letter);
    if !line.contains(is_bracket) {
        return None;
    }
    let bare: Vec<&str> = line
        .split(is_bracket)
        .map(|part| part.trim_end_matches(|letter: char| letter.is_alphanumeric() || "_.:".contains(letter)))
        .zip(line.split(is_bracket))
        // A name is what stands right before a bracket and begins with a letter.
        .map(
            |(before, part)| {
                if part[before.len()..].starts_with(char::is_alphabetic) { before } else { part }
            },
        )
        .collect();
    let bare = bare.join(" ");
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
fn floats(mut words: Words, channels: usize) -> Result<ReadPicture> {
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
    check_memory(width, height, 0)?;
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
    Ok((width, height, pixel_count(width, height)?))
}

fn checked_most(most: u64, notes: &mut Vec<String>) -> Result<u16> {
    match u16::try_from(most) {
        Ok(256) => {
            notes.push("its largest value is 256, which is read as 255; write 255 to the header".to_owned());
            Ok(255)
        }
        Ok(most @ 1..) => Ok(most),
        _ => bail!("its largest value is {most}; write 255 after width and height"),
    }
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

/// Where the picture begins: at once, or at a line after some text.
fn header(file: &[u8]) -> Option<usize> {
    // At the start, the first number may follow the letters directly.
    if let [b'P', b'2' | b'3' | b'5' | b'6' | b'F' | b'f', ..] = file {
        return Some(0);
    }
    let mut at = 0;
    for line in file.split_inclusive(|byte| *byte == b'\n') {
        if is_header(line) {
            return Some(at);
        }
        at += line.len();
        if line.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace()) {
            break;
        }
    }
    None
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
