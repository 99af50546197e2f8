//! A film with less noise and less detail, for previews.

use super::{Film, PixelSum};

/// The weights of a pixel and its two neighbours add up to this.
const WHOLE: u64 = 256;

/// The largest weight of a neighbour: 1, 2, 1 is the filter of a quadratic B-spline.
const SIDE: u64 = WHOLE / 4;

/// Up to this many samples per pixel a film is smoothed as much as possible, and with more of them less and less.
const FEW: u64 = 4;

/// From this many samples per pixel on, a film is not smoothed.
const MANY: u64 = FEW * SIDE;

impl Film {
    /// The film with each pixel averaged with its neighbours, the less the more samples it has. The filter is separable
    /// and adds up linear radiance, so the picture does not become darker.
    pub fn smoothed(&self) -> Film {
        let mut smooth = self.clone();
        let samples = self.sample_count();
        if samples >= MANY {
            return smooth;
        }
        let side = SIDE * FEW / samples.max(FEW);
        let width = self.width as usize;
        for half in &mut smooth.halves {
            for row in half.chunks_exact_mut(width.max(1)) {
                filter(row, 1, side);
            }
            for column in 0..width {
                filter(&mut half[column..], width, side);
            }
        }
        smooth
    }
}

/// Averages each `stride`th of `sums` with its neighbours. The first and the last one are their own neighbours.
fn filter(sums: &mut [PixelSum], stride: usize, side: u64) {
    let Some(mut before) = sums.first().map(|sum| sum.0) else { return };
    let last = (sums.len() - 1) / stride * stride;
    for place in (0..=last).step_by(stride) {
        let (here, after) = (sums[place].0, sums[(place + stride).min(last)].0);
        let average = |channel: usize| {
            let sides = before[channel] + after[channel];
            (here[channel] * (WHOLE - 2 * side) + sides * side + WHOLE / 2) / WHOLE
        };
        sums[place].0 = [average(0), average(1), average(2)];
        before = here;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A film of one half in which all pixels are black but one, which has this sum.
    fn dot(width: u32, height: u32, at: usize, sum: u64, samples: u64) -> Film {
        let mut film = Film::new(width, height, 1);
        film.halves_mut()[0][at] = PixelSum([sum, 0, sum / 2]);
        film.record(0..samples, 0).unwrap();
        film
    }

    fn red(film: &Film) -> Vec<u64> {
        film.halves()[0].iter().map(|sum| sum.0[0]).collect()
    }

    #[test]
    fn a_dot_spreads_over_its_neighbours() {
        let smooth = dot(3, 3, 4, 1600, 1).smoothed();
        assert_eq!(red(&smooth), [100, 200, 100, 200, 400, 200, 100, 200, 100]);
        assert_eq!(smooth.halves()[0][4].0, [400, 0, 200]);
        assert_eq!(smooth.sample_count(), 1);
    }

    #[test]
    fn no_light_is_lost_at_the_edges() {
        for (width, height, at) in [(5, 4, 0), (5, 4, 19), (5, 4, 7), (1, 1, 0), (1, 6, 5), (6, 1, 0)] {
            let smooth = dot(width, height, at, 256_000, 2).smoothed();
            let sum: u64 = red(&smooth).iter().sum();
            assert!(sum.abs_diff(256_000) < 20, "{width}x{height}, {at}: {sum}");
        }
    }

    #[test]
    fn many_samples_need_no_filter() {
        let middle = |samples| red(&dot(3, 3, 4, 1 << 20, samples).smoothed())[4];
        assert_eq!(middle(4), 1 << 18);
        assert!(middle(8) > middle(4) && middle(64) > middle(16) && middle(64) > (9 << 20) / 10);
        let fine = dot(3, 3, 4, 1 << 20, 256);
        assert_eq!(fine.smoothed(), fine);
    }
}
