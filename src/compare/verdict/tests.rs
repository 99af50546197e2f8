//! Noise, rounding, and channels that are clipped or no numbers.

use super::*;
use crate::compare::PairedSums;
use crate::film::{FIXED_POINT_SCALE, Film, PixelSum, fixed_point};
use crate::sampling::pcg4d;

/// Two samples per pixel: noise that depends on pixel and half, and an offset.
fn side(seed: u32, offset: f64) -> Side {
    let mut film = Film::new(80, 48, 2);
    for half in 0..2_u32 {
        for pixel in 0..80 * 48 {
            let noise = f64::from(pcg4d([pixel, half, seed, 5])[0]) / 4_294_967_296.0;
            let sum: PixelSum = fixed_point([0.5 + 0.2 * noise + offset; 3]).unwrap();
            film.halves_mut()[half as usize][pixel as usize] = sum;
        }
    }
    film.record(0..2, 0).unwrap();
    Side::of_film(String::new(), String::new(), film)
}

#[test]
fn noise_hides_a_small_offset_but_not_between_the_same_samples() {
    let noise = compare(&side(1, 0.0), &side(2, 0.0), None);
    assert!(noise.is_equal(), "{:?}", noise.reasons);
    assert!((noise.times_noise() - 1.0).abs() < 0.1, "{}", noise.times_noise());
    assert!(compare(&side(1, 0.0), &side(2, 2e-3), None).is_equal());
    let same = compare(&side(1, 0.0), &side(1, 2e-3), None);
    assert!(!same.is_equal() && same.times_noise() < 0.1, "{same:?}");
    assert!(compare(&side(1, 0.0), &side(1, 1e-6), None).is_equal());
    assert!(compare(&side(1, 0.0), &side(1, 0.0), None).is_same);
}

#[test]
fn nan_or_infinity_in_only_one_picture_is_a_difference() {
    let floats = |value: f64| {
        let mut side = side(1, 0.0);
        side.pixels.iter_mut().take(60).for_each(|pixel| pixel[1] = value);
        side.film = None;
        side
    };
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    for (a, b) in [(nan, 0.5), (0.5, inf), (-inf, 0.5), (nan, inf), (inf, -inf), (nan, -inf)] {
        let found = compare(&floats(a), &floats(b), None);
        assert!(!found.is_equal() && !found.is_same, "{a} and {b}");
        assert_eq!((found.non_finite.differing, found.non_finite.differing_pixels), (60, 60));
        assert_eq!((found.non_finite.first, found.non_finite.alike), (Some([0, 0]), 0));
        assert!(found.reasons[0].starts_with("60 channels of 60 pixels are NaN"), "{:?}", found.reasons);
    }
    for (a, b) in [(nan, -nan), (inf, inf), (-inf, -inf)] {
        let found = compare(&floats(a), &floats(b), None);
        assert!(found.is_equal() && found.is_same, "{a} and {b}: {:?}", found.reasons);
        assert_eq!((found.non_finite.differing, found.non_finite.alike), (0, 60));
    }
    // Zeros of different signs are equal, but not to the bit.
    let found = compare(&floats(0.0), &floats(-0.0), None);
    assert!(found.is_equal() && !found.is_same);
}

#[test]
fn a_picture_without_a_finite_number_equals_no_picture() {
    let mut none = side(1, 0.0);
    (none.film, none.pixels) = (None, vec![[f64::NAN; 3]; 80 * 48]);
    let found = compare(&none, &none, None);
    assert!(!found.is_equal() && !found.is_same, "{found:?}");
}

#[test]
fn the_largest_value_of_an_integer_format_stands_for_any_larger_number() {
    let whole = |value: f64| {
        let mut side = side(1, 0.0);
        (side.film, side.limit) = (None, 0.99);
        side.pixels[7][2] = value;
        side.steps = Some(vec![[0.002; 3]; 80 * 48]);
        side
    };
    let float = |value: f64| {
        let mut side = side(1, 0.0);
        side.film = None;
        side.pixels[7][2] = value;
        side
    };
    let end = whole(f64::NAN);
    for beyond in [1.0, 50.0, f64::INFINITY] {
        assert!(compare(&end, &float(beyond), None).is_equal(), "{beyond}");
    }
    assert!(compare(&end, &end, None).is_equal());
    for other in [f64::NAN, f64::NEG_INFINITY] {
        assert!(!compare(&float(other), &end, None).is_equal(), "{other}");
    }
    assert!(!compare(&whole(0.5), &float(f64::INFINITY), None).is_equal());
}

#[test]
fn values_beyond_an_integer_format_are_left_out_on_both_sides() {
    let whole = |value: f64| {
        let mut side = side(1, 0.0);
        (side.film, side.limit) = (None, 0.99);
        side.pixels.iter_mut().take(80 * 8).for_each(|pixel| *pixel = [value; 3]);
        side.steps = Some(vec![[0.002; 3]; 80 * 48]);
        side
    };
    let film = |value: f64| {
        let mut side = side(1, 0.0);
        side.pixels.iter_mut().take(80 * 8).for_each(|pixel| *pixel = [value; 3]);
        side
    };
    // At or above the limit of the other picture: unknown, and no difference.
    for (a, b) in [(f64::NAN, 5.0), (f64::NAN, 0.99), (0.988, 0.99)] {
        for found in [compare(&whole(a), &film(b), None), compare(&film(b), &whole(a), None)] {
            assert!(found.is_equal(), "{a} and {b}: {:?}", found.reasons);
            assert_eq!(found.left_out, 3 * 80 * 8, "{a} and {b}");
        }
    }
    assert_eq!(compare(&whole(0.5), &film(0.5), None).left_out, 0);
    assert!(!compare(&whole(0.5), &film(0.6), None).is_equal());
}

