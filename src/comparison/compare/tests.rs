//! Noise, rounding, clipping, NaN.

use super::verdict::NonFinite;
use super::*;
use crate::film::{FIXED_POINT_SCALE, Film, PixelSum, fixed_point};
use crate::job::output::Encoding;
use crate::kernel::sampling::pcg4d;
use crate::numbers::statistics::blocks::CHANCE;
use crate::numbers::statistics::normal::largest_of;

const PIXELS: usize = 80 * 48;

fn random(pixel: u32, half: u32, seed: u32) -> f64 {
    f64::from(pcg4d([pixel, half, seed, 5])[0]) / 4_294_967_296.0
}

/// An 80 x 48 film with one sample per half; `value` gives the radiance for half and pixel.
fn film_of(value: impl Fn(u32, u32) -> f64) -> Picture {
    let mut film = Film::new(80, 48);
    for (half, pixels) in (0..).zip(film.halves_mut()) {
        for (pixel, sum) in (0..).zip(pixels) {
            *sum = fixed_point([value(half, pixel); 3]).unwrap();
        }
    }
    film.record(0..2, 0).unwrap();
    Picture::of_film(String::new(), String::new(), film)
}

/// A film of noise around an offset.
fn noisy(seed: u32, offset: f64) -> Picture {
    film_of(|half, pixel| 0.5 + 0.2 * random(pixel, half, seed) + offset)
}

/// A float picture without halves.
fn floats(value: impl Fn(u32) -> f64) -> Picture {
    let pixels = (0..PIXELS as u32).map(|pixel| [value(pixel); 3]).collect();
    Picture { film: None, pixels, ..Picture::of_film(String::new(), String::new(), Film::new(80, 48)) }
}

/// An 8-bit linear picture.
fn bytes(value: impl Fn(u32) -> f64) -> Picture {
    let stored = |x: f64| if x >= 255.0 / 256.0 { f64::NAN } else { ((256.0 * x).floor() + 0.5) / 256.0 };
    let steps = Some(vec![[0.5 / 256.0; 3]; PIXELS]);
    Picture { steps, limit: 255.0 / 256.0, ..floats(|pixel| stored(value(pixel))) }
}

fn both_ways(a: &Picture, b: &Picture) -> [Comparison; 2] {
    [compare(a, b), compare(b, a)]
}

#[test]
fn noise_hides_offset_unless_samples_are_shared() {
    let noise = compare(&noisy(1, 0.0), &noisy(2, 0.0));
    assert!(noise.is_equal(), "{:?}", noise.reasons);
    assert!((noise.times_noise() - 1.0).abs() < 0.1, "{}", noise.times_noise());
    assert!(compare(&noisy(1, 0.0), &noisy(2, 2e-3)).is_equal());
    let same = compare(&noisy(1, 0.0), &noisy(1, 2e-3));
    assert!(!same.is_equal() && same.times_noise() < 0.1, "{same:?}");
    assert!(compare(&noisy(1, 0.0), &noisy(1, 1e-6)).is_equal());
    assert!(compare(&noisy(1, 0.0), &noisy(1, 0.0)).is_same);
    // Without noise, pictures are equal or infinitely far apart.
    let dark = film_of(|_, _| 0.25);
    assert_eq!(compare(&dark, &dark).times_noise(), 0.0);
    let found = compare(&dark, &film_of(|_, pixel| 0.25 + f64::from(pixel % 2)));
    assert_eq!((found.rms, found.times_noise()), (0.5_f64.sqrt(), f64::INFINITY));
}

