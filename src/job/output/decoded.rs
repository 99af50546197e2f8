//! A picture as its file holds it, and what its values mean.

use crate::stages::Transfer;
use crate::system::memory;
use anyhow::{Result, ensure};

/// The meaning of integer values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// As Weekender and the book write them: the transfer, then `floor(256 v)`. With a maximum other than 255 or 65535,
    /// values may also be rounded.
    Book(Transfer),
    /// As in the book, but with this exponent.
    Gamma(f64),
    /// The curve of sRGB (IEC 61966-2-1), rounded, as most other programs write pictures.
    Srgb,
}

/// A fault of a file that was repaired when it was read.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Damage {
    pub title: String,
    pub remedy: &'static str,
}

impl Damage {
    pub(super) fn new(title: impl Into<String>, remedy: &'static str) -> Self {
        Damage { title: title.into(), remedy }
    }
}

/// The error of a file that ends before its last pixel.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{reason}")]
pub struct Incomplete {
    /// The pixels that it has, fewer than its size calls for.
    pub picture: Box<ReadPicture>,
    pub reason: String,
}

/// A picture as its file holds it, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadPicture {
    pub width: u32,
    pub height: u32,
    /// Name of the format, such as "P3".
    pub format: &'static str,
    pub values: Values,
    pub damages: Vec<Damage>,
    /// Omissions and assumptions of the reader.
    pub notes: Vec<String>,
    /// The meaning of integers according to the file.
    pub stated: Option<Encoding>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// RGB from 0 to `most`.
    Integers { most: u16, rgb: Vec<[u16; 3]> },
    /// Linear RGB, and which channels are stored in 16 bits.
    Floats { rgb: Vec<[f32; 3]>, halves: [bool; 3] },
}

/// The linear values of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// RGB. A channel at the top of its integer range is NaN, since it only gives a lower bound.
    pub pixels: Vec<[f64; 3]>,
    /// Largest quantisation error of each channel in either direction; `None` for 32-bit floats.
    pub steps: Option<Vec<[f64; 3]>>,
    /// The value from which channels are NaN; infinite for floats.
    pub limit: f64,
}

impl ReadPicture {
    /// `encoding` is the meaning of integers.
    pub fn linear(&self, encoding: Encoding) -> Linear {
        match &self.values {
            Values::Floats { rgb, halves } => {
                let step =
                    |pixel: &[f32; 3]| [0, 1, 2].map(|c| if halves[c] { half_step(pixel[c]) } else { 0.0 });
                Linear {
                    pixels: rgb.iter().map(|pixel| pixel.map(f64::from)).collect(),
                    steps: halves.contains(&true).then(|| rgb.iter().map(step).collect()),
                    limit: f64::INFINITY,
                }
            }
            Values::Integers { most, rgb } => {
                let (width, height) = (self.width as usize, self.height as usize);
                let intervals = rgb.iter().enumerate().map(|(index, triple)| {
                    triple.map(|value| encoding.interval(value, *most, index / width, height))
                });
                let halves =
                    |pixel: [[f64; 2]; 3], sign: f64| pixel.map(|[low, high]| 0.5 * (high + sign * low));
                let (pixels, steps) =
                    intervals.map(|pixel| (halves(pixel, 1.0), halves(pixel, -1.0))).unzip();
                let [limit, _] = encoding.ends(*most, *most, height - 1, height);
                Linear { pixels, steps: Some(steps), limit }
            }
        }
    }
}

/// Half the distance between a 16-bit float and its neighbours.
fn half_step(x: f32) -> f64 {
    let exponent = (x.to_bits() >> 23 & 0xff) as i32 - 127;
    f64::from(exponent.max(-14) - 11).exp2()
}

/// Largest number of pixels that is read.
pub(super) const PIXEL_LIMIT: u64 = 1 << 28;

/// Maximum memory per pixel while a picture is read: for the file's data, the decoded data, and the numbers with their
/// quantisation steps.
const BYTES_PER_PIXEL: u64 = 80;