#[test]
fn the_bias_is_the_second_less_the_first() {
    let (dark, bright) = (side(1, 0.0), side(1, 2e-3));
    for (first, second, sign) in [(&dark, &bright, 1.0), (&bright, &dark, -1.0)] {
        let mut sums = PairedSums::default();
        sums.add(first.film.as_ref().unwrap(), second.film.as_ref().unwrap());
        let found = compare(first, second, Some(sums.finish()));
        assert!((found.bias - sign * 2e-3).abs() < 1e-6, "{}", found.bias);
        // Parted samples do not count toward the paired bias: the sums of these films differ by too much.
        assert_eq!(found.paired.unwrap().parted, 80 * 48);
    }
    let (dark, bright) = (side(1, 0.0), side(1, 1e-5));
    let mut sums = PairedSums::default();
    sums.add(dark.film.as_ref().unwrap(), bright.film.as_ref().unwrap());
    assert!((sums.finish().bias - 2e-5).abs() < 1e-6, "{:?}", sums.finish());
}

#[test]
fn paired_samples_distinguish_other_paths_from_rounding() {
    let (a, b) = (side(1, 0.0), side(1, 1e-5));
    let mut sums = PairedSums::default();
    let (film_a, film_b) = (a.film.as_ref().unwrap(), b.film.as_ref().unwrap());
    sums.add(film_a, film_b);
    let found = sums.finish();
    assert_eq!((found.count, found.parted), (80 * 48, 0));
    // A film of two samples holds their sum.
    assert!((found.rms - 2e-5).abs() < 1e-6, "{found:?}");
    let other = side(2, 0.0);
    sums.add(film_a, other.film.as_ref().unwrap());
    assert!(sums.finish().parted_share() > 0.4);
}

/// With many samples the noise of the mean is far below what rounding may do to it.
#[test]
fn a_mean_that_rounding_moves_is_equal() {
    let side = |offset: f64| {
        let samples = 1 << 20;
        let sum = (samples / 2) as f64 * (0.5 + offset) * FIXED_POINT_SCALE;
        let mut film = Film::new(80, 48, 2);
        film.halves_mut().iter_mut().flatten().for_each(|pixel| *pixel = PixelSum([sum.round() as u64; 3]));
        film.record(0..samples, 0).unwrap();
        Side::of_film(String::new(), String::new(), film)
    };
    let rounded = compare(&side(0.0), &side(ROUNDING_BIAS), None);
    assert!(rounded.is_equal(), "{:?}", rounded.reasons);
    let moved = compare(&side(0.0), &side(5.0 * ROUNDING_BIAS), None);
    assert!(moved.reasons.iter().any(|reason| reason.starts_with("the mean is")), "{:?}", moved.reasons);
}

#[test]
fn pictures_are_the_same_to_the_bit_only_in_one_format() {
    let picture = |steps: Option<f64>, limit: f64| {
        let mut side = side(1, 0.0);
        (side.film, side.limit) = (None, limit);
        side.pixels[7] = [f64::NAN; 3];
        side.steps = steps.map(|step| vec![[step; 3]; 80 * 48]);
        side
    };
    let formats = [(None, f64::INFINITY), (Some(0.002), 0.99), (Some(0.004), 0.99), (Some(0.002), 0.98)];
    for (first, (steps, limit)) in formats.into_iter().enumerate() {
        for (second, (other_steps, other_limit)) in formats.into_iter().enumerate() {
            let found = compare(&picture(steps, limit), &picture(other_steps, other_limit), None);
            assert_eq!(found.is_same, first == second, "{first} and {second}");
            let is_noted = found.notes.iter().any(|note| note.contains("from the spread of the differences"));
            assert_eq!(is_noted, first != second, "{first} and {second}");
        }
    }
}

#[test]
fn a_difference_is_measured_by_the_steps_of_both_pictures() {
    let picture = |step: f64, offset: f64| {
        let mut side = side(1, 0.0);
        (side.film, side.limit) = (None, 0.99);
        side.pixels = vec![[0.5 + offset; 3]; 80 * 48];
        side.steps = (step > 0.0).then(|| vec![[step; 3]; 80 * 48]);
        side
    };
    // Without noise, the deviation is the root of the sum of both squares; these are two deviations apart.
    for (first, second, deviation) in
        [(0.003, 0.004, 0.005), (0.003, 0.0, 0.003), (0.0, 0.004, 0.004), (0.004, 0.003, 0.005)]
    {
        let found = compare(&picture(first, 0.0), &picture(second, 2.0 * deviation), None);
        assert!((found.test.largest - 2.0).abs() < 1e-3, "{first} {second}: {}", found.test.largest);
        assert!((found.bias - 2.0 * deviation).abs() < 1e-12, "{first} {second}: {}", found.bias);
    }
}