#[test]
fn difference_noise_combines_both_films() {
    let film = |seed: u32, samples: u64, middle: f64| {
        let mut film = Film::new(80, 48);
        for (sample, pixel) in (0..samples).flat_map(|sample| (0..PIXELS).map(move |pixel| (sample, pixel))) {
            let value = middle + 0.2 * (random(pixel as u32, sample as u32, seed) - 0.5);
            film.halves_mut()[(sample % 2) as usize][pixel].add(fixed_point([value; 3]).unwrap());
        }
        film.record(0..samples, 0).unwrap();
        Picture::of_film(String::new(), String::new(), film)
    };
    let [there, back] = both_ways(&film(1, 64, 0.5), &film(2, 4, 0.51));
    assert!((there.bias - 0.01).abs() < 2e-3 && (there.bias + back.bias).abs() < 1e-12, "{}", there.bias);
    let figures =
        |found: &Comparison| [found.bias_deviation.unwrap(), found.noise.unwrap(), found.test.largest];
    for (a, b) in figures(&there).into_iter().zip(figures(&back)) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    let deviation = 0.2 / 12.0_f64.sqrt() * (1.0 / 64.0 + 1.0 / 4.0_f64).sqrt();
    assert!((there.noise.unwrap() / deviation - 1.0).abs() < 0.05, "{:?} {deviation}", there.noise);
    let of_mean = deviation / (PIXELS as f64).sqrt();
    assert!(
        (there.bias_deviation.unwrap() / of_mean - 1.0).abs() < 0.1,
        "{:?} {of_mean}",
        there.bias_deviation
    );
}

/// With many samples, the noise of the mean is far below the effect of rounding.
#[test]
fn mean_within_rounding_is_equal() {
    let picture = |offset: f64| {
        let samples = 1 << 20;
        let sum = (samples / 2) as f64 * (0.5 + offset) * FIXED_POINT_SCALE;
        let mut film = Film::new(80, 48);
        film.halves_mut().iter_mut().flatten().for_each(|pixel| *pixel = PixelSum([sum.round() as u64; 3]));
        film.record(0..samples, 0).unwrap();
        Picture::of_film(String::new(), String::new(), film)
    };
    let rounded = compare(&picture(0.0), &picture(ROUNDING_BIAS));
    assert!(rounded.is_equal(), "{:?}", rounded.reasons);
    let moved = compare(&picture(0.0), &picture(5.0 * ROUNDING_BIAS));
    assert!(moved.reasons.iter().any(|reason| reason.starts_with("the mean is")), "{:?}", moved.reasons);
}

#[test]
fn too_similar_blocks_are_noted() {
    let halves = |seed| move |half: u32, pixel: u32| random(pixel, half, seed);
    let [one, other] = [1, 2].map(|seed| film_of(halves(seed)));
    let swapped = film_of(|half, pixel| random(pixel, 1 - half, 1));
    let is_noted = |a: &Picture, b: &Picture| {
        compare(a, b).notes.iter().any(|note| note.starts_with("the blocks differ by less"))
    };
    assert!(is_noted(&one, &swapped) && !is_noted(&one, &other));
}

#[test]
fn non_finite_in_one_picture_differs() {
    let with = |value: f64| {
        let mut picture = floats(|pixel| 0.5 + 0.2 * random(pixel, 0, 1));
        picture.pixels[200..260].iter_mut().for_each(|pixel| pixel[1] = value);
        picture
    };
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    for (a, b) in [(nan, 0.5), (0.5, inf), (-inf, 0.5), (nan, inf), (inf, -inf), (nan, -inf)] {
        let found = compare(&with(a), &with(b));
        assert_eq!((found.verdict(), found.is_same), (Verdict::Different, false), "{a} and {b}");
        let expected = NonFinite { differing_pixels: 60, differing: 60, first: Some([40, 2]), alike: 0 };
        assert_eq!(found.non_finite, expected);
    }
    for (a, b) in [(nan, -nan), (inf, inf), (-inf, -inf)] {
        let found = compare(&with(a), &with(b));
        assert!(found.is_equal() && found.is_same, "{a} and {b}: {:?}", found.reasons);
        assert_eq!((found.non_finite.differing, found.non_finite.alike, found.left_out), (0, 60, 60));
    }
    // Zeros of different signs are equal, but not bit for bit.
    let found = compare(&with(0.0), &with(-0.0));
    assert!(found.is_equal() && !found.is_same);
    // A picture without finite numbers equals no picture.
    let none = floats(|_| nan);
    let found = compare(&none, &none);
    assert_eq!((found.verdict(), found.is_same), (Verdict::Unclear, false), "{found:?}");
}

