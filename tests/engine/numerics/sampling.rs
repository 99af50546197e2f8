//! Random numbers: cases 26 and 27, and the lanes against their scalar oracle.

use crate::common::oracle::{laine_karras, pascal, pixel_key, sin_cos_turns, sobol_numbers};
use crate::numerics::common::{Random, first};
use proptest::prelude::*;
use std::collections::HashSet;
use weekender::job::render::{RenderSettings, SAMPLE_LIMIT, SamplerKind};
use weekender::kernel::sampling::{SampleBlock, mix32, pcg4d};
use weekender::render_cpu::lanes::{Double, Lanes, MAX_LANES, Reference, Scalar, Single, Wide, unit_float};
use weekender::render_cpu::rng;

fn settings(sampler: SamplerKind, seed: u32) -> RenderSettings {
    RenderSettings { sampler, seed, ..RenderSettings::default() }
}

/// Four numbers for one ray of a path, in units of `2^-32`. The first two select a direction, a point in the pixel or,
/// with a lens, a point on it. A dielectric uses the first to choose between reflection and refraction, since it needs
/// no direction. With a lens, the last two select the point in the pixel.
///
/// `pixel` is `x | y << 16`; `bounce` is 0 for the camera ray.
pub fn numbers(settings: &RenderSettings, pixel: u32, index: u32, bounce: u32) -> [u32; 4] {
    match settings.sampler {
        // The index is hashed without reversing it. The hash carries differences upwards and folds them down only once,
        // so samples whose numbers differ only in the highest bits, as reversed ones do, would not be independent.
        SamplerKind::Independent => pcg4d([pixel, index, bounce, settings.seed]),
        SamplerKind::Sobol => {
            let key = pixel_key(settings.seed, index % 2, pixel);
            sobol_numbers(key, (index / 2).reverse_bits(), bounce)
        }
    }
}

#[test]
fn case_26_no_draw_repeats() {
    for sampler in SamplerKind::ALL {
        let settings = settings(sampler, 0);
        let draws: HashSet<[u32; 4]> =
            (0..100_000).map(|index| numbers(&settings, 230 | 69 << 16, index, 0)).collect();
        assert_eq!(draws.len(), 100_000, "{sampler:?}");
    }
}

/// Whatever is sampled, the mean of `n` independent samples has 1/n of the variance of one.
#[test]
fn independent_samples_are_independent() {
    const SAMPLES: u32 = 64;
    const PIXELS: u32 = 20_000;
    let waves = [0.5, 1.0, 2.0, 8.0];
    let settings = settings(SamplerKind::Independent, 3);
    for which in 0..4 {
        for turns in waves {
            let (mut squares, mut squares_of_means) = (0.0, 0.0);
            for pixel in 0..PIXELS {
                let value = |index| {
                    let word = numbers(&settings, (pixel % 200) | ((pixel / 200) << 16), index, 0)[which];
                    // Its mean over all numbers is 0.
                    (f64::from(crate::common::oracle::unit_float(word)) * turns * std::f64::consts::TAU).cos()
                };
                let values = (0..SAMPLES).map(value);
                squares += values.clone().map(|x| x * x).sum::<f64>();
                squares_of_means += values.sum::<f64>().powi(2);
            }
            let ratio = squares_of_means / squares;
            // The deviation is the root of 2 / PIXELS, 0.01.
            assert!((ratio - 1.0).abs() < 0.05, "number {which}, {turns} turns: {ratio}");
        }
    }
}

#[test]
fn case_27_the_largest_number_is_below_1() {
    fn largest<L: Lanes>(l: L) -> f64 {
        first::<L>(unit_float(l, l.splat_u(u32::MAX)))
    }
    let below_1 = 1.0 - 1.0 / 16_777_216.0;
    assert_eq!(f64::from(crate::common::oracle::unit_float(u32::MAX)), below_1);
    assert_eq!(largest(Scalar::<false>), below_1);
    assert_eq!(largest(Reference), below_1);
    assert_eq!(crate::common::oracle::unit_float(0), 0.0);
}

