//! The error estimate.

use super::common::{add, noisy_film};
use weekender::film::{Film, PixelSum, ROUNDING_LIMIT, fixed_point};

#[test]
fn the_error_is_right_for_halves_of_different_counts() {
    // Noise is uniform in [0, 1) with variance 1/12 per sample. Of three samples, two are in half A.
    for samples in [3, 8, 9] {
        let error = noisy_film(200, 100, &[0..samples]).error().unwrap();
        let expected = (1.0 / 12.0 / samples as f64).sqrt();
        assert!((error.rmse / expected - 1.0).abs() < 0.02, "{samples}: {error:?}, expected {expected}");
    }
}

#[test]
fn stated_uncertainty_matches_the_spread() {
    // 400 small films with different samples. The own error of each deviates from the expected one as much as its estimate
    // does, so the stated uncertainty of their difference is the root of 2 times the spread of the estimates.
    let errors: Vec<_> = (0..400).map(|k| noisy_film(16, 12, &[8 * k..8 * k + 8]).error().unwrap()).collect();
    let mean = |of: &dyn Fn(usize) -> f64| (0..errors.len()).map(of).sum::<f64>() / errors.len() as f64;
    let middle = mean(&|k| errors[k].rmse);
    let spread = mean(&|k| (errors[k].rmse - middle).powi(2)).sqrt();
    let stated = mean(&|k| errors[k].rmse_deviation);
    let ratio = stated / (std::f64::consts::SQRT_2 * spread);
    assert!((ratio - 1.0).abs() < 0.15, "stated {stated}, estimates spread by {spread}");
    assert_eq!(Film::new(4, 3).error(), None);
}

#[test]
fn a_film_without_light_has_no_estimate() {
    let mut black = Film::new(4, 3);
    black.record(0..1, 0).unwrap();
    assert_eq!((black.error(), black.why_no_error()), (None, "only one half has samples"));
    assert!(!black.meets(1.0, None, 0.0));
    black.record(1..64, 0).unwrap();
    assert_eq!((black.error(), black.why_no_error()), (None, "no path has found any light"));
    // The picture cannot be brighter than the light.
    assert!(!black.meets(0.01, None, 1.0) && black.meets(0.01, None, 0.01) && black.meets(0.01, None, 0.0));
    // One sample in one pixel is enough to tell that there is light.
    add(&mut black, 5, 0, [0.0, 0.0, 0.5]);
    assert!(black.error().is_some());
}

#[test]
fn few_pixels_meet_a_target_with_room_to_spare() {
    for (noisy, meets_its_error) in [(1000, true), (50, false)] {
        let film = film_with_noise_in(1000, noisy);
        let error = film.error().unwrap();
        let meets = |target: f64| film.meets(target, Some(&error), 1.0);
        assert_eq!(meets(error.rmse), meets_its_error, "{noisy}");
        let room = 3.0 * error.rmse_deviation;
        assert!(!meets(0.99 * error.rmse) && meets(1.01 * (error.rmse + room)), "{noisy}");
        assert_eq!(meets(error.rmse + 0.9 * room), meets_its_error, "{noisy}");
    }
}

/// A film of two samples with noise only in its first `noisy` pixels.
fn film_with_noise_in(pixels: u32, noisy: usize) -> Film {
    let mut film = Film::new(pixels, 1);
    for pixel in 0..pixels as usize {
        let by = if pixel < noisy { 0.5 } else { 0.0 };
        add(&mut film, pixel, 0, [0.5 + by; 3]);
        add(&mut film, pixel, 1, [0.5 - by; 3]);
    }
    film.record(0..2, 0).unwrap();
    film
}

#[test]
fn estimates_dominated_by_few_pixels_are_doubted() {
    // One of few pixels, too.
    for (pixels, noisy, is_doubted) in [
        (1000, 50, true),
        (1000, 1000, false),
        (1000, 300, false),
        (150, 50, false),
        (150, 5, true),
        (67, 67, false),
        (66, 66, true),
        (12, 12, true),
    ] {
        let film = film_with_noise_in(pixels, noisy);
        let doubt = film.doubt(&film.error().unwrap());
        assert_eq!(doubt.is_some(), is_doubted, "{noisy} of {pixels}: {doubt:?}");
    }
    let film = film_with_noise_in(1000, 50);
    let message = film.doubt(&film.error().unwrap()).unwrap();
    // 1 / (1/50 - 1/1000) = 52.6
    assert!(["53", "1000", "100"].iter().all(|number| message.contains(number)), "{message}");
}

/// A film of samples that are all alike, more of them in the first half if their number is odd.
fn even_film(radiance: f64, samples: u64) -> Film {
    let mut film = Film::new(4, 3);
    let PixelSum(one) = fixed_point([radiance; 3]).unwrap();
    for (half, of_half) in film.halves_mut().iter_mut().zip([samples.div_ceil(2), samples / 2]) {
        half.fill(PixelSum(one.map(|k| k * of_half)));
    }
    film.record(0..samples, 0).unwrap();
    film
}

/// Equal samples round alike, which the halves do not show.
#[test]
fn the_error_includes_what_rounding_costs() {
    for radiance in [1e-7, 3.1e-8, 1e-6, 0.3] {
        for samples in [2, 5, 1001, 1 << 20] {
            let film = even_film(radiance, samples);
            let error = film.error().unwrap();
            let wrong = (film.mean(0)[0] - radiance).abs();
            assert!(error.rmse >= wrong, "{radiance}: {error:?}, but off by {wrong:e}");
            assert_eq!((error.rmse, error.rmse_deviation), (ROUNDING_LIMIT, 0.0));
            assert!(error.rel_mse > 0.0 && error.is_without_noise());
            assert_eq!(error.words(), "3e-8 RMSE, by rounding alone");
        }
    }
    let noisy = noisy_film(200, 100, &[0..8]).error().unwrap();
    assert!(!noisy.is_without_noise() && noisy.words().ends_with(" % RMSE"), "{}", noisy.words());
}

#[test]
fn noise_below_rounding_does_not_count() {
    let mut film = even_film(0.3, 64);
    film.halves_mut()[1][7].0[2] += 1;
    let error = film.error().unwrap();
    assert_eq!((error.rmse, error.rmse_deviation, film.doubt(&error)), (ROUNDING_LIMIT, 0.0, None));
}

#[test]
fn all_channels_count_and_dark_ones_more_in_rel_mse() {
    // Two halves of one sample each, of two pixels.
    let halves = [[[0.75, 0.25, 0.5], [0.0, 1.0, 0.125]], [[0.25, 0.25, 1.0], [0.5, 0.25, 0.0625]]];
    let mut film = Film::new(2, 1);
    let (mut square, mut relative) = (0.0, 0.0);
    for pixel in 0..2 {
        for (half, sums) in halves.iter().enumerate() {
            add(&mut film, pixel, half as u64, sums[pixel]);
        }
        let [first, second] = halves.map(|half| half[pixel]);
        for (a, b) in first.into_iter().zip(second) {
            let (error, mean): (f64, f64) = (0.5 * (a - b), 0.5 * (a + b));
            square += error * error / 6.0;
            relative += error * error / (mean * mean + 0.01) / 6.0;
        }
    }
    for samples in [0..1, 1..2] {
        assert_eq!(film.error(), None);
        film.record(samples, 0).unwrap();
    }
    let error = film.error().unwrap();
    assert!((error.rmse / square.sqrt() - 1.0).abs() < 1e-12, "{error:?}, but {square}");
    assert!((error.rel_mse / relative - 1.0).abs() < 1e-12, "{error:?}, but {relative}");
}
