//! Films whose noise is unusual: none, or more than their difference.

use super::{PairedSamples, Side, compare};
use crate::film::{Film, fixed_point};
use std::hash::{DefaultHasher, Hash, Hasher};

/// A film with one sample in each half, of the radiance that `value` returns for half and pixel.
fn side(value: impl Fn(u32, u32) -> f64) -> Side {
    let mut film = Film::new(80, 48, 2);
    for (half, pixels) in film.halves_mut().iter_mut().enumerate() {
        for (pixel, sum) in pixels.iter_mut().enumerate() {
            *sum = fixed_point([value(half as u32, pixel as u32); 3]).unwrap();
        }
    }
    film.record(0..2, 0).unwrap();
    Side::of_film(String::new(), String::new(), film)
}

#[test]
fn pictures_without_noise_are_equal_or_infinitely_far_apart() {
    let dark = side(|_, _| 0.25);
    assert_eq!(compare(&dark, &dark, None).times_noise(), 0.0);
    assert_eq!(compare(&dark, &side(|_, _| 0.75), None).times_noise(), f64::INFINITY);
    let found = compare(&dark, &side(|_, pixel| 0.25 + f64::from(pixel % 2)), None);
    assert_eq!((found.rms, found.times_noise()), (0.5_f64.sqrt(), f64::INFINITY));
}

/// The halves differ a lot, but both pictures have the same two.
#[test]
fn blocks_that_are_nearer_than_the_halves_allow_are_remarked_on() {
    let random = |half: u32, pixel: u32| {
        let mut hasher = DefaultHasher::new();
        [half, pixel].hash(&mut hasher);
        hasher.finish() as f64 / 2.0_f64.powi(64)
    };
    let [one, swapped, other] = [
        side(random),
        side(|half, pixel| random(1 - half, pixel)),
        side(|half, pixel| random(half + 2, pixel)),
    ];
    let is_remarked_on = |a: &Side, b: &Side, paired: Option<PairedSamples>| {
        compare(a, b, paired).notes.iter().any(|note| note.contains("do the halves belong to one picture?"))
    };
    assert!(is_remarked_on(&one, &swapped, None));
    assert!(!is_remarked_on(&one, &other, None));
    // Pictures of the same samples may be as near as they like.
    assert!(!is_remarked_on(&one, &swapped, Some(PairedSamples::default())));
}
