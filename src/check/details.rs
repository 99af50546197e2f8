//! Mistakes that blocks cannot show: at edges, pixel by pixel, and in the last bit of all bytes.

use super::compared::{Compared, compare};
use super::hypothesis::{Effort, Hypothesis, Studio};
use super::mistake::Mistake;
use super::picture::Mine;
use crate::render::RenderError;

/// Least difference of a pixel's neighbours at an edge, linear radiance.
const EDGE: f64 = 0.1;

/// Decides among hypotheses that differ at edges only, pixel by pixel: the right picture, all samples at the centre of
/// the pixel, or pixels that are shifted.
pub fn by_pixels(
    mine: &Mine,
    studio: &mut Studio,
    right: &Compared,
    effort: Effort,
) -> Result<Option<Compared>, RenderError> {
    let recipe = studio.recipe().clone();
    let mut rivals = Vec::new();
    for mistake in Mistake::ALL.into_iter().filter(|mistake| mistake.is_of_pixels()) {
        if mistake.applies_to(&recipe) {
            for hypothesis in Hypothesis::of(mistake, &recipe) {
                let expected = studio.render(&hypothesis, effort)?;
                rivals.push((hypothesis, expected));
            }
        }
    }
    let (width, height) = (mine.width as usize, mine.height as usize);
    let (mut own, mut pixels) = (0.0, 0);
    let mut errors = vec![0.0; rivals.len()];
    for (index, bytes) in mine.bytes.iter().enumerate() {
        let (column, row) = (index % width, index / width);
        if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
            continue;
        }
        for (channel, byte) in bytes.iter().enumerate() {
            let at = |pixel: usize| right.expected.pixels[pixel][channel];
            let across = (at(index + 1) - at(index - 1)).abs();
            if across.max((at(index + width) - at(index - width)).abs()) < EDGE {
                continue;
            }
            pixels += 1;
            let [linear, _] = right.hypothesis.linear(*byte, row, height);
            own += (linear - at(index)).powi(2);
            for (error, (_, rival)) in errors.iter_mut().zip(&rivals) {
                *error += (linear - rival.pixels[index][channel]).powi(2);
            }
        }
    }
    let least = errors.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(match least {
        Some((index, error)) if pixels > 0 && error < BETTER * own => {
            let (hypothesis, expected) = rivals.swap_remove(index);
            Some(compare(mine, hypothesis, expected))
        }
        _ => None,
    })
}

/// A rival must leave less than this part of the squared error at edges.
const BETTER: f64 = 0.8;

/// Whether nearly all bytes are 0 or 255, though the picture should have values between. Cutting turns dark values into
/// 0, but none of them into 255.
pub fn is_truncated(mine: &Mine, right: &Compared) -> bool {
    let (width, height) = (mine.width as usize, mine.height as usize);
    let is_end = |byte: &u8| *byte <= 1 || *byte >= 254;
    let all = 3 * mine.bytes.len();
    let ends = mine.bytes.iter().flatten().filter(|byte| is_end(byte)).count();
    let expected = right.expected.pixels.iter().enumerate();
    let (mut expected_ends, mut too_bright) = (0, 0);
    for ((index, pixel), bytes) in expected.zip(&mine.bytes) {
        for (x, byte) in pixel.iter().zip(bytes) {
            let should_be = right.hypothesis.byte_of(*x, index / width, height);
            expected_ends += usize::from(is_end(&should_be));
            too_bright += usize::from(*byte >= 254 && should_be < 128);
        }
    }
    100 * ends >= 99 * all && 2 * expected_ends < all && 100 * too_bright <= all
}

