//! Exact sums, and the picture that is resolved from them.

use super::common::{add, noisy_film};
use weekender::film::{
    FIXED_POINT_MAX, FIXED_POINT_SCALE, Film, PixelSum, RADIANCE_LIMIT, SampleRanges, fixed_point, to_byte,
};
use weekender::stages::Transfer;

#[test]
fn invalid_radiance_is_rejected_and_the_picture_stays_finite() {
    let mut film = Film::new(1, 1);
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-30];
    let mut rejected = 0;
    for (sample, x) in bad.into_iter().enumerate() {
        for channel in 0..3 {
            let mut radiance = [0.5; 3];
            radiance[channel] = x;
            rejected += u64::from(!add(&mut film, 0, sample as u64, radiance));
        }
    }
    assert!(add(&mut film, 0, 12, [1.0, 0.0, -0.0]));
    film.record(0..13, rejected).unwrap();
    assert_eq!(film.rejected(), 12);
    assert_eq!(film.pixel_sum(0), PixelSum([1 << 24, 0, 0]));
    assert!(film.mean(0).iter().all(|x| x.is_finite()));
}

#[test]
fn fixed_point_rounds_and_saturates() {
    let k = |x: f64| fixed_point([x; 3]).unwrap().0[0];
    assert_eq!(k(1.0), 1 << 24);
    assert_eq!(k(0.6 / FIXED_POINT_SCALE), 1);
    assert_eq!(k(0.4 / FIXED_POINT_SCALE), 0);
    assert_eq!(k(RADIANCE_LIMIT), u64::from(FIXED_POINT_MAX));
    assert_eq!(k(f64::MAX), u64::from(FIXED_POINT_MAX));
    let largest = f32::from_bits((RADIANCE_LIMIT as f32).to_bits() - 1);
    assert_eq!(k(f64::from(largest)), u64::from(FIXED_POINT_MAX));
}

/// A film of one sample in which one channel takes all of `values`.
fn film_of(values: &[f64]) -> Film {
    let mut film = Film::new(values.len() as u32, 1);
    for (pixel, x) in values.iter().enumerate() {
        add(&mut film, pixel, 0, [*x; 3]);
    }
    film.record(0..1, 0).unwrap();
    film
}

#[test]
fn bytes_step_where_the_book_steps() {
    // (b / 256)^2 is exact in fixed point for every byte b.
    for byte in 0..=255_u8 {
        let edge = (f64::from(byte) / 256.0).powi(2);
        let below = edge - 1.0 / FIXED_POINT_SCALE;
        let film = film_of(&[edge, below.max(0.0)]);
        let bytes = film.to_rgb8(Transfer::Gamma2);
        assert_eq!(bytes[..3], [byte; 3], "at the edge of {byte}");
        assert_eq!(bytes[3..], [byte.saturating_sub(1); 3], "below the edge of {byte}");
        let bytes = film_of(&[f64::from(byte) / 256.0]).to_rgb8(Transfer::Linear);
        assert_eq!(bytes, [byte; 3]);
    }
    assert_eq!(film_of(&[1.0, 100.0]).to_rgb8(Transfer::Gamma2), [255; 6]);
    assert_eq!(Film::new(2, 2).to_rgb8(Transfer::Gamma2), [0; 12]);
}

#[test]
fn exposure_multiplies_before_the_transfer() {
    let film = film_of(&[0.25, 0.125, 100.0]);
    let shown = |stops| film.exposed(Transfer::Gamma2, stops).iter().step_by(3).copied().collect::<Vec<_>>();
    assert_eq!(shown(0.0), [128, 90, 255]);
    assert_eq!(shown(1.0), [181, 128, 255], "twice as bright");
    assert_eq!(shown(-2.0), [64, 45, 255]);
    assert_eq!(shown(-10.0), [4, 2, 80]);
    assert_eq!(film.exposed(Transfer::Linear, 1.0)[0], 128);
    assert_eq!(film.exposed(Transfer::Gamma2, 0.0), film.to_rgb8(Transfer::Gamma2));
}

#[test]
fn the_upper_half_can_stay_linear() {
    let mut film = Film::new(1, 3);
    for pixel in 0..3 {
        add(&mut film, pixel, 0, [0.25; 3]);
    }
    film.record(0..1, 0).unwrap();
    let bytes = film.to_rgb8(Transfer::LinearAboveGamma2);
    assert_eq!(bytes, [64, 64, 64, 128, 128, 128, 128, 128, 128]);
}

#[test]
fn resolved_rows_match_the_picture() {
    let noisy = noisy_film(7, 5, &[0..6]);
    let mut one_half = noisy.try_blank().unwrap();
    for (index, sum) in one_half.halves_mut()[0].iter_mut().enumerate() {
        *sum = noisy.pixel_sum(index);
    }
    for film in [noisy, one_half] {
        for transfer in [Transfer::Linear, Transfer::Gamma2, Transfer::LinearAboveGamma2] {
            let whole = film.to_rgb8(transfer);
            let mut expected = Vec::new();
            for pixel in 0..35 {
                expected.extend(film.mean(pixel).map(|x| to_byte(x, transfer, pixel / 7, 5)));
            }
            assert_eq!(whole, expected);
            let mut part = vec![0; 3 * 7 * 2];
            film.resolve_rows(2..4, transfer, &mut part);
            assert_eq!(part, whole[2 * 21..4 * 21]);
        }
        let means = film.means();
        assert!((0..35).all(|i| means[i] == film.mean(i).map(|x| x as f32)));
    }
}

#[test]
fn sums_are_limited_by_the_sample_count() {
    let most = u64::from(FIXED_POINT_MAX);
    // Of five samples, three are in the first half.
    let samples = SampleRanges::from_ranges([0..5]).unwrap();
    let film = |halves: [u64; 2], rejected| {
        let mut film = Film::new(2, 1);
        film.halves_mut().iter_mut().zip(halves).for_each(|(half, k)| half.fill(PixelSum([0, 0, k])));
        film.with_samples(samples.clone(), rejected)
    };
    assert!(film([3 * most, 2 * most], 10).is_ok());
    for halves in [[3 * most + 1, 0], [0, 2 * most + 1]] {
        assert!(film(halves, 0).unwrap_err().to_string().contains("the sum of pixel 0"));
    }
    assert!(film([0, 0], 11).is_err());
}
