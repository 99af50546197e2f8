//! What is said of made-up films: each by itself, and two of them beside each other.

use crate::common::{check, digest};
use std::fmt::Write as _;
use weekender::compare::{PairedSums, Side, compare, told};
use weekender::film::{FIXED_POINT_SCALE, Film, Histogram, PixelSum};
use weekender::stages::Transfer;

const SIZE: [u32; 2] = [27, 18];

/// Numbers of 0 to 1 that are the same in every run.
fn noise(index: u64) -> f64 {
    let x = (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A film of noise, to which each pixel adds what `more` says.
fn film(half_count: usize, samples: u64, seed: u64, more: impl Fn(u32, u32) -> f64) -> Film {
    let [width, height] = SIZE;
    let mut film = Film::new(width, height, half_count);
    film.record(0..samples, seed).unwrap();
    for half in 0..half_count {
        let count = film.half_sample_count(half);
        for pixel in 0..width * height {
            let (x, y) = (pixel % width, pixel / width);
            let mean = |channel: u64| {
                let index = ((seed * 2 + half as u64) * 1000 + u64::from(pixel)) * 3 + channel;
                0.2 + 0.3 * noise(index) + more(x, y)
            };
            let sums = [0, 1, 2].map(|channel| (mean(channel) * count as f64 * FIXED_POINT_SCALE) as u64);
            film.halves_mut()[half][pixel as usize] = PixelSum(sums);
        }
    }
    film
}

#[test]
fn films_tell_what_is_kept_of_them() {
    let mut text = String::new();
    let slope = |_: u32, y: u32| 0.02 * f64::from(y);
    for (half_count, samples) in [(2, 1), (2, 2), (2, 5), (2, 16), (2, 300), (1, 7)] {
        let even = film(half_count, samples, 1, |_, _| 0.0);
        let mut spot = film(half_count, samples, 2, slope);
        spot.halves_mut()[0][5 * 27 + 20].0[0] *= 40;
        for (what, film) in [("even", even), ("spot", spot)] {
            writeln!(text, "{what}, {half_count} halves, {samples} samples").unwrap();
            if let Some(error) = film.error() {
                let (pixels, uncertainty) = (error.pixels_in_effect(), error.uncertainty());
                writeln!(text, "  {error:.9?} {pixels:.6} {uncertainty} {:?}", film.doubt(Some(&error), 1.0))
                    .unwrap();
            }
            let smooth = film.smoothed();
            let sums = |film: &Film| digest(film.halves().iter().flatten().flat_map(|sum| sum.0));
            let mean = smooth.mean(5 * 27 + 20);
            writeln!(text, "  smoothed {} of {}, spot {mean:.9?}", sums(&smooth), sums(&film)).unwrap();
            for white in [0.3, 1.0] {
                let Histogram { bins, pixels, clipped, largest } = Histogram::of(&film, white);
                let counts = bins.map(|bins| digest(bins.into_iter().map(u64::from)));
                writeln!(text, "  white {white}: {pixels} {clipped} {largest:.9} {counts:?}").unwrap();
            }
            for (transfer, stops) in [(Transfer::Gamma2, 0.0), (Transfer::LinearAboveGamma2, -1.5)] {
                let bytes = film.exposed(transfer, stops);
                writeln!(text, "  {transfer:?} {stops}: {}", digest(bytes.into_iter().map(u64::from)))
                    .unwrap();
            }
        }
    }
    check("film_figures", &text);
}

/// A film as the picture of a program that writes bytes.
fn in_bytes(film: &Film) -> Side {
    let [width, height] = SIZE;
    let side = side("bytes", Film::new(width, height, 1));
    let byte = |x: f64| (256.0 * x).floor().min(255.0);
    let read = |byte: f64| if byte < 255.0 { (byte + 0.5) / 256.0 } else { f64::NAN };
    let pixels: Vec<[f64; 3]> =
        film.means().into_iter().map(|pixel| pixel.map(|x| read(byte(f64::from(x))))).collect();
    let steps = pixels.iter().map(|_| [0.5 / 256.0; 3]).collect();
    Side { film: None, pixels, steps: Some(steps), limit: 255.0 / 256.0, ..side }
}

fn side(name: &str, film: Film) -> Side {
    Side::of_film(name.to_owned(), format!("{} samples", film.sample_count()), film)
}

#[test]
fn comparisons_are_as_kept() {
    let nothing = |_: u32, _: u32| 0.0;
    let plain = |samples, seed| side("plain", film(2, samples, seed, nothing));
    let brighter = |by: f64| side("brighter", film(2, 5, 2, move |_, _| by));
    let block = |by: f64| side("block", film(2, 5, 2, move |x, y| if x < 9 && y > 8 { by } else { 0.0 }));
    let mut odd = plain(5, 2);
    odd.pixels[30] = [f64::NAN, 0.5, f64::INFINITY];
    odd.pixels[31] = [0.5, f64::NEG_INFINITY, 0.5];
    odd.film = None;
    let mut as_odd = plain(5, 3);
    as_odd.pixels[30] = [f64::NAN, f64::NAN, f64::INFINITY];
    as_odd.film = None;
    let cases = [
        [plain(5, 1), plain(5, 2)],
        [plain(5, 1), plain(8, 2)],
        [plain(5, 1), plain(1, 2)],
        [plain(5, 1), plain(5, 1)],
        [plain(5, 1), side("one half", film(1, 5, 2, nothing))],
        [plain(5, 1), brighter(0.004)],
        [plain(5, 1), brighter(0.03)],
        [brighter(0.03), plain(5, 1)],
        [plain(5, 1), block(0.05)],
        [plain(5, 1), block(0.2)],
        [odd, as_odd],
        [plain(5, 1), in_bytes(&film(2, 5, 2, nothing))],
        [
            in_bytes(&film(2, 5, 2, |x, _| 0.03 * f64::from(x))),
            in_bytes(&film(2, 5, 1, |x, _| 0.03 * f64::from(x))),
        ],
    ];
    let mut text = String::new();
    for sides in &cases {
        let comparison = compare(&sides[0], &sides[1], None);
        writeln!(text, "{}  {comparison:.9?}\n", told(sides, &comparison)).unwrap();
    }
    for by in [1e-5, 4e-5, 1e-4, 2e-3] {
        let mut sums = PairedSums::default();
        for sample in 0..3 {
            let more = |x: u32, y: u32| if (x, y) == (3, 4) { 0.5 } else { 0.0 };
            let one = film(1, 1, sample, nothing);
            sums.add(&one, &film(1, 1, sample, move |x, y| by + if sample == 1 { more(x, y) } else { 0.0 }));
        }
        let sides = [plain(5, 1), plain(5, 2)];
        let comparison = compare(&sides[0], &sides[1], Some(sums.finish()));
        let paired = comparison.paired.unwrap();
        let (share, reasons) = (paired.parted_share(), &comparison.reasons);
        let (count, rms, bias) = (paired.count, paired.rms, paired.bias);
        writeln!(text, "{by:e}: {count} {share:.9} {rms:.6e} {bias:.6e} {reasons:?}").unwrap();
    }
    check("comparisons", &text);
}
