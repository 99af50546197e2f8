//! The reader's picture in 8 bits.

use crate::job::output::{Damage, Incomplete, ReadPicture, Values, decode_picture, displayed, read_picture};
use crate::system::memory;
use anyhow::{Result, anyhow, bail, ensure};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// Minimum width and height, pixels: the book's first picture. With fewer pixels, almost any picture could pass.
const SIZE_MIN: [u32; 2] = [16, 9];

const PIXEL_LIMIT: u64 = 4_000_000;

/// Upper limit on the memory of a check, bytes per pixel; 2,700 were measured.
const PIXEL_BYTES: u64 = 3000;

/// An 8-bit picture, as the reader's program wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mine {
    pub width: u32,
    pub height: u32,
    /// Rows of the file that are known: all, unless it is still being written.
    pub rows: u32,
    /// RGB, row by row from the top; black where it is not known.
    pub bytes: Vec<[u8; 3]>,
    /// Pixels that are not compared.
    pub ignored: Option<Arc<[bool]>>,
    /// The largest value that the file can hold.
    pub most: u16,
    /// Name of the file format, for messages.
    pub format: &'static str,
    /// Damage that was repaired to read the picture.
    pub damages: Vec<Damage>,
    /// Notes on what the reader of the file left out or assumed.
    pub notes: Vec<String>,
}

