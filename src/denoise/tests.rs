use super::*;
use crate::film::RADIANCE_LIMIT;
use proptest::prelude::*;

/// A film of two halves, with these means.
fn film(size: [usize; 2], counts: [u64; 2], mean: impl Fn(usize, usize, usize) -> [f64; 3]) -> Film {
    let mut film = Film::new(size[0] as u32, size[1] as u32);
    for (half, count) in counts.into_iter().enumerate() {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let sum = mean(half, x, y).map(|x| (x * count as f64 * FIXED_POINT_SCALE) as u64);
                film.halves_mut()[half][y * size[0] + x] = PixelSum(sum);
            }
        }
        (0..count).for_each(|i| film.record(2 * i + half as u64..2 * i + half as u64 + 1, 0).unwrap());
    }
    film
}

/// Numbers in -1..1 that look random.
fn noise(seed: [usize; 4]) -> f64 {
    let mixed = seed.iter().fold(0x9e37_79b9_u64, |hash, x| {
        let hash = (hash ^ *x as u64).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash ^ (hash >> 29)
    });
    (mixed % 65_536) as f64 / 32_768.0 - 1.0
}

/// A ramp with an edge and a spot, which is noisier below.
fn noisy(size: [usize; 2], counts: [u64; 2], seed: usize) -> Film {
    film(size, counts, |half, x, y| {
        let amplitude = (0.02 + 0.1 * y as f64 / size[1] as f64) / (counts[half] as f64).sqrt();
        [0, 1, 2].map(|c| (clean(size, x, y)[c] + amplitude * noise([seed + half, x, y, c])).max(0.0))
    })
}

fn clean(size: [usize; 2], x: usize, y: usize) -> [f64; 3] {
    let edge = if x > size[0] / 2 { 0.3 } else { 0.0 };
    let spot = if (x, y) == (size[0] / 3, size[1] / 3) { 5.0 } else { 0.0 };
    [0.3 + edge + spot, 0.2 + 0.4 * x as f64 / size[0] as f64, 0.5]
}

/// The filter as its definition, without tiles, in `f64`.
struct Plain {
    size: [isize; 2],
    halves: [Vec<[f64; 3]>; 2],
    weights: [f64; 2],
    shares: [f64; 2],
}

/// Red, green, blue and variance of the pixels.
type Picture = Vec<([f64; 3], f64)>;

impl Plain {
    fn of(film: &Film) -> Self {
        let counts = [0, 1].map(|half| film.half_sample_count(half) as f64);
        let unit = |half: usize| counts[half] * FIXED_POINT_SCALE;
        let weights = counts.map(|count| count / (counts[0] + counts[1]));
        Plain {
            size: [film.width() as isize, film.height() as isize],
            halves: [0, 1]
                .map(|i| film.halves()[i].iter().map(|sum| sum.0.map(|k| k as f64 / unit(i))).collect()),
            weights,
            shares: film.variance_shares(),
        }
    }

    fn index(&self, x: isize, y: isize) -> usize {
        (y.clamp(0, self.size[1] - 1) * self.size[0] + x.clamp(0, self.size[0] - 1)) as usize
    }

    fn holds(&self, x: isize, y: isize) -> bool {
        (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y)
    }

    fn around(radius: isize) -> impl Iterator<Item = (isize, isize)> {
        (-radius..=radius).flat_map(move |dy| (-radius..=radius).map(move |dx| (dx, dy)))
    }

