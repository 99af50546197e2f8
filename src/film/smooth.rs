//! A film with less noise and less detail, for previews.

use super::{Film, PixelSum};

/// Sum of the weights of a pixel and its two neighbours.
const WHOLE: u64 = 256;

/// The largest weight of a neighbour: 1, 2, 1 is the filter of a quadratic B-spline.
const SIDE: u64 = WHOLE / 4;

/// Films with at most this many samples per pixel are smoothed fully; with more samples, less and less.
const FEW: u64 = 4;

/// Films with at least this many samples per pixel are not smoothed.
const MANY: u64 = FEW * SIDE;

impl Film {
    /// Averages each pixel with its neighbours, less the more samples it has. The filter is separable and adds linear
    /// radiance, so the picture does not get darker.
    pub fn smoothed(&self) -> Film {
        let mut smooth = self.clone();
        let samples = self.sample_count();
        if samples >= MANY {
            return smooth;
        }
        let side = SIDE * FEW / samples.max(FEW);
        let [width, height] = [self.width as usize, self.height as usize];
        for half in &mut smooth.halves {
            (0..height).for_each(|row| smooth_line(half, row * width, 1, width, side));
            (0..width).for_each(|column| smooth_line(half, column, width, height, side));
        }
        smooth
    }
}

/// Averages `count` pixels with their neighbours. The first and the last are their own neighbours.
fn smooth_line(sums: &mut [PixelSum], start: usize, stride: usize, count: usize, side: u64) {
    let mut before = sums[start];
    for index in 0..count {
        let at = start + index * stride;
        let here = sums[at];
        let after = if index + 1 < count { sums[at + stride] } else { here };
        sums[at] = average([before, here, after], side);
        before = here;
    }
}

/// The mean of a pixel and its two neighbours, each weighted by `side`.
fn average([before, here, after]: [PixelSum; 3], side: u64) -> PixelSum {
    PixelSum([0, 1, 2].map(|channel| {
        let sides = before.0[channel] + after.0[channel];
        (here.0[channel] * (WHOLE - 2 * side) + sides * side + WHOLE / 2) / WHOLE
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A black film of one half, except for one pixel with this sum.
    fn dot(width: u32, height: u32, at: usize, sum: u64, samples: u64) -> Film {
        let mut film = Film::new(width, height);
        film.halves_mut()[0][at] = PixelSum([sum, 0, sum / 2]);
        film.record(0..samples, 0).unwrap();
        film
    }

    fn red(film: &Film) -> Vec<u64> {
        film.halves()[0].iter().map(|sum| sum.0[0]).collect()
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

    #[test]
    fn both_halves_are_smoothed_and_edges_repeat() {
        let mut film = Film::new(4, 3);
        film.halves_mut()[0][6] = PixelSum([1600, 0, 0]);
        film.halves_mut()[1][0] = PixelSum([1600, 0, 0]);
        film.record(0..2, 0).unwrap();
        let smooth = film.smoothed();
        let [inner, corner] = [0, 1].map(|half: usize| smooth.halves()[half].iter().map(|sum| sum.0[0]));
        assert!(inner.eq([0, 100, 200, 100, 0, 200, 400, 200, 0, 100, 200, 100]));
        // Three quarters stay in the corner along each direction.
        assert!(corner.eq([900, 300, 0, 0, 300, 100, 0, 0, 0, 0, 0, 0]));
    }
}
