//! How often each brightness occurs in a picture.

use super::Film;

/// Bins per stop. Within a stop, bins are equally wide.
const BINS_PER_STOP: usize = 4;

/// The stops that have bins: from `2^LOWEST` up to `2^HIGHEST`, linear radiance.
const LOWEST: i32 = -12;
const HIGHEST: i32 = 8;

const BINS: usize = (HIGHEST - LOWEST) as usize * BINS_PER_STOP;

/// Half a step of 8 bits. Values that exceed white by less, as rounding and denoising make them of white sky, lose nothing.
const HALF_STEP: f64 = 0.5 / 255.0;

/// Counts of pixels by linear radiance, for each channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Counts per bin, red, green and blue, from dark to bright. Darker and brighter values are in the outer bins.
    pub bins: [Vec<u32>; 3],
    pub pixels: u32,
    /// Pixels with a channel above white.
    pub clipped: u32,
    /// The largest value of any channel.
    pub largest: f64,
}

impl Histogram {
    /// The lowest and the highest stop.
    pub const STOPS: [f64; 2] = [LOWEST as f64, HIGHEST as f64];

    /// Counts the pixels of a film. `white` is the radiance that is shown as white.
    pub fn of(film: &Film, white: f64) -> Self {
        let mut bins = [0, 1, 2].map(|_| vec![0; BINS]);
        let (mut clipped, mut largest) = (0, 0.0_f64);
        let pixels = film.width() * film.height();
        for pixel in 0..pixels as usize {
            let mean = film.mean(pixel);
            for (bins, value) in bins.iter_mut().zip(mean) {
                bins[bin(value)] += 1;
            }
            let brightest = mean.into_iter().fold(0.0, f64::max);
            clipped += u32::from(brightest > white * (1.0 + HALF_STEP));
            largest = largest.max(brightest);
        }
        Histogram { bins, pixels, clipped, largest }
    }

    /// The stop at which a bin begins.
    pub fn stop_of(bin: usize) -> f64 {
        let within = (bin % BINS_PER_STOP) as f64 / BINS_PER_STOP as f64;
        f64::from(LOWEST) + (bin / BINS_PER_STOP) as f64 + (1.0 + within).log2()
    }
}

/// The bin of a value, from the exponent and the first bits of the fraction of its binary form.
fn bin(value: f64) -> usize {
    const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;
    // Zero and values below the range have the smallest exponents.
    let rank = (value.max(0.0).to_bits() >> (FRACTION_BITS - BINS_PER_STOP.ilog2())) as i64;
    let first = (i64::from(LOWEST) + 1023) * BINS_PER_STOP as i64;
    (rank - first).clamp(0, BINS as i64 - 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PixelSum;

    #[test]
    fn bin_starts_match_their_stops() {
        for number in 0..BINS {
            let begin = Histogram::stop_of(number).exp2();
            assert_eq!(bin(begin * (1.0 + 1e-9)), number);
            assert_eq!(bin(begin * (1.0 - 1e-9)), number.saturating_sub(1));
        }
        assert_eq!([0.0, -1.0, 1e-300, 1e9, f64::INFINITY].map(bin), [0, 0, 0, BINS - 1, BINS - 1]);
    }

    #[test]
    fn pixels_are_counted_by_channel() {
        let mut film = Film::new(2, 1, 1);
        film.halves_mut()[0][0] = PixelSum([1 << 24, 1 << 25, 1 << 22]);
        film.halves_mut()[0][1] = PixelSum([1 << 24, 0, 1 << 22]);
        film.record(0..1, 0).unwrap();
        let histogram = Histogram::of(&film, 2.0);
        let at = |channel: usize, value: f64| histogram.bins[channel][bin(value)];
        assert_eq!([at(0, 1.0), at(1, 2.0), at(1, 0.0), at(2, 0.25)], [2, 1, 1, 2]);
        assert!(histogram.bins.iter().all(|bins| bins.iter().sum::<u32>() == 2));
        assert_eq!((histogram.pixels, histogram.clipped, histogram.largest), (2, 0, 2.0));
        let clipped = |white: f64| Histogram::of(&film, white).clipped;
        assert_eq!([0.5, 1.0, 1.99].map(clipped), [2, 1, 1], "white itself loses nothing");
    }
}