#[test]
fn clipped_integer_matches_anything_larger() {
    let whole = |value: f64| bytes(move |pixel| if pixel == 7 { value } else { 0.3 });
    let float = |value: f64| floats(move |pixel| if pixel == 7 { value } else { 0.3 });
    for beyond in [1.0, 50.0, f64::INFINITY] {
        assert!(compare(&whole(1.0), &float(beyond)).is_equal(), "{beyond}");
    }
    assert!(compare(&whole(1.0), &whole(1.0)).is_same);
    for other in [f64::NAN, f64::NEG_INFINITY] {
        assert!(!compare(&float(other), &whole(1.0)).is_equal(), "{other}");
    }
    assert!(!compare(&whole(0.5), &float(f64::INFINITY)).is_equal());
    // At or above the other picture's limit: unknown, so no difference.
    let rows = |value: f64| move |pixel: u32| if pixel < 80 * 8 { value } else { 0.3 };
    for (a, b) in [(1.0, 5.0), (1.0, 255.0 / 256.0)] {
        for found in both_ways(&bytes(rows(a)), &floats(rows(b))) {
            assert!(found.is_equal(), "{a} and {b}: {:?}", found.reasons);
            assert_eq!(found.left_out, 3 * 80 * 8, "{a} and {b}");
        }
    }
    assert_eq!(compare(&bytes(rows(0.5)), &floats(rows(0.5))).left_out, 0);
    assert!(!compare(&bytes(rows(0.5)), &floats(rows(0.6))).is_equal());
}

#[test]
fn clipped_block_differs_only_from_dark() {
    let scene = |seed: u32| move |pixel: u32| 0.2 + 0.4 * random(pixel, 0, seed);
    let is_clipped =
        |found: &Comparison| found.reasons.iter().any(|reason| reason.contains("darker in the other"));
    let painted: [fn(u32) -> bool; 3] = [
        |pixel| (16..40).contains(&(pixel % 80)) && (8..32).contains(&(pixel / 80)),
        |pixel| (24..32).contains(&(pixel % 80)) && (16..24).contains(&(pixel / 80)),
        |pixel| pixel / 80 < 47,
    ];
    for is_painted in painted {
        let white = bytes(move |pixel| if is_painted(pixel) { 1.0 } else { scene(2)(pixel) });
        for found in [floats(scene(1)), bytes(scene(1))].iter().flat_map(|other| both_ways(other, &white)) {
            assert!(!found.is_equal() && is_clipped(&found), "{:?}", found.reasons);
            let worst = &found.test.worst(1)[0];
            assert!(is_painted(worst.y.start * 80 + worst.x.start), "{worst:?}");
        }
    }
    let bright =
        |seed: u32| move |pixel: u32| if pixel % 80 < 24 { 2.0 + random(pixel, 0, seed) } else { 0.3 };
    for other in [floats(bright(1)), bytes(bright(1))] {
        let found = compare(&other, &bytes(bright(2)));
        assert!(found.is_equal(), "{:?} {:?}", found.reasons, found.unclear);
    }
    // Noise around the limit: even, or an occasional path of radiance 8.
    for (samples, is_rare) in [(2, false), (16, false), (2, true), (16, true)] {
        let mean = move |seed: u32, pixel: u32| {
            let path = |x: f64| if is_rare { if x < 0.08 { 8.0 } else { 0.1 } } else { 0.5 + x };
            (0..samples).map(|sample| path(random(pixel, sample, seed))).sum::<f64>() / f64::from(samples)
        };
        let there = bytes(|pixel| mean(1, pixel));
        for other in [floats(|pixel| mean(2, pixel)), bytes(|pixel| mean(3, pixel))] {
            let found = compare(&there, &other);
            assert!(!is_clipped(&found), "{samples} samples: {:?}", found.reasons);
        }
    }
    // With nearly everything clipped, there is no verdict.
    let white = |columns: u32| move |pixel: u32| if pixel % 80 < columns { 1.0 } else { 0.5 };
    for (columns, verdict) in [(80, Verdict::Unclear), (48, Verdict::Unclear), (40, Verdict::Same)] {
        let found = compare(&bytes(white(columns)), &floats(white(columns)));
        assert_eq!(found.verdict(), verdict, "{columns}: {:?}", found.reasons);
        assert!(compare(&bytes(white(columns)), &bytes(white(columns))).is_same, "{columns}");
    }
}

