//! The effect of rounding on a picture.

use super::data::Rounding;
use crate::film::Film;

/// Compares two films of the same samples; both have two halves.
///
/// A difference has two parts: the systematic effect of rounding, and noise from paths that rounding sent another
/// way. The noise is independent in the two halves, so the mean product of the halves' differences estimates the
/// square of the systematic part.
pub fn rounding(scene: &str, backend: &str, film: &Film, exact: &Film) -> Rounding {
    let scale = [0, 1].map(|half| 1.0 / film.half_sample_count(half) as f64);
    let (mut sum, mut squares, mut products, mut product_squares) = (0.0, 0.0, 0.0, 0.0);
    let pixels = film.halves()[0].len();
    for pixel in 0..pixels {
        let difference = |half: usize| {
            let (x, y) = (film.halves()[half][pixel].radiance(), exact.halves()[half][pixel].radiance());
            [0, 1, 2].map(|channel| (x[channel] - y[channel]) * scale[half])
        };
        let (a, b) = (difference(0), difference(1));
        let mut product = 0.0;
        for (a, b) in a.into_iter().zip(b) {
            sum += 0.5 * (a + b);
            squares += (0.5 * (a + b)).powi(2);
            product += a * b;
        }
        products += product;
        // The channels of a pixel are correlated: only pixels count as independent.
        product_squares += product * product;
    }
    let values = (3 * pixels) as f64;
    let floor_square = products / values;
    let deviation = product_squares.sqrt() / values;
    Rounding {
        scene: scene.to_owned(),
        backend: backend.to_owned(),
        samples: film.sample_count(),
        bias: sum / values,
        rms: (squares / values).sqrt(),
        floor: (floor_square > 2.0 * deviation).then(|| floor_square.sqrt()),
        floor_limit: (floor_square.max(0.0) + 2.0 * deviation).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PixelSum, fixed_point};
    use crate::sampling::pcg4d;

    /// A film of two samples per pixel: `base` plus the value of `of` for each half.
    fn film(of: impl Fn(u32, u32) -> f64) -> Film {
        let mut film = Film::new(64, 64, 2);
        for half in 0..2 {
            for pixel in 0..64 * 64 {
                let value = [0.5 + of(pixel, half); 3];
                let sum: PixelSum = fixed_point(value).unwrap();
                film.halves_mut()[half as usize][pixel as usize] = sum;
            }
        }
        film.record(0..2, 0).unwrap();
        film
    }

    /// Rare large differences, as from paths that took another way.
    fn chance(pixel: u32, half: u32) -> f64 {
        let [a, b, ..] = pcg4d([pixel, half, 3, 9]);
        if !a.is_multiple_of(50) { 0.0 } else { f64::from(b) / 4_294_967_296.0 - 0.5 }
    }

    #[test]
    fn a_systematic_difference_is_told_from_one_of_chance() {
        let exact = film(|_, _| 0.0);
        let found = rounding("s", "b", &film(|_, _| 1e-3), &exact);
        assert!((found.floor.unwrap() - 1e-3).abs() < 1e-6 && (found.bias - 1e-3).abs() < 1e-6, "{found:?}");
        let found = rounding("s", "b", &film(chance), &exact);
        assert!(found.floor.is_none() && found.floor_limit < found.rms, "{found:?}");
        let found = rounding("s", "b", &film(|p, h| chance(p, h) + 1e-2), &exact);
        assert!((found.floor.unwrap() - 1e-2).abs() < 4e-3, "{found:?}");
        // Halves that differ in opposite directions have nothing in common; the limit is a number all the same.
        let found = rounding("s", "b", &film(|_, half| if half == 0 { 1e-3 } else { -1e-3 }), &exact);
        assert!(found.floor.is_none() && found.floor_limit > 0.0, "{found:?}");
        // Films that are equal to the bit have no floor.
        let found = rounding("s", "b", &exact, &exact);
        assert_eq!((found.bias, found.rms, found.floor, found.floor_limit), (0.0, 0.0, None, 0.0));
    }

    /// Three samples per pixel, two in the first half and one in the second. In sixteenths, the mean of a half is 8 and
    /// what `more` says of it.
    fn uneven(more: &[[[f64; 3]; 2]]) -> Film {
        let mut film = Film::new(more.len() as u32, 1, 2);
        for (pixel, halves) in more.iter().enumerate() {
            for (half, samples) in [2.0, 1.0].into_iter().enumerate() {
                let sum = halves[half].map(|more| samples * (8.0 + more) / 16.0);
                film.halves_mut()[half][pixel] = fixed_point(sum).unwrap();
            }
        }
        film.record(0..3, 0).unwrap();
        film
    }

    #[test]
    fn rounding_is_worked_out_by_hand() {
        let pixels = [[[1.0, 2.0, 3.0], [3.0, -2.0, 1.0]], [[-1.0, 0.0, 2.0], [1.0, 4.0, 2.0]]];
        let of = |pixels: &[[[f64; 3]; 2]]| {
            rounding("a scene", "a backend", &uneven(pixels), &uneven(&vec![[[0.0; 3]; 2]; pixels.len()]))
        };
        let close = |found: f64, sixteenths: f64| (found - sixteenths / 16.0).abs() < 1e-12;
        let found = of(&pixels);
        assert_eq!(
            (found.scene.as_str(), found.backend.as_str(), found.samples),
            ("a scene", "a backend", 3)
        );
        // Half the sums are 2, 0, 2 and 0, 2, 2.
        assert!(close(found.bias, 8.0 / 6.0) && close(found.rms, (16.0_f64 / 6.0).sqrt()), "{found:?}");
        // The products of the pixels sum to 2 and 3, so they are 5/6 on average, with a deviation of the root of 13 over 6.
        let limit = (5.0_f64 / 6.0 + 2.0 * 13.0_f64.sqrt() / 6.0).sqrt();
        assert!(found.floor.is_none() && close(found.floor_limit, limit), "{found:?}");
        // Nine pixels of 2 each: 2/3 on average, with a deviation of 6/27.
        let found = of(&[pixels[0]; 9]);
        assert!(close(found.floor.unwrap(), (2.0_f64 / 3.0).sqrt()), "{found:?}");
        assert!(close(found.floor_limit, (2.0_f64 / 3.0 + 4.0 / 9.0).sqrt()), "{found:?}");
        // A mean product below 0 counts as 0 for the limit: here it is -1, with a deviation of 1.
        let found = of(&[[[1.0; 3], [-1.0; 3]]]);
        assert!(found.floor.is_none() && close(found.floor_limit, 2.0_f64.sqrt()), "{found:?}");
    }
}
