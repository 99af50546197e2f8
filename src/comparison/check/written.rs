//! How linear values become the bytes of a file, and back.

use super::Mine;
use crate::job::output::Encoding;
use crate::job::recipe::Recipe;
use crate::numbers::statistics::normal::distribution;

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Written {
    pub order: Order,
    /// Source channels of the written red, green and blue.
    pub channels: [usize; 3],
    /// The curve from linear to displayed values.
    pub curve: Encoding,
    /// Factor from displayed values to bytes.
    pub levels: f64,
    /// Whether values are rounded instead of truncated.
    pub rounds: bool,
    /// Whether 256 becomes 0 instead of 255.
    pub wraps: bool,
    /// Whether pixels of which a sample is not a number are black, so that black ones say nothing.
    pub blackens: bool,
}

/// The order of the numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Rows,
    Flipped,
    Mirrored,
    Rotated,
    /// Column by column, though the header has the right size.
    Columns,
    /// The header has width and height exchanged.
    Exchanged,
    /// Rows and columns exchanged, in the header as well.
    Transposed,
    /// All red values, then all green ones, then all blue ones.
    Planar,
    /// One pixel more in each row than the header says.
    Long,
    /// One pixel less.
    Short,
    /// Each row is filled up to a multiple of four bytes.
    Padded,
}

impl Order {
    /// Index of the picture's value that is the file's value `index`; `None` if that is not part of the picture. `size`
    /// is that of the file.
    pub fn source(self, index: usize, [width, height]: [usize; 2]) -> Option<usize> {
        let (pixel, channel) = (index / 3, index % 3);
        let (x, y) = (pixel % width, pixel / width);
        let at = |x: usize, y: usize| Some(3 * (y * width + x) + channel);
        let in_rows_of = |length: usize| (pixel % length, pixel / length);
        match self {
            Order::Rows | Order::Exchanged => Some(index),
            Order::Flipped => at(x, height - 1 - y),
            Order::Mirrored => at(width - 1 - x, y),
            Order::Rotated => at(width - 1 - x, height - 1 - y),
            Order::Columns => at(pixel / height, pixel % height),
            Order::Transposed => Some(3 * (x * height + y) + channel),
            Order::Planar => Some(3 * (index % (width * height)) + index / (width * height)),
            Order::Long => {
                let (x, y) = in_rows_of(width + 1);
                if x < width { at(x, y) } else { None }
            }
            Order::Short => {
                let (x, y) = in_rows_of(width - 1);
                if y < height { at(x, y) } else { None }
            }
            Order::Padded => {
                let row = (3 * width).next_multiple_of(4);
                let (x, y) = (index % row, index / row);
                (x < 3 * width).then_some(y * 3 * width + x)
            }
        }
    }

    /// Whether the picture is as wide as the file is high.
    pub fn exchanges_sides(self) -> bool {
        matches!(self, Order::Exchanged | Order::Transposed)
    }
}

/// Differences that count as equal where some pixels are ignored, in linear and in display values.
pub const EQUAL: f64 = 0.015;

/// The reader's picture in linear values, as far as they are known; row by row from the top of what was rendered.
#[derive(Clone, Debug)]
pub struct Seen {
    pub size: [u32; 2],
    /// NaN where the file leaves the value open.
    pub values: Vec<[f64; 3]>,
    /// Bytes in a step of the file's values, at least 1.
    pub step: f64,
    /// Largest difference of means that is ignored, bytes.
    pub tolerance: f64,
}

impl Seen {
    /// The picture of a file with this encoding. `expected` tells which zeros are whites that wrapped around.
    pub fn of(mine: &Mine, written: &Written, expected: impl Fn(usize, usize) -> f64) -> Seen {
        let file = [mine.width as usize, mine.height as usize];
        let mut size = [mine.width, mine.height];
        if written.order.exchanges_sides() {
            size.reverse();
        }
        let mut values = vec![[f64::NAN; 3]; mine.bytes.len()];
        let levels: Vec<Levels> =
            (0..size[1] as usize).map(|row| Levels::new(written, row, size[1] as usize)).collect();
        let bytes = mine.bytes.as_flattened();
        for (index, byte) in bytes.iter().take(3 * (mine.rows * mine.width) as usize).enumerate() {
            let Some(source) = written.order.source(index, file) else { continue };
            let (pixel, channel) = (source / 3, written.channels[source % 3]);
            let Some(value) = values.get_mut(pixel) else { continue };
            if written.blackens && mine.bytes[index / 3] == [0; 3] {
                continue;
            }
            let byte = written.unwrapped(*byte, || expected(pixel, channel));
            value[channel] = levels[pixel / size[0] as usize].middles[usize::from(byte)];
        }
        for (value, _) in
            values.iter_mut().zip(mine.ignored.iter().flat_map(|all| all.iter())).filter(|(_, is)| **is)
        {
            *value = [f64::NAN; 3];
        }
        // Small spheres elsewhere still throw a little light.
        let tolerance = if mine.ignored.is_some() { 256.0 * EQUAL } else { 0.0 };
        Seen { size, values, step: mine.step(), tolerance }
    }
}

impl Written {
    pub fn right(recipe: &Recipe) -> Written {
        Written {
            order: Order::Rows,
            channels: [0, 1, 2],
            curve: Encoding::Book(recipe.rules.transfer),
            levels: 256.0,
            rounds: false,
            wraps: false,
            blackens: false,
        }
    }