/// Number of pixels, or an error if the size is out of range or the picture does not fit into memory, with `more` extra
/// bytes per pixel.
pub(super) fn pixel_count(width: u32, height: u32, more: u64) -> Result<usize> {
    let count = u64::from(width) * u64::from(height);
    ensure!(
        (1..=PIXEL_LIMIT).contains(&count),
        "its size is {width}x{height}; only 1 to {PIXEL_LIMIT} pixels can be read"
    );
    let what = || format!("a picture of {width}x{height} pixels");
    memory::check(what, count * (BYTES_PER_PIXEL + more), "close other programs or make it smaller")?;
    Ok(count as usize)
}

/// A note if some pixels are translucent.
pub(super) fn note_on_alpha(translucent: usize) -> Option<String> {
    let note = || format!("{translucent} of its pixels have an alpha other than 1, which is ignored");
    (translucent > 0).then(note)
}

/// A note if red, green, blue and white (CIE x, y) are not those of sRGB.
pub(super) fn note_on_primaries(found: [[f32; 2]; 4]) -> Option<String> {
    let usual = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
    let is_near = |(found, usual): (&f32, &f32)| (found - usual).abs() < 2e-3;
    let [x, y] = found[0];
    (!found.as_flattened().iter().zip(usual.as_flattened()).all(is_near)).then(|| {
        format!(
            "its colours are not those of sRGB (its red is at {x},{y} instead of 0.64,0.33); they are not converted"
        )
    })
}

impl Encoding {
    /// The interval of linear values that are stored as `value` of up to `most`. NaN for the largest value, which also
    /// stands for everything brighter.
    pub(super) fn interval(self, value: u16, most: u16, row: usize, height: usize) -> [f64; 2] {
        if value >= most { [f64::NAN; 2] } else { self.ends(value, most, row, height) }
    }

    /// The range of linear values that encode to `value` with maximum `most`, if nothing is brighter.
    fn ends(self, value: u16, most: u16, row: usize, height: usize) -> [f64; 2] {
        let ends = if self == Encoding::Srgb { rounded(value, most) } else { displayed(value, most) };
        ends.map(|end| self.linear(end.max(0.0), row, height))
    }

    /// How messages name it.
    pub fn name(self) -> String {
        match self {
            Encoding::Book(Transfer::Linear) => "linear".to_owned(),
            Encoding::Book(_) => "gamma2".to_owned(),
            Encoding::Gamma(exponent) => format!("of gamma {exponent:.3}"),
            Encoding::Srgb => "sRGB".to_owned(),
        }
    }

    /// The linear value of a displayed one, within `0..=1`.
    pub fn linear(self, displayed: f64, row: usize, height: usize) -> f64 {
        match self {
            Encoding::Book(transfer) if transfer.is_gamma(row, height) => displayed * displayed,
            Encoding::Book(_) => displayed,
            Encoding::Gamma(exponent) => displayed.powf(exponent),
            Encoding::Srgb if displayed <= 0.04045 => displayed / 12.92,
            Encoding::Srgb => ((displayed + 0.055) / 1.055).powf(2.4),
        }
    }

    /// The displayed value of a linear one.
    pub fn displayed(self, linear: f64, row: usize, height: usize) -> f64 {
        match self {
            Encoding::Book(transfer) if transfer.is_gamma(row, height) => linear.sqrt(),
            Encoding::Book(_) => linear,
            Encoding::Gamma(exponent) => linear.powf(1.0 / exponent),
            Encoding::Srgb if linear <= 0.003_130_8 => 12.92 * linear,
            Encoding::Srgb => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
        }
    }
}

/// The range of displayed values that a program following the book stores as `value`. It truncates to 8 or 16 bits;
/// with any other maximum it may also round.
pub fn displayed(value: u16, most: u16) -> [f64; 2] {
    let levels = f64::from(most) + 1.0;
    let [low, high] = [f64::from(value) / levels, (f64::from(value) + 1.0) / levels];
    if matches!(most, 0xff | 0xffff) {
        return [low, high];
    }
    let [rounded_low, rounded_high] = rounded(value, most);
    [low.min(rounded_low), high.max(rounded_high)]
}

fn rounded(value: u16, most: u16) -> [f64; 2] {
    [-0.5, 0.5].map(|part| (f64::from(value) + part) / f64::from(most))
}