#[test]
fn bit_equality_needs_same_format() {
    let picture = |steps: Option<f64>, limit: f64| {
        let value = |pixel| if pixel == 7 { f64::NAN } else { 0.5 + 0.2 * random(pixel, 0, 1) };
        Picture { steps: steps.map(|step| vec![[step; 3]; PIXELS]), limit, ..floats(value) }
    };
    let formats = [(None, f64::INFINITY), (Some(0.002), 0.99), (Some(0.004), 0.99), (Some(0.002), 0.98)];
    for (first, second) in (0..16).map(|pair| (pair / 4, pair % 4)) {
        let [a, b] = [first, second].map(|format: usize| picture(formats[format].0, formats[format].1));
        assert_eq!(compare(&a, &b).is_same, first == second, "{first} and {second}");
    }
}

#[test]
fn difference_is_relative_to_both_steps() {
    let picture = |step: f64, value: f64| {
        let steps = (step > 0.0).then(|| vec![[step; 3]; PIXELS]);
        Picture { steps, limit: 0.99, ..floats(move |_| value) }
    };
    // Without noise, the deviation is the root of the sum of both squares; these are two deviations apart.
    for (first, second, deviation) in [(0.003, 0.004, 0.005), (0.003, 0.0, 0.003), (0.0, 0.004, 0.004)] {
        let found = compare(&picture(first, 0.5), &picture(second, 0.5 + 2.0 * deviation));
        assert!((found.test.largest - 2.0).abs() < 1e-3, "{first} {second}: {}", found.test.largest);
        assert!((found.bias - 2.0 * deviation).abs() < 1e-12, "{first} {second}: {}", found.bias);
    }
    // Neighbouring bytes differ by no more than rounding.
    assert_eq!(
        compare(&bytes(|_| 0.5), &bytes(|_| 0.5 + 1.0 / 256.0)).test.largest_limit,
        largest_of(0, CHANCE)
    );
}

/// Compares a picture with a copy changed at some columns and rows.
fn changed(is_changed: impl Fn(u32, u32) -> bool, by: f64) -> Comparison {
    let value = |pixel: u32| 0.3 + 0.2 * random(pixel, 0, 1);
    compare(
        &floats(value),
        &floats(|pixel| value(pixel) + if is_changed(pixel % 80, pixel / 80) { by } else { 0.0 }),
    )
}