impl Mine {
    /// A picture of these bytes, as a P3 file without damage would hold it.
    pub fn of_bytes(bytes: Vec<[u8; 3]>, [width, height]: [u32; 2]) -> Mine {
        Mine {
            width,
            height,
            rows: height,
            bytes,
            ignored: None,
            most: 255,
            format: "P3",
            damages: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Reads a file and detects its format from the first bytes.
    pub fn read(path: &Path) -> Result<Mine> {
        let name = path.display();
        let mine = Mine::of(read_picture(path, None)?)
            .map_err(|reason| anyhow!("{name} cannot be read: {reason}"))?;
        let (Mine { width, height, .. }, [least_width, least_height]) = (&mine, SIZE_MIN);
        ensure!(
            *width >= least_width && *height >= least_height,
            "{name} cannot be read: it has {width} x {height} pixels, fewer than {least_width} x {least_height}, too few \
             to tell whether it is right; render it at 400 x 225"
        );
        let [r, g, b] = mine.bytes[0];
        if mine.bytes.iter().all(|pixel| *pixel == [r, g, b]) {
            let remedy = mine.damages.first().map_or_else(
                || {
                    "look at what ray_color returns; scale before you convert, as int(x) * 256 is 0 for all x below 1; \
                     divide by the number of samples before clamping"
                        .to_owned()
                },
                |damage| format!("{}; {}", damage.title, damage.remedy),
            );
            bail!(
                "{name} cannot be checked: all its pixels are {r} {g} {b}, so there is nothing to compare; {remedy}"
            );
        }
        Ok(mine)
    }

    /// Reads the rows of a file that is still being written; `None` if it shows nothing yet or is complete.
    pub fn begun(path: &Path) -> Option<Mine> {
        let Incomplete { picture, .. } = read_picture(path, None).err()?.downcast().ok()?;
        let mut mine = Mine::of(*picture).ok()?;
        let [least_width, least_height] = SIZE_MIN;
        if mine.width < least_width || mine.height < least_height {
            return None;
        }
        // The last number may be cut.
        mine.rows = (mine.bytes.len().saturating_sub(1) as u64 / u64::from(mine.width)) as u32;
        mine.bytes.truncate((mine.rows * mine.width) as usize);
        mine.bytes.resize((mine.width * mine.height) as usize, [0; 3]);
        Some(mine)
    }

    /// Reads the picture from the bytes of a file.
    pub fn decode(file: &[u8]) -> Result<Mine, String> {
        let read = decode_picture(Cursor::new(file), file.len() as u64, None);
        Mine::of(read.map_err(|reason| reason.to_string())?)
    }

    fn of(read: ReadPicture) -> Result<Mine, String> {
        let ReadPicture { width, height, format, values, damages, notes, .. } = read;
        let Values::Integers { most, rgb } = values else {
            return Err("it holds floating-point numbers; write 8 bits per channel".to_owned());
        };
        if u64::from(width) * u64::from(height) > PIXEL_LIMIT {
            return Err(format!(
                "it has {width} x {height} pixels, more than {PIXEL_LIMIT}; the book's 400 x 225 are enough for a check"
            ));
        }
        let what = || format!("a check of {width} x {height} pixels");
        let remedy = "render it at 400 x 225, which is enough for a check";
        memory::check(what, PIXEL_BYTES * u64::from(width) * u64::from(height), remedy)
            .map_err(|error| error.to_string())?;
        let byte = |value: u16| {
            let [low, high] = displayed(value, most);
            (128.0 * (low + high)) as u8
        };
        let bytes = rgb.iter().map(|pixel| pixel.map(byte)).collect();
        let mut mine =
            Mine { width, height, rows: height, bytes, ignored: None, most, format, damages, notes };
        if mine.bytes.len() == (width * height) as usize {
            mine.crop();
            mine.shrink();
        }
        Ok(mine)
    }

    /// Takes away the frame of a screenshot: rows and columns of one colour.
    fn crop(&mut self) {
        let [width, height] = [self.width as usize, self.height as usize];
        let at = |x: usize, y: usize| self.bytes[y * width + x];
        let row =
            |y: usize| (0..width).all(|x| at(x, y) == at(0, if y < height / 2 { 0 } else { height - 1 }));
        let column =
            |x: usize| (0..height).all(|y| at(x, y) == at(if x < width / 2 { 0 } else { width - 1 }, 0));
        let [top, bottom] =
            [(0..height).take_while(|y| row(*y)).count(), (0..height).rev().take_while(|y| row(*y)).count()];
        let [left, right] = [
            (0..width).take_while(|x| column(*x)).count(),
            (0..width).rev().take_while(|x| column(*x)).count(),
        ];
        let size = [width.saturating_sub(left + right), height.saturating_sub(top + bottom)];
        let is_frame = top + bottom + left + right > 1
            && size[0] >= SIZE_MIN[0] as usize
            && size[1] >= SIZE_MIN[1] as usize;
        if is_frame {
            let rows = self.bytes.chunks(width).skip(top).take(size[1]);
            self.bytes = rows.flat_map(|row| &row[left..left + size[0]]).copied().collect();
            [self.width, self.height] = size.map(|side| side as u32);
            self.rows = self.height;
            self.notes.push(format!(
                "it has a frame, which was cut away; {} x {} pixels are left",
                size[0], size[1]
            ));
        }
    }

    /// Undoes scaling by a whole number, if all pixels of each square are equal.
    fn shrink(&mut self) {
        let [width, height] = [self.width as usize, self.height as usize];
        let is_scaled = |by: &usize| {
            let equals_first = |at: usize| {
                let (x, y) = (at % width, at / width);
                self.bytes[at] == self.bytes[y / by * by * width + x / by * by]
            };
            width.is_multiple_of(*by) && height.is_multiple_of(*by) && (0..width * height).all(equals_first)
        };
        let is_large = |by: &usize| width / by >= SIZE_MIN[0] as usize && height / by >= SIZE_MIN[1] as usize;
        if let Some(by) = (2..=8).rev().filter(is_large).find(is_scaled) {
            let rows = self.bytes.chunks(width).step_by(by);
            self.bytes = rows.flat_map(|row| row.iter().step_by(by)).copied().collect();
            [self.width, self.height] = [width / by, height / by].map(|side| side as u32);
            self.rows = self.height;
            self.notes.push(format!("its pixels are squares of {by} x {by}; they were compared as one each"));
        }
    }

    /// Whether more than single values are 0.
    pub fn has_zeros(&self) -> bool {
        self.bytes.as_flattened().iter().filter(|byte| **byte == 0).nth(5).is_some()
    }

    /// Bytes in a step of the file's values, at least 1.
    pub fn step(&self) -> f64 {
        (256.0 / (f64::from(self.most) + 1.0)).max(1.0)
    }
}
