//! Films of known noise.

use std::ops::Range;
use weekender::film::{Description, Film, fixed_point, key};

pub const RECIPE: &str = "[render]\nwidth = 7\nsamples_per_pixel = 10\n";

/// A pseudo-random number that depends only on its arguments.
pub fn noise(pixel: usize, sample: u64, channel: usize) -> f64 {
    let mut x = (pixel as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (sample << 20) ^ channel as u64;
    for _ in 0..3 {
        x = (x ^ (x >> 31)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    }
    (x >> 40) as f64 / 16_777_216.0
}

pub fn add(film: &mut Film, pixel: usize, sample: u64, radiance: [f64; 3]) -> bool {
    let half = (sample % 2) as usize;
    match fixed_point(radiance) {
        Some(sum) => film.halves_mut()[half][pixel].add(sum),
        None => return false,
    }
    true
}

/// A film of noise, filled as a renderer would fill it.
pub fn noisy_film(width: u32, height: u32, ranges: &[Range<u64>]) -> Film {
    let mut film = Film::new(width, height);
    for range in ranges {
        for sample in range.clone() {
            for pixel in 0..(width * height) as usize {
                add(&mut film, pixel, sample, [0, 1, 2].map(|c| noise(pixel, sample, c)));
            }
        }
        film.record(range.clone(), 0).unwrap();
    }
    film
}

pub fn description() -> Description {
    let mut description = Description::new(RECIPE);
    description.set(key::SCENE, "three-spheres");
    description.set(key::SAMPLES, 10);
    description.set(key::SECONDS, 1.5);
    description
}

/// Whether two recipes have the same text. Those of these tests describe no scene, so the program's own comparison cannot
/// read them.
pub fn same_recipe_text(first: &str, other: &str) -> Result<(), String> {
    if first == other { Ok(()) } else { Err(format!("one says {first}, the other {other}")) }
}
