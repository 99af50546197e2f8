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
            for row in half.chunks_exact_mut(width) {
                along(row, side);
            }
            down(half, width, side);
        }
        smooth
    }
}

/// Averages the pixels of a row with those beside them. The first and the last one are their own neighbours.
fn along(row: &mut [PixelSum], side: u64) {
    let Some(mut before) = row.first().copied() else { return };
    for x in 0..row.len() {
        let here = row[x];
        row[x] = average([before, here, row.get(x + 1).copied().unwrap_or(here)], side);
        before = here;
    }
}

/// Averages the pixels of rows of this width with those above and below.
fn down(rows: &mut [PixelSum], width: usize, side: u64) {
    let mut before = rows[..width].to_vec();
    for start in (0..rows.len()).step_by(width) {
        for (x, above) in before.iter_mut().enumerate() {
            let here = rows[start + x];
            let below = rows.get(start + width + x).copied().unwrap_or(here);
            rows[start + x] = average([*above, here, below], side);
            *above = here;
        }
    }
}

/// The mean of a pixel and its two neighbours, each of which has the weight `side`.
fn average([before, here, after]: [PixelSum; 3], side: u64) -> PixelSum {
    PixelSum([0, 1, 2].map(|channel| {
        let sides = before.0[channel] + after.0[channel];
        (here.0[channel] * (WHOLE - 2 * side) + sides * side + WHOLE / 2) / WHOLE
    }))
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

    #[test]
    fn both_halves_of_any_shape_are_smoothed_and_an_edge_is_its_own_neighbour() {
        let mut film = Film::new(4, 3, 2);
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
