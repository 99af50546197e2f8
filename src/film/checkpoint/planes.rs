//! The channels of a film file, and the conversion of sums to words and back.

use super::head::Head;
use super::{DENOISED_LAYER, Film, PixelSum};
use crate::film::SIZE_LIMIT;
use exr::block::UncompressedBlock;
use exr::meta::BlockDescription;
use exr::meta::attribute::ChannelList;
use exr::meta::header::Header;
use exr::prelude::{ChannelDescription, Compression, SampleType, Text, Vec2};

/// The content of a channel.
#[derive(Clone, Copy)]
pub(super) enum Plane {
    /// The picture.
    Mean { colour: usize },
    /// A denoised picture, which is not part of the film and not read.
    Denoised { colour: usize },
    /// Words of the sums of the first half. Those of the second follow from the others.
    Sum { colour: usize, shift: u32 },
    /// Words of the rest: see [`mean_and_rest`].
    Rest { colour: usize, shift: u32 },
}

/// The channels of a film, sorted by name as the format requires, and what they hold.
pub(super) fn channels(is_denoised: bool) -> Vec<(ChannelDescription, Plane)> {
    let mut channels = Vec::new();
    let mut add = |name: &str, sample_type, plane| {
        let name = Text::from_slice_unchecked(name.as_bytes());
        channels.push((ChannelDescription::new(name, sample_type, false), plane));
    };
    for (colour, name) in ["R", "G", "B"].into_iter().enumerate() {
        add(name, SampleType::F32, Plane::Mean { colour });
        if is_denoised {
            add(&format!("{DENOISED_LAYER}.{name}"), SampleType::F32, Plane::Denoised { colour });
        }
        for (shift, word) in [(0, "lo"), (32, "hi")] {
            add(&format!("rest.{name}.{word}"), SampleType::U32, Plane::Rest { colour, shift });
            add(&format!("sum.a.{name}.{word}"), SampleType::U32, Plane::Sum { colour, shift });
        }
    }
    channels.sort_by(|a, b| a.0.name.cmp(&b.0.name));
    channels
}

/// What each channel of the file holds, if the layout is that of a film.
pub(super) fn find(header: &Header, head: &Head) -> Result<Vec<Plane>, String> {
    let Vec2(columns, rows) = header.layer_size;
    if (head.width as usize, head.height as usize) != (columns, rows) {
        let [width, height] = [head.width, head.height];
        return Err(format!("it has {columns}x{rows} pixels, but its head says {width}x{height}"));
    }
    if [head.width, head.height].iter().any(|side| !(1..=SIZE_LIMIT).contains(side)) {
        return Err(format!("it has {columns}x{rows} pixels, but each side of a film has 1 to {SIZE_LIMIT}"));
    }
    if header.deep || header.blocks != BlockDescription::ScanLines || header.compression != Compression::RLE {
        return Err("its pixels are not stored as those of a film".to_owned());
    }
    let list = &header.channels.list;
    let is_denoised =
        list.iter().any(|channel| channel.name.as_slice().starts_with(DENOISED_LAYER.as_bytes()));
    let known = channels(is_denoised);
    let is_known = |(found, (known, _)): (&ChannelDescription, &(ChannelDescription, Plane))| {
        (&found.name, found.sample_type) == (&known.name, known.sample_type)
    };
    if list.len() != known.len() || !list.iter().zip(&known).all(is_known) {
        let names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
        return Err(format!("its channels are not those of a film: {}", names.join(", ")));
    }
    Ok(known.into_iter().map(|(_, plane)| plane).collect())
}

/// The mean of `sum` as stored in the picture. `unit` is [`Film::fixed_point_of_1`].
fn mean(sum: u64, unit: f64) -> f32 {
    (sum as f64 / unit) as f32
}

/// The mean of a sum and its rest: what rounding the mean loses. The rest is small, so most of its bytes are zero and
/// compress to nothing. Its lowest bit is its sign.
fn mean_and_rest(sum: u64, unit: f64) -> (f32, u64) {
    let mean = mean(sum, unit);
    let lost = (sum as i64).wrapping_sub(from_mean(mean, unit));
    (mean, ((lost << 1) ^ (lost >> 63)) as u64)
}

/// Inverse of [`mean_and_rest`].
fn sum_of(mean: f32, rest: u64, unit: f64) -> u64 {
    let lost = (rest >> 1) as i64 ^ -((rest & 1) as i64);
    from_mean(mean, unit).wrapping_add(lost) as u64
}

