//! What of a film is shown: the picture itself, or something about it as a heat map.

use crate::film::Film;
use crate::stages::Transfer;
use std::sync::Arc;

/// What a [`super::Picture`] shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum View {
    /// The picture with the job's transfer.
    #[default]
    Picture,
    /// The standard error of each pixel's mean, as the halves show it; black with one half.
    StandardError,
    /// How far each pixel is from a reference. A film of another size is shown as a picture.
    Difference(Arc<Reference>),
}

/// A picture to compare with, linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Row by row from the top.
    pub means: Vec<[f32; 3]>,
}

impl Reference {
    /// What a film shows now.
    pub fn of(film: &Film) -> Self {
        Reference { width: film.width(), height: film.height(), means: film.means() }
    }
}

/// The values at the two ends of a heat map, whose scale is logarithmic: linear radiance.
pub const HEAT_LIMITS: [f64; 2] = [1e-4, 1.0];

/// From dark to bright; evenly spaced.
const HEAT_COLOURS: [[f64; 3]; 7] = [
    [0.0, 0.0, 4.0],
    [40.0, 11.0, 84.0],
    [101.0, 21.0, 110.0],
    [159.0, 42.0, 99.0],
    [212.0, 72.0, 66.0],
    [245.0, 125.0, 21.0],
    [252.0, 255.0, 164.0],
];

/// The colour of a place on the heat map's scale, `0..=1`.
pub fn heat_colour(place: f64) -> [u8; 3] {
    let last = HEAT_COLOURS.len() - 1;
    let along = place.clamp(0.0, 1.0) * last as f64;
    let from = (along as usize).min(last - 1);
    let share = along - from as f64;
    let channel = |i: usize| HEAT_COLOURS[from][i] * (1.0 - share) + HEAT_COLOURS[from + 1][i] * share;
    [0, 1, 2].map(|i| channel(i).round() as u8)
}

/// Where a value stands on the heat map's scale, `0..=1`.
pub fn heat_place(value: f64) -> f64 {
    let [low, high] = HEAT_LIMITS;
    if value <= low { 0.0 } else { ((value / low).ln() / (high / low).ln()).min(1.0) }
}

/// The standard error of a pixel's mean, linear RGB, as the halves show it; see [`Film::error`].
pub fn standard_error(film: &Film, pixel: usize) -> Option<[f64; 3]> {
    let [half_a, half_b] = film.halves() else { return None };
    let (a, b) = (film.half_sample_count(0) as f64, film.half_sample_count(1) as f64);
    if a == 0.0 || b == 0.0 {
        return None;
    }
    let weight = (a * b).sqrt() / (a + b);
    let (mean_a, mean_b) = (half_a[pixel].radiance(), half_b[pixel].radiance());
    Some([0, 1, 2].map(|i| (mean_a[i] / a - mean_b[i] / b).abs() * weight))
}

impl View {
    /// The film in this view, three bytes a pixel, top row first.
    pub(super) fn resolve(&self, film: &Film, transfer: Transfer) -> Vec<u8> {
        let pixels = 0..film.width() as usize * film.height() as usize;
        match self {
            View::StandardError => pixels
                .flat_map(|pixel| {
                    let error = standard_error(film, pixel).unwrap_or_default();
                    heat_colour(heat_place(root_mean_square(error)))
                })
                .collect(),
            View::Difference(reference)
                if (reference.width, reference.height) == (film.width(), film.height()) =>
            {
                pixels
                    .flat_map(|pixel| {
                        let (mean, other) = (film.mean(pixel), reference.means[pixel]);
                        let difference = [0, 1, 2].map(|i| mean[i] - f64::from(other[i]));
                        heat_colour(heat_place(root_mean_square(difference)))
                    })
                    .collect()
            }
            View::Picture | View::Difference(_) => film.to_rgb8(transfer),
        }
    }
}

fn root_mean_square(v: [f64; 3]) -> f64 {
    (v.iter().map(|x| x * x).sum::<f64>() / 3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PixelSum;

    fn film(a: u64, b: u64) -> Film {
        let mut film = Film::new(1, 1, 2);
        for (half, k) in [a, b].into_iter().enumerate() {
            film.halves_mut()[half][0] = PixelSum([k << 24; 3]);
        }
        film.record(0..2, 0).unwrap();
        film
    }

    #[test]
    fn the_scale_goes_from_dark_to_bright() {
        assert_eq!(heat_colour(heat_place(0.0)), [0, 0, 4]);
        assert_eq!(heat_colour(heat_place(1e9)), [252, 255, 164]);
        let sum = |place| heat_colour(place).iter().map(|x| u32::from(*x)).sum::<u32>();
        assert!((0..20).all(|i| sum(f64::from(i) / 20.0) <= sum(f64::from(i + 1) / 20.0)));
        assert!((heat_place(1e-2) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_error_of_a_pixel_is_that_of_the_film() {
        let film = film(1, 3);
        let error = standard_error(&film, 0).unwrap();
        assert_eq!(error, [1.0; 3]);
        assert!((film.error().unwrap().rmse - 1.0).abs() < 1e-12);
        assert_eq!(standard_error(&Film::new(1, 1, 1), 0), None);
    }

    #[test]
    fn views_show_what_they_say() {
        let film = film(1, 1);
        assert_eq!(View::StandardError.resolve(&film, Transfer::Linear), heat_colour(0.0));
        let same = View::Difference(Arc::new(Reference::of(&film)));
        assert_eq!(same.resolve(&film, Transfer::Linear), heat_colour(0.0));
        let far = Reference { means: vec![[0.0; 3]], ..Reference::of(&film) };
        assert_eq!(View::Difference(Arc::new(far)).resolve(&film, Transfer::Linear), heat_colour(1.0));
        let other_size = Reference { width: 2, height: 1, means: vec![[0.0; 3]; 2] };
        let picture = film.to_rgb8(Transfer::Linear);
        assert_eq!(View::Difference(Arc::new(other_size)).resolve(&film, Transfer::Linear), picture);
        assert_eq!(View::Picture.resolve(&film, Transfer::Linear), picture);
    }
}
