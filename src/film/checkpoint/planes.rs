//! What the channels of a film file hold, and how sums become words and come back.

use super::head::Head;
use crate::film::{Film, PixelSum, SIZE_LIMIT};
use exr::meta::BlockDescription;
use exr::meta::header::Header;
use exr::prelude::{Compression, SampleType};

/// What a channel contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plane {
    /// The picture.
    Mean { colour: usize },
    /// Words of the sums of a half.
    Sum { half: usize, colour: usize, shift: u32 },
    /// Words of the rest: see [`mean_and_rest`].
    Rest { colour: usize, shift: u32 },
}

impl Plane {
    /// All planes of a film with `half_count` halves, with their channel names. In version 3 each half had its sums;
    /// since version 4 the sums of the last half follow from the picture, the rest and the other half.
    pub fn all(version: u32, half_count: usize) -> Vec<(String, Plane)> {
        let mut planes = Vec::new();
        let has_rest = version > 3;
        for (colour, name) in ["R", "G", "B"].into_iter().enumerate() {
            planes.push((name.to_owned(), Plane::Mean { colour }));
            for (shift, word) in [(0, "lo"), (32, "hi")] {
                let halves = ["a", "b"].into_iter().enumerate().take(half_count - usize::from(has_rest));
                planes.extend(halves.map(|(half, half_name)| {
                    (format!("sum.{half_name}.{name}.{word}"), Plane::Sum { half, colour, shift })
                }));
                if has_rest {
                    planes.push((format!("rest.{name}.{word}"), Plane::Rest { colour, shift }));
                }
            }
        }
        planes
    }

    pub fn sample_type(self) -> SampleType {
        match self {
            Plane::Mean { .. } => SampleType::F32,
            Plane::Sum { .. } | Plane::Rest { .. } => SampleType::U32,
        }
    }

    /// The plane that each channel of the file holds, if the layout is that of a film.
    pub fn find(header: &Header, head: &Head) -> Result<Vec<Plane>, String> {
        let (columns, rows) = (header.layer_size.x(), header.layer_size.y());
        if (head.width as usize, head.height as usize) != (columns, rows) {
            return Err(format!(
                "it has {columns}x{rows} pixels, but its head says {}x{}",
                head.width, head.height
            ));
        }
        if !(1..=SIZE_LIMIT).contains(&head.width) || !(1..=SIZE_LIMIT).contains(&head.height) {
            return Err(format!(
                "its size is {columns}x{rows}, but each side must have 1 to {SIZE_LIMIT} pixels"
            ));
        }
        let is_film = header.blocks == BlockDescription::ScanLines && header.compression == Compression::RLE;
        if header.deep || !is_film {
            return Err("its pixels are not stored as those of a film".to_owned());
        }
        let known = Plane::all(head.version, head.halves);
        let channels = &header.channels.list;
        for (name, plane) in &known {
            let channel = channels.iter().find(|channel| channel.name.as_slice() == name.as_bytes());
            let channel = channel.ok_or_else(|| format!("the channel {name} is missing"))?;
            if channel.sample_type != plane.sample_type() || channel.sampling.area() != 1 {
                return Err(format!("the channel {name} has the wrong type"));
            }
        }
        let found = channels.iter().map(|channel| {
            let plane = known.iter().find(|(name, _)| channel.name.as_slice() == name.as_bytes());
            plane.map(|(_, plane)| *plane).ok_or_else(|| format!("a film has no channel {}", channel.name))
        });
        let planes = found.collect::<Result<Vec<_>, _>>()?;
        if planes.len() != known.len() {
            return Err(format!("it has {} channels, but a film has {}", planes.len(), known.len()));
        }
        Ok(planes)
    }
}

/// The mean of `sum` as stored in the picture. `unit` is [`Film::fixed_point_of_1`].
pub(super) fn mean(sum: u64, unit: f64) -> f32 {
    (sum as f64 / unit) as f32
}

/// The mean of a sum, and what the mean has lost of it by its rounding: the rest, which is small, so that most of its
/// bytes are zero and cost nothing in the file. The lowest bit of the rest is its sign.
pub(super) fn mean_and_rest(sum: u64, unit: f64) -> (f32, u64) {
    let mean = mean(sum, unit);
    let lost = (sum as i64).wrapping_sub(from_mean(mean, unit));
    (mean, ((lost << 1) ^ (lost >> 63)) as u64)
}