/// Compares every number of the lanes with the oracle, bit for bit.
#[inline(always)]
fn assert_twins<L: Lanes>(l: L) {
    let mut random = Random::new(9);
    for _ in 0..500 {
        let mut words = || {
            let mut row = [0; MAX_LANES];
            row.iter_mut().for_each(|word| *word = random.bits() as u32);
            row
        };
        let [a, b, c, d] = [words(), words(), words(), words()];
        let [la, lb, lc, ld] = [a, b, c, d].map(|row| l.load_u(&Wide(row)));
        let same = |found: L::U, what: &str, expected: &dyn Fn(usize) -> u32| {
            let mut row = Wide::default();
            L::store_u(found, &mut row);
            for (lane, word) in row.0.into_iter().enumerate().take(L::WIDTH) {
                assert_eq!(word, expected(lane), "{what}, lane {lane} of {}", L::WIDTH);
            }
        };
        same(rng::mix32(l, la), "mix32", &|i| mix32(a[i]));
        same(rng::laine_karras(l, la, lb), "laine_karras", &|i| laine_karras(a[i], b[i]));
        same(rng::pascal(l, la), "pascal", &|i| pascal(a[i]));
        for (which, found) in rng::pcg4d(l, [la, lb, lc, ld]).into_iter().enumerate() {
            same(found, "pcg4d", &|i| pcg4d([a[i], b[i], c[i], d[i]])[which]);
        }
        // A whole draw: each lane has its own pixel and index, all at one bounce.
        let (half, bounce, seed) = (a[0] & 1, b[0] % 50, c[0]);
        let index = |i: usize| d[i] >> 1 << 1 | half;
        let pixel = |i: usize| a[i] & 0x3FFF_3FFF;
        let settings = settings(SamplerKind::Sobol, seed);
        let (mut keys, mut counters) = ([0; MAX_LANES], [0; MAX_LANES]);
        for i in 0..MAX_LANES {
            keys[i] = pixel_key(seed, half, pixel(i));
            counters[i] = (index(i) / 2).reverse_bits();
        }
        let (keys, counters) = (l.load_u(&Wide(keys)), l.load_u(&Wide(counters)));
        let found =
            rng::numbers(l, &settings, l.load_u(&Wide(a)), counters, keys, keys + l.splat_u(bounce), true);
        for (which, found) in found.into_iter().flatten().enumerate() {
            same(found, "numbers", &|i| numbers(&settings, pixel(i), index(i), bounce)[which]);
        }
    }
}

/// The numbers of a path, pair by pair: for the lens, the point in the pixel, and the first two bounces.
fn pairs_of_path(settings: &RenderSettings, pixel: u32, index: u32) -> [[u32; 2]; 4] {
    let [[lens0, lens1, x, y], [first0, first1, ..], [second0, second1, ..]] =
        [0, 1, 2].map(|bounce| numbers(settings, pixel, index, bounce));
    [[lens0, lens1], [x, y], [first0, first1], [second0, second1]]
}

/// No exclusive or of the three highest bits of a path's first eight numbers is more often 0 than 1. Otherwise a picture
/// would converge to a wrong one: Walsh functions of these bits would not average out.
#[test]
fn numbers_of_a_path_are_unrelated() {
    const DRAWS: u32 = 1 << 22;
    for sampler in SamplerKind::ALL {
        let settings = settings(sampler, 5);
        let mut counts = vec![0_i32; 1 << 24];
        for draw in 0..DRAWS {
            let pairs = pairs_of_path(&settings, draw % 64, mix32(draw));
            let cell =
                pairs.as_flattened().iter().fold(0, |cell, number| cell << 3 | (number >> 29) as usize);
            counts[cell] += 1;
        }
        // The fast Walsh-Hadamard transform.
        for half in (0..24).map(|bit| 1 << bit) {
            for block in counts.chunks_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (a, b) in low.iter_mut().zip(high) {
                    (*a, *b) = (*a + *b, *a - *b);
                }
            }
        }
        let (bits, largest) = counts.iter().enumerate().skip(1).max_by_key(|(_, sum)| sum.abs()).unwrap();
        let deviations = f64::from(largest.abs()) / f64::from(DRAWS).sqrt();
        assert!(deviations < 7.0, "{sampler:?}: {bits:024b} {deviations}");
    }
}