#[test]
fn few_pixels_allow_no_verdict() {
    let hole = changed(|x, y| (33..37).contains(&x) && (17..20).contains(&y), -0.25);
    assert!(hole.reasons.iter().any(|reason| reason.starts_with("a block is")), "{hole:?}");
    let worst = hole.test.worst(1)[0];
    assert_eq!((worst.x.clone(), worst.y.clone()), (32..40, 16..24));
    // A thousandth of the pixels, 3.84, counts as few. More of them could be noise.
    let places = [(5, 20), (35, 20), (65, 20), (75, 40)];
    let verdict = |count: usize| changed(|x, y| places[..count].contains(&(x, y)), 0.5).verdict();
    let [same, unclear] = [Verdict::Same, Verdict::Unclear];
    assert_eq!([0, 1, 3, 4].map(verdict), [same, unclear, unclear, same]);
    for (by, verdict) in [(0.09, same), (-0.09, same), (0.11, unclear), (-0.11, unclear)] {
        let found = changed(|x, y| (x, y) == (30, 20), by);
        let text =
            format!("only 1 of 3840 pixels differ by more than rounding, most by {:.1e} at 30,20", by.abs());
        let messages: Vec<&String> = found.notes.iter().chain(&found.unclear).collect();
        assert!(messages.iter().any(|message| message.starts_with(&text)), "{messages:?}");
        assert_eq!(found.verdict(), verdict, "{by}");
    }
}

#[test]
fn only_differing_channels_count_as_tries() {
    /// Column, row and channel.
    type Place = (usize, usize, usize);
    let one = floats(|pixel| 0.3 + 0.2 * random(pixel, 0, 1));
    let cases: [(&[Place], usize); 4] = [
        (&[], 0),
        (&[(3, 3, 0)], 1),
        (&[(3, 3, 0), (4, 5, 0), (3, 3, 2)], 2),
        (&[(7, 7, 0), (8, 7, 0), (7, 8, 0), (79, 47, 2)], 4),
    ];
    for (places, tries) in cases {
        let mut other = one.clone();
        places.iter().for_each(|(x, y, channel)| other.pixels[y * 80 + x][*channel] += 0.05);
        assert_eq!(compare(&one, &other).test.largest_limit, largest_of(tries, CHANCE), "{places:?}");
    }
}

#[test]
fn mistakes_of_a_file_are_hinted_at() {
    let right = floats(|pixel| {
        let (x, y) = (f64::from(pixel % 80) / 80.0, f64::from(pixel / 80) / 48.0);
        0.1 + 0.4 * (7.0 * x * x + y).sin().powi(2) + 0.2 * y * y + 0.1 * random(pixel, 0, 1)
    });
    let mut coloured = right.clone();
    coloured.pixels.iter_mut().for_each(|pixel| pixel[2] *= 0.3);
    let with = |pixels: Vec<[f64; 3]>| Picture { pixels, ..coloured.clone() };
    let moved = |to: fn(usize, usize) -> (usize, usize)| {
        let places = (0..PIXELS).map(|pixel| to(pixel % 80, pixel / 80));
        with(places.map(|(x, y)| coloured.pixels[y.min(47) * 80 + x.min(79)]).collect())
    };
    let changed = |change: fn(f64) -> f64| with(coloured.pixels.iter().map(|p| p.map(change)).collect());
    let swapped = coloured.pixels.iter().map(|[red, green, blue]| [*blue, *green, *red]).collect();
    for (second, part) in [
        (moved(|x, y| (x, 47 - y)), "upside down"),
        (moved(|x, y| (79 - x, y)), "mirrored"),
        (moved(|x, y| (79 - x, 47 - y)), "180 degrees"),
        (moved(|x, y| (x + 1, y)), "to the right by a pixel"),
        (moved(|x, y| (x, y.saturating_sub(1))), "shifted up by a pixel"),
        (with(swapped), "red and blue"),
        (changed(|x| 2.0 * x), "0.5000 times as bright"),
        (changed(f64::sqrt), "squared"),
        (changed(|x| x * x), "square roots"),
        (changed(|x| Encoding::Srgb.displayed(x, 0, 1)), "sRGB"),
    ] {
        let notes = compare_sides(&[coloured.clone(), second]).unwrap().notes;
        assert!(
            notes.iter().any(|note| note.contains("much closer") && note.contains(part)),
            "{part}: {notes:?}"
        );
    }
    let notes = compare_sides(&[coloured.clone(), changed(|x| x + 0.3)]).unwrap().notes;
    assert!(!notes.iter().any(|note| note.contains("mirrored")), "{notes:?}");
}
