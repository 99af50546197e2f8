//! The effect of rounding on a picture.

use super::data::Rounding;
use crate::film::Film;

/// Compares two films of the same samples, each with two halves.
///
/// Their difference has two parts: the systematic effect of rounding, and noise from paths that rounding sent another
/// way. The noise is independent in the two halves, so the mean product of the halves' differences estimates the square
/// of the systematic part.
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
        // A pixel's channels are correlated, so only pixels count as independent.
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
    use crate::film::fixed_point;

    /// Two samples per pixel in the first half and one in the second. In sixteenths, each half's mean is 8 plus `more`.
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
    fn rounding_matches_hand_calculation() {
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
        // The products of the pixels sum to 2 and 3, so their mean is 5/6 with a deviation of sqrt(13) / 6.
        let limit = (5.0_f64 / 6.0 + 2.0 * 13.0_f64.sqrt() / 6.0).sqrt();
        assert!(found.floor.is_none() && close(found.floor_limit, limit), "{found:?}");
        // Nine pixels of 2 each: 2/3 on average, with a deviation of 6/27.
        let found = of(&[pixels[0]; 9]);
        assert!(close(found.floor.unwrap(), (2.0_f64 / 3.0).sqrt()), "{found:?}");
        assert!(close(found.floor_limit, (2.0_f64 / 3.0 + 4.0 / 9.0).sqrt()), "{found:?}");
        // A negative mean product counts as 0 for the limit: here it is -1, with a deviation of 1.
        let found = of(&[[[1.0; 3], [-1.0; 3]]]);
        assert!(found.floor.is_none() && close(found.floor_limit, 2.0_f64.sqrt()), "{found:?}");
    }
}