/// The sum of a mean and its rest: see [`mean_and_rest`].
pub(super) fn sum_of(mean: f32, rest: u64, unit: f64) -> u64 {
    let lost = (rest >> 1) as i64 ^ -((rest & 1) as i64);
    from_mean(mean, unit).wrapping_add(lost) as u64
}

/// One product and one rounding in `f64`, which are the same on every processor.
fn from_mean(mean: f32, unit: f64) -> i64 {
    (f64::from(mean) * unit).round_ties_even() as i64
}

/// One row of a film as its file holds it.
pub(super) struct Row {
    pub means: Vec<[u32; 3]>,
    pub rests: Vec<[u64; 3]>,
}

impl Row {
    pub fn new(width: usize) -> Self {
        Row { means: vec![[0; 3]; width], rests: vec![[0; 3]; width] }
    }

    /// Takes the words of a channel. Sums go to the row's part of each half.
    pub fn take(&mut self, plane: Plane, words: &[u32], halves: &mut [&mut [PixelSum]]) {
        match plane {
            Plane::Mean { colour } => {
                self.means.iter_mut().zip(words).for_each(|(mean, word)| mean[colour] = *word);
            }
            Plane::Sum { half, colour, shift } => {
                for (sum, word) in halves[half].iter_mut().zip(words) {
                    sum.0[colour] |= u64::from(*word) << shift;
                }
            }
            Plane::Rest { colour, shift } => {
                for (rest, word) in self.rests.iter_mut().zip(words) {
                    rest[colour] |= u64::from(*word) << shift;
                }
            }
        }
    }

    /// Completes the sums of the row, if the file has their rest, and tells whether they match the picture.
    pub fn finish(&mut self, has_rest: bool, unit: f64, halves: &mut [&mut [PixelSum]]) -> bool {
        let Some((last, others)) = halves.split_last_mut() else { return false };
        let mut matches = true;
        for (pixel, (means, rests)) in self.means.iter().zip(&self.rests).enumerate() {
            for colour in 0..3 {
                let other = others.iter().fold(0_u64, |sum, half| sum.wrapping_add(half[pixel].0[colour]));
                let own = &mut last[pixel].0[colour];
                let total = if has_rest {
                    let total = sum_of(f32::from_bits(means[colour]), rests[colour], unit);
                    *own = total.wrapping_sub(other);
                    total
                } else {
                    other.wrapping_add(*own)
                };
                // A half that is larger than both together was made by wrapping.
                matches &= *own <= total && mean(total, unit).to_bits() == means[colour];
            }
        }
        self.rests.fill([0; 3]);
        matches
    }
}

/// Appends a row of `film`: the words of each channel in turn.
pub(super) fn append_row(film: &Film, planes: &[(String, Plane)], row: usize, data: &mut Vec<u8>) {
    let (width, unit) = (film.width() as usize, film.fixed_point_of_1());
    let pixels = row * width..(row + 1) * width;
    let totals: Vec<[(f32, u64); 3]> =
        pixels.clone().map(|pixel| film.pixel_sum(pixel).0.map(|sum| mean_and_rest(sum, unit))).collect();
    for (_, plane) in planes {
        match *plane {
            Plane::Mean { colour } => {
                data.extend(totals.iter().flat_map(|total| total[colour].0.to_ne_bytes()));
            }
            Plane::Rest { colour, shift } => {
                data.extend(
                    totals.iter().flat_map(|total| ((total[colour].1 >> shift) as u32).to_ne_bytes()),
                );
            }
            Plane::Sum { half, colour, shift } => {
                let sums = film.halves()[half][pixels.clone()].iter();
                data.extend(sums.flat_map(|sum| ((sum.0[colour] >> shift) as u32).to_ne_bytes()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn mean_and_rest_give_back_the_sum(sum in 0..u64::MAX / 2, bits in 0_u32..63, samples in 1_u64..1 << 32) {
            let (sum, unit) = (sum >> bits, Film::fixed_point(samples));
            let (mean, rest) = mean_and_rest(sum, unit);
            prop_assert_eq!(sum_of(mean, rest, unit), sum);
        }
    }

    #[test]
    fn the_rest_of_usual_sums_is_short() {
        let (samples, radiance) = (65_536_u64, 0.7371);
        let sum = (radiance * samples as f64 * 16_777_216.0) as u64 + 1;
        assert!(mean_and_rest(sum, Film::fixed_point(samples)).1 < 1 << 17);
    }
}