/// Bytes of 255 times the value instead of 256 times, cut off: values are then smaller by 1/256 everywhere.
pub fn times_integer(mine: &Mine, right: &Compared) -> Option<Compared> {
    let (width, height) = (mine.width as usize, mine.height as usize);
    // Noise is without bias in linear values, so the loss is fitted there.
    let (mut product, mut square, mut scaled, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (index, (bytes, expected)) in mine.bytes.iter().zip(&right.expected.pixels).enumerate() {
        let row = index / width;
        for (byte, x) in bytes.iter().copied().zip(expected.iter().copied()) {
            let [linear, _] = right.hypothesis.linear(byte, row, height);
            // At the upper end, 255 is a limit and not a value.
            if byte >= 254 || !(0.05..=0.98).contains(&x) {
                continue;
            }
            let loss = x - right.hypothesis.times_255(x, row, height);
            product += (linear - x) * loss;
            square += loss * loss;
            scaled += (linear - x).powi(2) * loss * loss;
            count += 1.0;
        }
    }
    if count < 1000.0 {
        return None;
    }
    let (slope, deviation) = (-product / square, scaled.sqrt() / square);
    ((slope - 1.0).abs() < 0.4 && slope > 6.0 * deviation).then(|| {
        let hypothesis = right.hypothesis.blamed_on(Mistake::TimesInteger);
        Compared { hypothesis, ..right.clone() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::hypothesis::Expected;
    use crate::stages::Stage;
    use glam::DVec3;
    use std::sync::Arc;

    /// The bytes that `hypothesis` makes of a picture.
    fn shown(hypothesis: &Hypothesis, expected: &Expected, [width, height]: [u32; 2]) -> Mine {
        let row = |index: usize| index / width as usize;
        let pixels = expected.pixels.iter().enumerate();
        let bytes = pixels
            .map(|(index, pixel)| pixel.map(|x| hypothesis.byte_of(x, row(index), height as usize)))
            .collect();
        Mine { width, height, bytes, format: "P3", damages: Vec::new() }
    }

    #[test]
    fn a_right_picture_of_a_few_edges_has_no_mistake_of_pixels() {
        let mut recipe = Stage::find("antialiased").unwrap().recipe();
        (recipe.settings.width, recipe.settings.height) = (16, 9);
        let scene = Arc::make_mut(&mut recipe.scene);
        scene.spheres.truncate(1);
        (scene.spheres[0].center, scene.spheres[0].radius) = (DVec3::NEG_Z, 0.2);
        let mut studio = Studio::new(&recipe).unwrap();
        let effort = Effort { fast: 256, plain: 16 };
        let hypothesis = Hypothesis::right(studio.recipe());
        let expected = studio.render(&hypothesis, effort).unwrap();
        let mine = shown(&hypothesis, &expected, [16, 9]);
        let right = compare(&mine, hypothesis, expected);
        let found = by_pixels(&mine, &mut studio, &right, effort).unwrap();
        assert_eq!(found.and_then(|found| found.hypothesis.mistake), None);
    }

    #[test]
    fn a_factor_of_255_is_found_although_it_is_smaller_than_the_step_of_a_byte() {
        let recipe = Stage::find("lambertian-gamma").unwrap().recipe();
        let right = Hypothesis::right(&recipe);
        let value = |index: usize| 0.1 + 0.8 * (index * 7919 % 12_289) as f64 / 12_289.0;
        let pixels = (0..64 * 64).map(|pixel| [0, 1, 2].map(|channel| value(3 * pixel + channel))).collect();
        let expected = Expected { pixels };
        let found = |hypothesis: &Hypothesis| {
            let mine = shown(hypothesis, &expected, [64, 64]);
            let compared = compare(&mine, right.clone(), expected.clone());
            times_integer(&mine, &compared).and_then(|found| found.hypothesis.mistake)
        };
        assert_eq!(found(&right), None);
        let of_255 = Hypothesis::of(Mistake::TimesInteger, &recipe).remove(0);
        assert_eq!(found(&of_255), Some(Mistake::TimesInteger));
    }

    /// What is found at edges if `planted` was made, and what if nothing was.
    fn found_at_edges(id: &str, size: [u32; 2], planted: Mistake) -> [Option<Mistake>; 2] {
        let mut recipe = Stage::find(id).unwrap().recipe();
        [recipe.settings.width, recipe.settings.height] = size;
        let mut studio = Studio::new(&recipe).unwrap();
        let effort = Effort { fast: 64, plain: 16 };
        let right = Hypothesis::right(studio.recipe());
        let expected = studio.render(&right, effort).unwrap();
        let planted = Hypothesis::of(planted, studio.recipe()).remove(0);
        let wrong = studio.render(&planted, effort).unwrap();
        [shown(&planted, &wrong, size), shown(&right, &expected, size)].map(|mine| {
            let compared = compare(&mine, right.clone(), expected.clone());
            let found = by_pixels(&mine, &mut studio, &compared, effort).unwrap();
            found.and_then(|found| found.hypothesis.mistake)
        })
    }

    #[test]
    fn a_mistake_of_pixels_is_found_at_edges_and_nowhere_else() {
        for planted in Mistake::ALL.into_iter().filter(|mistake| mistake.is_of_pixels()) {
            assert_eq!(found_at_edges("antialiased", [64, 36], planted), [Some(planted), None]);
        }
        // The sky changes too slowly to tell a shift of half a pixel from another light.
        assert_eq!(found_at_edges("sky", [32, 18], Mistake::HalfPixelUp), [None, None]);
    }

    #[test]
    fn nearly_all_bytes_of_a_truncated_picture_are_ends_though_few_should_be() {
        let right = Hypothesis::right(&Stage::find("sky").unwrap().recipe());
        let is_found = |ends: usize, white: usize| {
            let byte =
                |index: usize| if index < ends { [0, 255, 1, 254][index % 4] } else { [2, 253][index % 2] };
            let bytes = (0..100).map(|pixel| [0, 1, 2].map(|channel| byte(3 * pixel + channel))).collect();
            let mine = Mine { width: 10, height: 10, bytes, format: "P3", damages: Vec::new() };
            let pixels = (0..100).map(|pixel| [if pixel < white { 1.0 } else { 0.5 }; 3]).collect();
            is_truncated(&mine, &compare(&mine, right.clone(), Expected { pixels }))
        };
        assert!(is_found(300, 0) && is_found(297, 0) && !is_found(296, 0));
        assert!(is_found(300, 49) && !is_found(300, 50));
    }

    #[test]
    fn cutting_makes_no_dark_value_white() {
        let right = Hypothesis::right(&Stage::find("sky").unwrap().recipe());
        // Three hundred values, all 0 or 255, of which so many are white though they should be dark.
        let is_found = |white: usize, linear: f64| {
            let byte = |index: usize| if index < white { [254, 255][index % 2] } else { 0 };
            let bytes = (0..100).map(|pixel| [0, 1, 2].map(|channel| byte(3 * pixel + channel))).collect();
            let mine = Mine { width: 10, height: 10, bytes, format: "P3", damages: Vec::new() };
            let expected = Expected { pixels: vec![[linear; 3]; 100] };
            is_truncated(&mine, &compare(&mine, right.clone(), expected))
        };
        // Below a linear value of 1/2, a byte is below 128.
        assert!(is_found(0, 0.25) && is_found(3, 0.25) && !is_found(4, 0.25) && !is_found(300, 0.49));
        assert!(is_found(4, 0.5) && is_found(300, 0.75));
    }

    /// Of 64 x 64 pixels, with another factor instead of 255/256, and with noise.
    #[test]
    fn only_a_loss_of_about_a_256th_is_blamed_on_a_factor_of_255() {
        let recipe = Stage::find("lambertian-gamma").unwrap().recipe();
        let right = Hypothesis::right(&recipe);
        let value = |index: usize| 0.25 + 0.4 * (index * 7919 % 12_289) as f64 / 12_289.0;
        let picture = |of: &dyn Fn(usize) -> f64| Expected {
            pixels: (0..64 * 64).map(|pixel| [0, 1, 2].map(|channel| of(3 * pixel + channel))).collect(),
        };
        let found = |factor: f64, noise: f64| {
            // The displayed value is the root of the linear one.
            let darker = |index: usize| {
                let sign = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
                value(index) * factor * factor + sign * noise
            };
            let mine = shown(&right, &picture(&darker), [64, 64]);
            times_integer(&mine, &compare(&mine, right.clone(), picture(&value))).is_some()
        };
        let part = |loss: f64| 1.0 - loss / 256.0;
        let factors = [-1.0, 0.0, 0.5, 0.7, 1.0, 1.3, 1.5, 2.0];
        assert_eq!(
            factors.map(|loss| found(part(loss), 0.0)),
            [false, false, false, true, true, true, false, false]
        );
        // Noise of which a mean over all values cannot be told from no loss.
        assert_eq!([0.02, 0.2].map(|noise| found(part(1.0), noise)), [true, false]);
    }

    #[test]
    fn a_thousand_values_are_needed_to_see_a_factor_of_255() {
        let recipe = Stage::find("lambertian-gamma").unwrap().recipe();
        let right = Hypothesis::right(&recipe);
        let of_255 = Hypothesis::of(Mistake::TimesInteger, &recipe).remove(0);
        let found = |pixels: u32, from: f64, to: f64| {
            let value = |index: u32| from + (to - from) * f64::from(index * 7919 % 12_289) / 12_289.0;
            let linear =
                (0..pixels).map(|pixel| [0, 1, 2].map(|channel| value(3 * pixel + channel))).collect();
            let expected = Expected { pixels: linear };
            let mine = shown(&of_255, &expected, [pixels, 1]);
            times_integer(&mine, &compare(&mine, right.clone(), expected)).is_some()
        };
        assert!(!found(333, 0.1, 0.9) && found(334, 0.1, 0.9));
        // What is too dark or cut off tells nothing.
        assert!(!found(2000, 0.0, 0.049) && found(2000, 0.051, 0.2));
        assert!(!found(2000, 0.981, 1.2) && found(2000, 0.8, 0.979));
    }
}