    /// The linear value of a byte in a row, and half of its step.
    pub fn linear(&self, byte: u8, row: usize, height: usize) -> [f64; 2] {
        let (below, above) = if self.rounds { (-0.5, 0.5) } else { (0.0, 1.0) };
        let linear =
            |part: f64| self.curve.linear(((f64::from(byte) + part) / self.levels).max(0.0), row, height);
        [linear(f64::midpoint(below, above)), (linear(above) - linear(below)) / 2.0]
    }

    pub fn byte_of(&self, linear: f64, row: usize, height: usize) -> u8 {
        let displayed = self.curve.displayed(linear.max(0.0), row, height);
        (self.levels * displayed.min(0.999) + if self.rounds { 0.5 } else { 0.0 }) as u8
    }

    /// The byte that the reader's program had before it wrapped, judged by our picture.
    fn unwrapped(&self, byte: u8, expected: impl Fn() -> f64) -> u8 {
        if self.wraps && byte == 0 && expected() > 0.5 { 255 } else { byte }
    }

    /// Bytes in the layout of the file, row by row.
    pub fn bytes_of(&self, linear: &[[f64; 3]], [width, height]: [u32; 2]) -> Vec<[u8; 3]> {
        let byte = |index: usize, x: f64| self.byte_of(x, index / width as usize, height as usize);
        linear.iter().enumerate().map(|(index, pixel)| pixel.map(|x| byte(index, x))).collect()
    }

    /// Rearranges the linear picture to the layout of the file.
    pub fn laid_out(&self, linear: &[[f64; 3]], size: [u32; 2]) -> Vec<[f64; 3]> {
        let mut size = size.map(|side| side as usize);
        if self.order.exchanges_sides() {
            size.reverse();
        }
        let value = |index: usize| {
            let source = self.order.source(index, size)?;
            Some(linear.get(source / 3)?[self.channels[source % 3]])
        };
        let pixel = |pixel: usize| [0, 1, 2].map(|channel| value(3 * pixel + channel).unwrap_or(0.0));
        (0..linear.len()).map(pixel).collect()
    }
}

/// What the bytes of a row stand for.
pub struct Levels {
    written: Written,
    row: usize,
    height: usize,
    /// The linear value in the middle of each byte.
    middles: [f64; 256],
}

impl Levels {
    pub fn new(written: &Written, row: usize, height: usize) -> Levels {
        let middles = std::array::from_fn(|byte| written.linear(byte as u8, row, height)[0]);
        Levels { written: *written, row, height, middles }
    }

    /// The linear value that the largest byte stands for.
    pub fn most(&self) -> f64 {
        self.middles[255]
    }

    /// A linear value in bytes, before they are cut to whole numbers.
    fn real(&self, linear: f64) -> f64 {
        let rounding = if self.written.rounds { 0.5 } else { 0.0 };
        self.written.levels * self.written.curve.displayed(linear.max(0.0), self.row, self.height) + rounding
    }

    /// The linear radiance of one byte at this value.
    pub fn step(&self, linear: f64) -> f64 {
        // The darkest have almost none.
        let byte = self.real(linear).clamp(4.0, 255.0) as u8;
        2.0 * self.written.linear(byte, self.row, self.height)[1]
    }

    /// The mean and the variance of what bytes stand for, whose values scatter around `linear` by `deviation`, both
    /// linear.
    pub fn expected(&self, linear: f64, deviation: f64) -> [f64; 2] {
        /// From here on, rounding is noise, and not a staircase.
        const NOISE: f64 = 1.5;
        let (real, step) = (self.real(linear), self.step(linear));
        // In the dark, even a little noise has many levels.
        if deviation > NOISE * step && linear + 3.0 * deviation < self.most() {
            return [linear, deviation * deviation + step * step / 12.0];
        }
        let deviation = deviation / step;
        let reach = 5.0 * deviation;
        let [first, last] = [real - reach, real + reach].map(|end| end.clamp(0.0, 255.0) as usize);
        if first == last {
            return [self.middles[first], 0.0];
        }
        let (mut below, mut mean, mut square) = (0.0, 0.0, 0.0);
        for (byte, value) in self.middles.iter().enumerate().take(last + 1).skip(first) {
            let next = if byte == last { 1.0 } else { distribution(((byte + 1) as f64 - real) / deviation) };
            mean += (next - below) * value;
            square += (next - below) * value * value;
            below = next;
        }
        [mean, (square - mean * mean).max(0.0)]
    }
}

/// The mean of each square of `factor` x `factor` pixels, without incomplete squares.
pub fn reduced(pixels: &[[f64; 3]], width: usize, factor: usize) -> Vec<[f64; 3]> {
    if factor == 1 {
        return pixels.to_vec();
    }
    let (columns, rows) = (width / factor, pixels.len() / width / factor);
    let square = |place: usize| {
        let (x, y) = (place % columns * factor, place / columns * factor);
        let inside = (y..y + factor).flat_map(|y| (x..x + factor).map(move |x| y * width + x));
        let mut sum = [0.0; 3];
        for pixel in inside {
            (0..3).for_each(|channel| sum[channel] += pixels[pixel][channel]);
        }
        sum.map(|sum| sum / (factor * factor) as f64)
    };
    (0..columns * rows).map(square).collect()
}