/// One product and one rounding in `f64`, which give the same result on every processor.
fn from_mean(mean: f32, unit: f64) -> i64 {
    (f64::from(mean) * unit).round_ties_even() as i64
}

/// A pixel as a film file holds it.
#[derive(Clone, Copy, Default)]
struct Stored {
    means: [u32; 3],
    rests: [u64; 3],
    /// The sums of the first half.
    first: [u64; 3],
}

/// One row of a film as its file holds it.
pub(super) struct Row {
    pixels: Vec<Stored>,
    words: Vec<u32>,
}

impl Row {
    pub fn new(width: usize) -> Self {
        Row { pixels: vec![Stored::default(); width], words: vec![0; width] }
    }

    pub fn read(
        &mut self,
        block: &UncompressedBlock,
        channels: &ChannelList,
        planes: &[Plane],
    ) -> Result<(), exr::error::Error> {
        self.pixels.fill(Stored::default());
        for line in block.lines(channels) {
            line.read_samples_into_slice(&mut self.words)?;
            let plane = planes[line.location.channel];
            for (pixel, word) in self.pixels.iter_mut().zip(&self.words) {
                match plane {
                    Plane::Mean { colour } => pixel.means[colour] = *word,
                    Plane::Denoised { .. } => {}
                    Plane::Sum { colour, shift } => pixel.first[colour] |= u64::from(*word) << shift,
                    Plane::Rest { colour, shift } => pixel.rests[colour] |= u64::from(*word) << shift,
                }
            }
        }
        Ok(())
    }

    /// Appends the sums of the row to each half, and returns whether they match the picture.
    pub fn append_sums(&self, unit: f64, [a, b]: &mut [Vec<PixelSum>; 2]) -> bool {
        let mut matches = true;
        for Stored { means, rests, first } in &self.pixels {
            let totals = [0, 1, 2].map(|colour| sum_of(f32::from_bits(means[colour]), rests[colour], unit));
            let last = [0, 1, 2].map(|colour| totals[colour].wrapping_sub(first[colour]));
            // A half larger than both together comes from wrapping.
            matches &= (0..3).all(|colour| {
                last[colour] <= totals[colour] && mean(totals[colour], unit).to_bits() == means[colour]
            });
            a.push(PixelSum(*first));
            b.push(PixelSum(last));
        }
        matches
    }
}

/// Appends a row of `film`, and of its denoised picture: the words of each channel in turn.
pub(super) fn append_row(
    film: &Film,
    denoised: Option<&Film>,
    channels: &[(ChannelDescription, Plane)],
    row: usize,
    data: &mut Vec<u8>,
) {
    let (width, unit) = (film.width() as usize, film.fixed_point_of_1());
    let pixels = row * width..(row + 1) * width;
    let totals: Vec<[(f32, u64); 3]> =
        pixels.clone().map(|pixel| film.pixel_sum(pixel).0.map(|sum| mean_and_rest(sum, unit))).collect();
    for (_, plane) in channels {
        match *plane {
            Plane::Mean { colour } => {
                data.extend(totals.iter().flat_map(|total| total[colour].0.to_ne_bytes()));
            }
            Plane::Denoised { colour } => {
                let mean = |pixel: usize| denoised.map_or(0.0, |film| film.mean(pixel)[colour] as f32);
                data.extend(pixels.clone().flat_map(|pixel| mean(pixel).to_ne_bytes()));
            }
            Plane::Rest { colour, shift } => {
                data.extend(
                    totals.iter().flat_map(|total| ((total[colour].1 >> shift) as u32).to_ne_bytes()),
                );
            }
            Plane::Sum { colour, shift } => {
                let sums = film.halves()[0][pixels.clone()].iter();
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
    fn a_half_larger_than_both_together_is_damage() {
        let unit = Film::fixed_point(16);
        let (mean, rest) = mean_and_rest(1000, unit);
        for (first, matches) in [(0, true), (1000, true), (1001, false), (u64::MAX, false)] {
            let mut row = Row::new(1);
            row.pixels[0] = Stored { means: [mean.to_bits(); 3], rests: [rest; 3], first: [first; 3] };
            assert_eq!(row.append_sums(unit, &mut [vec![], vec![]]), matches, "{first}");
        }
    }

    #[test]
    fn the_rest_of_usual_sums_is_short() {
        let (samples, radiance) = (65_536_u64, 0.7371);
        let sum = (radiance * samples as f64 * 16_777_216.0) as u64 + 1;
        assert!(mean_and_rest(sum, Film::fixed_point(samples)).1 < 1 << 17);
    }
}
