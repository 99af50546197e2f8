//! The error estimate.

use super::common::{add, noisy_film};
use weekender::film::{ErrorEstimate, Film};

#[test]
fn the_error_is_that_of_the_mean() {
    // The halves differ by 0.2 everywhere: MSE = 0.04 / 4.
    let mut film = Film::new(4, 1, 2);
    for pixel in 0..4 {
        add(&mut film, pixel, 0, [0.6; 3]);
        add(&mut film, pixel, 1, [0.4; 3]);
    }
    assert_eq!(film.error(), None);
    film.record(0..1, 0).unwrap();
    assert_eq!(film.error(), None);
    film.record(1..2, 0).unwrap();
    let error = film.error().unwrap();
    assert!((error.rmse - 0.1).abs() < 1e-6, "{error:?}");
    assert!((error.rel_mse - 0.01 / 0.26).abs() < 1e-6, "{error:?}");
    assert_eq!(noisy_film(2, 2, 1, &[0..4]).error(), None);
}

#[test]
fn the_error_is_right_for_halves_of_different_counts() {
    // Noise is uniform in [0, 1) with variance 1/12 per sample. Of three samples, two are in half A.
    for samples in [3, 8, 9] {
        let error = noisy_film(200, 100, 2, &[0..samples]).error().unwrap();
        let expected = (1.0 / 12.0 / samples as f64).sqrt();
        assert!((error.rmse / expected - 1.0).abs() < 0.02, "{samples}: {error:?}, expected {expected}");
    }
}

#[test]
fn the_estimate_knows_how_far_off_it_may_be() {
    // 400 small films with different samples: compares the spread of their estimates with the stated uncertainty.
    let errors: Vec<_> =
        (0..400).map(|k| noisy_film(16, 12, 2, &[8 * k..8 * k + 8]).error().unwrap()).collect();
    let mean = |of: &dyn Fn(usize) -> f64| (0..errors.len()).map(of).sum::<f64>() / errors.len() as f64;
    let middle = mean(&|k| errors[k].rmse);
    let spread = mean(&|k| (errors[k].rmse - middle).powi(2)).sqrt();
    let said = mean(&|k| errors[k].rmse_deviation);
    assert!((said / spread - 1.0).abs() < 0.15, "said {said}, was {spread}");
    assert_eq!(Film::new(4, 3, 2).error(), None);
    let mut same = Film::new(4, 3, 2);
    same.record(0..2, 0).unwrap();
    let estimate = same.error().unwrap();
    assert_eq!(estimate.rmse_deviation, 0.0);
    let doubt = same.doubt(&estimate).unwrap();
    assert!(doubt.contains("no path has found any light in 2 samples"), "{doubt}");
}

#[test]
fn an_uncertainty_is_a_share_of_the_error() {
    let estimate = ErrorEstimate { rmse: 0.1, rmse_deviation: 0.002, rel_mse: 0.0 };
    assert_eq!(estimate.uncertainty(), "± 2.0 %");
    assert!((estimate.pixels_in_effect() - 625.0).abs() < 1e-6, "{}", estimate.pixels_in_effect());
    let none = ErrorEstimate { rmse: 0.0, rmse_deviation: 0.0, rel_mse: 0.0 };
    assert_eq!(none.uncertainty(), "± 0.1 %");
}

/// A film of two samples with noise only in its first `noisy` pixels.
fn film_with_noise_in(pixels: u32, noisy: usize) -> Film {
    let mut film = Film::new(pixels, 1, 2);
    for pixel in 0..pixels as usize {
        let by = if pixel < noisy { 0.5 } else { 0.0 };
        add(&mut film, pixel, 0, [0.5 + by; 3]);
        add(&mut film, pixel, 1, [0.5 - by; 3]);
    }
    film.record(0..2, 0).unwrap();
    film
}

#[test]
fn an_estimate_of_few_pixels_among_many_is_in_doubt() {
    for (pixels, noisy, is_doubted) in
        [(1000, 50, true), (1000, 1000, false), (1000, 300, false), (150, 50, false), (150, 5, true)]
    {
        let film = film_with_noise_in(pixels, noisy);
        let doubt = film.doubt(&film.error().unwrap());
        assert_eq!(doubt.is_some(), is_doubted, "{noisy} of {pixels}: {doubt:?}");
    }
}