    /// For the rows of `parity`, from the other rows.
    fn difference(&self, parity: isize, x: isize, y: isize) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (dx, dy) in Plain::around(6) {
            let at = self.index(x + dx, y + dy);
            if at as isize / self.size[0] % 2 != parity {
                sum += (0..3).map(|c| (self.halves[0][at][c] - self.halves[1][at][c]).powi(2)).sum::<f64>()
                    / 3.0;
                count += 1.0;
            }
        }
        sum / f64::max(count, 1.0)
    }

    /// The weight of two pixels, by patches of `guide`.
    fn weight(
        guide: &dyn Fn(isize, isize) -> ([f64; 3], f64),
        radius: isize,
        reach: f64,
        p: (isize, isize),
        q: (isize, isize),
    ) -> f64 {
        let distance = Plain::around(radius).map(|(dx, dy)| {
            let ((a, va), (b, vb)) = (guide(p.0 + dx, p.1 + dy), guide(q.0 + dx, q.1 + dy));
            let squares: f64 = (0..3).map(|c| (a[c] - b[c]).powi(2)).sum();
            (squares - 6.0 * va.min(vb)) / (6.0 * reach * reach * (va.max(vb) + 1e-30))
        });
        let mean = distance.sum::<f64>() / ((2 * radius + 1) * (2 * radius + 1)) as f64;
        (1.0 - mean.max(0.0) / 8.0).max(0.0).powi(8)
    }

    fn pilot(&self, half: usize, parity: isize) -> Picture {
        // Each is needed by many patches, which reach this far.
        const REACH: isize = 4;
        let [columns, rows] = self.size.map(|side| -REACH..side + REACH);
        let width = columns.end + REACH;
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        let known: Vec<f64> =
            places.map(|(x, y)| self.shares[half] * self.difference(parity, x, y)).collect();
        let variances = |x: isize, y: isize| known[((y + REACH) * width + x + REACH) as usize];
        let guide = |x: isize, y: isize| (self.halves[half][self.index(x, y)], variances(x, y));
        let pixels = (0..self.size[1]).flat_map(|y| (0..self.size[0]).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let (mut rgb, mut sum, mut squares) = ([0.0; 3], 0.0, 0.0);
                for (dx, dy) in Plain::around(1).filter(|(dx, dy)| self.holds(x + dx, y + dy)) {
                    let w = Plain::weight(&guide, 3, 0.9, (x, y), (x + dx, y + dy));
                    let pixel = self.halves[half][self.index(x + dx, y + dy)];
                    (0..3).for_each(|c| rgb[c] += w * pixel[c]);
                    (sum, squares) = (sum + w, squares + w * w);
                }
                (rgb.map(|x| x / sum), variances(x, y) * squares / (sum * sum))
            })
            .collect()
    }

    fn fitted(&self, half: usize, pilot: &Picture, x: isize, y: isize) -> [f64; 3] {
        let guide = |x: isize, y: isize| pilot[self.index(x, y)];
        // Normal equations of the plane, solved by Cramer's rule.
        let (mut m, mut v) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        for (dx, dy) in Plain::around(4).filter(|(dx, dy)| self.holds(x + dx, y + dy)) {
            let w = Plain::weight(&guide, 1, 1.3, (x, y), (x + dx, y + dy));
            let basis = [1.0, dx as f64, dy as f64];
            let pixel = self.halves[half][self.index(x + dx, y + dy)];
            for i in 0..3 {
                (0..3).for_each(|j| m[i][j] += w * basis[i] * basis[j]);
                (0..3).for_each(|c| v[i][c] += w * basis[i] * pixel[c]);
            }
        }
        (m[1][1], m[2][2]) = (m[1][1] + 0.16 * m[0][0], m[2][2] + 0.16 * m[0][0]);
        let determinant = |m: [[f64; 3]; 3]| {
            m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
                - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
        };
        [0, 1, 2].map(|c| {
            let mut with = m;
            (0..3).for_each(|i| with[i][0] = v[i][c]);
            determinant(with) / determinant(m)
        })
    }
}