/// Pixel, lens and first bounce are points of one net of more dimensions: their blocks reach more boxes of equal size than
/// pairs that are independent of each other, which reach 63 %.
#[test]
fn first_rays_are_evenly_distributed_together() {
    let settings = settings(SamplerKind::Sobol, 1);
    for (first, other) in [(0, 1), (0, 2), (1, 2)] {
        let (mut reached, mut boxes) = (0, 0);
        for bits in [4, 5, 6, 7] {
            for block in 0..64 {
                for split in 1..bits {
                    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let cells: HashSet<u32> = (0..1 << bits)
                            .map(|sample| {
                                let pairs = pairs_of_path(&settings, 7, 2 * ((block << bits) + sample));
                                pairs[first][i] >> (32 - split) << 16 | pairs[other][j] >> (32 - bits + split)
                            })
                            .collect();
                        (reached, boxes) = (reached + cells.len(), boxes + (1 << bits));
                    }
                }
            }
        }
        let share = reached as f64 / f64::from(boxes);
        assert!(share > 0.66, "pairs {first} and {other}: {share}");
    }
}

#[test]
fn lanes_draw_oracle_numbers() {
    assert_twins(Scalar::<false>);
    assert_twins(Reference);
    #[cfg(target_arch = "x86_64")]
    {
        use fearless_simd::{Level, Simd};
        use weekender::render_cpu::lanes::{Lanes4, Lanes8, Lanes16};
        let level = Level::new();
        if let Some(simd) = level.as_sse4_2() {
            simd.vectorize(
                #[inline(always)]
                || assert_twins(Lanes4(simd)),
            );
        }
        if let Some(simd) = level.as_avx2() {
            simd.vectorize(
                #[inline(always)]
                || assert_twins(Lanes8(simd)),
            );
        }
        if let Some(simd) = level.as_avx512() {
            simd.vectorize(
                #[inline(always)]
                || assert_twins(Lanes16(simd)),
            );
        }
    }
}

/// Compares the polynomials with the library's sine and cosine in `f64`: each, and the length of the vector of both, is
/// within two units of `2^-23`.
#[test]
fn sine_and_cosine_of_turns() {
    let (mut largest, mut length) = (0.0_f64, 0.0_f64);
    for step in (0..1 << 24).step_by(37).chain([1 << 22, 1 << 23, 3 << 22, (1 << 24) - 1]) {
        let u = step as f32 / 16_777_216.0;
        let (sine, cosine) = sin_cos_turns(u);
        let unfused = Scalar::<false>.sin_cos_turns(Single(u));
        assert_eq!((unfused.0.0, unfused.1.0), (sine, cosine), "the lanes' own");
        let exact = (f64::from(u) * std::f64::consts::TAU).sin_cos();
        let [sine, cosine] = [sine, cosine].map(f64::from);
        largest = largest.max((sine - exact.0).abs()).max((cosine - exact.1).abs());
        length = length.max((sine.hypot(cosine) - 1.0).abs());
        let fused = Scalar::<true>.sin_cos_turns(Single(u));
        largest =
            largest.max((f64::from(fused.0.0) - exact.0).abs()).max((f64::from(fused.1.0) - exact.1).abs());
        let reference = Reference.sin_cos_turns(Double(f64::from(u)));
        assert!((reference.0.0 - exact.0).abs() < 1e-15 && (reference.1.0 - exact.1).abs() < 1e-15);
    }
    assert!(largest <= 2e-7, "{largest:e}");
    assert!(length <= 2e-7, "{length:e}");
}

proptest! {
    /// Blocks cover each sample of a range once, and their counters produce exactly these samples.
    #[test]
    fn blocks_cover_a_range_once(
        start in prop_oneof![0..2000_u64, SAMPLE_LIMIT - 2000..SAMPLE_LIMIT],
        length in 0..1500_u64,
        limit in 0..8_u32,
        sobol: bool,
    ) {
        let range = start..(start + length).min(SAMPLE_LIMIT);
        let sampler = if sobol { SamplerKind::Sobol } else { SamplerKind::Independent };
        let settings = settings(sampler, 3);
        let blocks = SampleBlock::split(range.clone(), 1 << limit);
        let mut seen = Vec::new();
        for block in &blocks {
            prop_assert!(block.count.is_power_of_two() && block.count <= 1 << limit);
            prop_assert_eq!(block.first % block.count, 0);
            let (mut counter, step) = block.counter(&settings);
            for _ in 0..block.count {
                seen.push(if sobol {
                    u64::from(counter.reverse_bits()) * 2 + u64::from(block.half)
                } else {
                    prop_assert_eq!(counter % 2, block.half);
                    u64::from(counter)
                });
                counter = counter.wrapping_add(step);
            }
        }
        seen.sort_unstable();
        prop_assert_eq!(seen, range.collect::<Vec<_>>());
    }
}