impl Plain {
    fn pixels(&self) -> impl Iterator<Item = (isize, isize)> {
        let [width, height] = self.size;
        (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }

    fn filtered(&self, half: usize) -> Vec<[f64; 3]> {
        let pilots = [0, 1].map(|parity| self.pilot(half, parity));
        self.pixels().map(|(x, y)| self.fitted(half, &pilots[y as usize % 2], x, y)).collect()
    }

    /// With what the filter loses.
    fn repaired(&self, half: usize) -> Vec<[f64; 3]> {
        let (own, other, smooth) = (&self.halves[half], &self.halves[1 - half], self.filtered(half));
        let near = |x: isize, y: isize, radius: isize| {
            let places = Plain::around(radius).map(move |(dx, dy)| (x + dx, y + dy));
            places.filter(|(x, y)| self.holds(*x, *y)).map(|(x, y)| (y, self.index(x, y)))
        };
        let mixed = self.pixels().map(|(x, y)| {
            let [mut products, mut squares, mut of_lost] = [0.0; 3];
            for (_, i) in near(x, y, 8).filter(|(row, _)| (row - y) % 2 != 0) {
                let product: f64 =
                    (0..3).map(|c| (other[i][c] - smooth[i][c]) * (own[i][c] - smooth[i][c])).sum();
                of_lost += (0..3).map(|c| (own[i][c] - smooth[i][c]).powi(2)).sum::<f64>();
                (products, squares) = (products + product, squares + product * product);
            }
            let share = (products - 0.5 * squares.sqrt()).max(0.0) / f64::max(of_lost, 1e-30);
            let at = self.index(x, y);
            [0, 1, 2].map(|c| smooth[at][c] + share.min(1.0) * (own[at][c] - smooth[at][c]))
        });
        let mixed: Vec<[f64; 3]> = mixed.collect();
        let with_mean = self.pixels().map(|(x, y)| {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for (_, i) in near(x, y, 16) {
                (0..3).for_each(|c| sum[c] += own[i][c] - mixed[i][c]);
                count += 1.0;
            }
            [0, 1, 2].map(|c| mixed[self.index(x, y)][c] + sum[c] / count)
        });
        with_mean.collect()
    }
}

/// The largest difference of a film's denoised picture from the definition.
fn difference_from_definition(film: &Film) -> f64 {
    let plain = Plain::of(film);
    let found = filtered(Halves::of(film).unwrap(), Level::new(), &AtomicBool::new(false)).film;
    let [a, b] = [0, 1].map(|half| plain.repaired(half));
    let mut most: f64 = 0.0;
    for i in 0..a.len() {
        let mean = found.mean(i);
        for c in 0..3 {
            let expected = plain.weights[0] * a[i][c] + plain.weights[1] * b[i][c];
            most = most.max((mean[c] - expected.max(0.0)).abs());
        }
    }
    most
}

#[test]
fn tiles_give_what_the_definition_says() {
    // Across the borders of tiles in both directions, and smaller than one; halves of unequal counts.
    for (size, counts) in
        [([70, 37], [8, 8]), ([9, 8], [2, 1]), ([3, 41], [3, 4]), ([130, 2], [1, 1]), ([64, 1], [2, 2])]
    {
        let most = difference_from_definition(&noisy(size, counts, 3));
        assert!(most < 2e-5, "{size:?}, {counts:?}: {most}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]
    #[test]
    fn any_film_gives_a_finite_picture_and_error(
        width in 1_usize..100, height in 1_usize..80, a in 1_u64..9, b in 1_u64..9,
        scale in 0.0..120.0_f64, seed in 0_usize..1000,
    ) {
        prop_assume!(width * height >= LEAST_PIXELS);
        let film = film([width, height], [a, b], |half, x, y| {
            [0, 1, 2].map(|c| scale * noise([seed, half, x * 1000 + y, c]).max(0.0).powi(9))
        });
        let Ok(denoised) = of_film(&film) else { return Ok(()) };
        let most = film.halves().iter().zip([a, b]).flat_map(|(half, n)| half.iter().map(move |k| k.radiance()[0] / n as f64));
        let most = most.fold(0.0, f64::max);
        let pixels = width * height;
        prop_assert!((0..pixels).all(|i| denoised.film.mean(i).iter().all(|x| (0.0..=RADIANCE_LIMIT).contains(x))));
        prop_assert!(most > 0.0 && denoised.errors.iter().all(|e| (0.0..=RADIANCE_LIMIT as f32).contains(e)));
        let error = denoised.error;
        prop_assert!(error.rmse().is_finite() && error.upper_rmse() >= error.rmse());
    }
}

#[test]
fn pictures_without_noise_stay_as_they_are() {
    let size = [70, 40];
    let film = film(size, [2, 2], |_, x, y| clean(size, x, y));
    let denoised = of_film(&film).unwrap();
    for index in 0..size[0] * size[1] {
        let (before, after) = (film.mean(index), denoised.film.mean(index));
        assert!(
            (0..3).all(|c| (before[c] - after[c]).abs() < 1e-6 * before[c].max(1.0)),
            "{before:?}, {after:?}"
        );
    }
    assert!(denoised.error.rmse() < 1e-6, "{:?}", denoised.error);
}

#[test]
fn the_estimate_covers_the_true_error() {
    let size = [96, 64];
    let (mut within, mut total, mut gains) = (0, 0, 0.0);
    for seed in 0..40 {
        for counts in [[1, 1], [4, 4], [6, 3]] {
            let film = noisy(size, counts, 10 * seed);
            let denoised = of_film(&film).unwrap();
            let mse = |film: &Film| {
                let error = |i: usize| {
                    let (mean, truth) = (film.mean(i), clean(size, i % size[0], i / size[0]));
                    (0..3).map(|c| (mean[c] - truth[c]).powi(2)).sum::<f64>() / 3.0
                };
                (0..size[0] * size[1]).map(error).sum::<f64>() / (size[0] * size[1]) as f64
            };
            let (truth, raw, error) = (mse(&denoised.film), mse(&film), denoised.error);
            total += 1;
            within += usize::from((error.mse - truth).abs() < 2.0 * error.mse_deviation);
            gains += raw / truth;
            assert!((error.raw_mse / raw - 1.0).abs() < 0.15, "raw: {} and {raw}", error.raw_mse);
        }
    }
    assert!(within * 100 >= total * 90, "{within} of {total} estimates are within two deviations");
    assert!(
        gains / f64::from(total as u32) > 8.0,
        "the error falls by {} on average",
        gains / f64::from(total as u32)
    );
}

#[test]
fn all_processors_and_threads_give_the_same_bits() {
    let film = noisy([130, 70], [3, 2], 5);
    let of = |level, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| filtered(Halves::of(&film).unwrap(), level, &AtomicBool::new(false)))
    };
    let best = of(Level::new(), 3);
    assert_eq!(of(Level::baseline(), 1), best);
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = Level::new().as_avx2() {
        assert_eq!(of(Level::Avx2(avx2), 2), best);
    }
}

#[test]
fn films_that_cannot_be_denoised_say_why() {
    let refused = |film: &Film| of_film(film).unwrap_err().to_string();
    let grey = |size, counts| film(size, counts, |_, _, _| [0.5; 3]);
    assert!(refused(&grey([20, 20], [1, 0])).contains("only one half"));
    assert!(refused(&film([20, 20], [2, 2], |_, _, _| [0.0; 3])).contains("light"));
    assert!(of_film(&grey([1, 1], [2, 2])).is_err());
    let huge = Halves::of(&grey([8, 8], [1, 1])).unwrap();
    assert_eq!(denoise(huge, &AtomicBool::new(true)), None, "a stop is obeyed");
}
