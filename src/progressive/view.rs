//! What to show of a film: the picture itself, or a heat map of one of its properties.

use crate::denoise::Denoised;
use crate::film::Film;
use crate::numbers::heat::HeatScale;
use crate::stages::Transfer;
use std::sync::Arc;

/// What a [`super::Picture`] shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum View {
    /// The picture with the job's transfer.
    #[default]
    Picture,
    /// The picture with radiance multiplied by two to the power of this many stops.
    Exposed(f64),
    /// Luminance as a heat map from one power of two to another.
    Luminance([f64; 2]),
    /// The standard error of each pixel's mean, estimated from the halves.
    StandardError,
    /// The difference of each pixel from a reference. A film of another size is shown as a picture.
    Difference(Arc<ReferenceMeans>),
    /// The denoised picture in another view, in which [`View::StandardError`] is the error of the denoised picture. Another
    /// film is shown as it is.
    Denoised(Arc<Denoised>, Box<View>),
}

/// A picture to compare with, linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceMeans {
    pub width: u32,
    pub height: u32,
    /// Linear RGB, row by row from the top.
    pub means: Vec<[f32; 3]>,
}

impl ReferenceMeans {
    /// A reference with the film's current means.
    pub fn of(film: &Film) -> Self {
        ReferenceMeans { width: film.width(), height: film.height(), means: film.means() }
    }
}

/// The standard error of a pixel's mean, linear RGB, estimated from the halves, assuming that their variances are
/// inversely proportional to their numbers of samples. [`Film::error`] measures how far that holds; the two are equal
/// after even numbers of samples.
fn standard_error(film: &Film, pixel: usize) -> Option<[f64; 3]> {
    let [half_a, half_b] = film.halves() else { return None };
    let (a, b) = (film.half_sample_count(0) as f64, film.half_sample_count(1) as f64);
    if a == 0.0 || b == 0.0 {
        return None;
    }
    let weight = (a * b).sqrt() / (a + b);
    let (mean_a, mean_b) = (half_a[pixel].radiance(), half_b[pixel].radiance());
    Some([0, 1, 2].map(|i| (mean_a[i] / a - mean_b[i] / b).abs() * weight))
}

/// The standard error of each pixel. Its square is a mean over neighbours: two halves of one pixel agree by accident.
fn standard_errors(film: &Film) -> Vec<f64> {
    const REACH: usize = 2;
    let (width, height) = (film.width() as usize, film.height() as usize);
    let square = |pixel| root_mean_square(standard_error(film, pixel).unwrap_or_default()).powi(2);
    let squares: Vec<f64> = (0..width * height).map(square).collect();
    let around = |at: usize, side: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(side);
    let mean = |pixel: usize| {
        let (columns, rows) = (around(pixel % width, width), around(pixel / width, height));
        let count = columns.len() * rows.len();
        let row = |y: usize| squares[y * width..][columns.clone()].iter();
        (rows.flat_map(row).sum::<f64>() / count as f64).sqrt()
    };
    (0..squares.len()).map(mean).collect()
}

impl View {
    /// Whether `other` shows the same. References are compared by their addresses.
    pub fn is_same(&self, other: &View) -> bool {
        match (self, other) {
            (View::Difference(mine), View::Difference(theirs)) => Arc::ptr_eq(mine, theirs),
            (View::Denoised(mine, view), View::Denoised(theirs, other)) => {
                Arc::ptr_eq(mine, theirs) && view.is_same(other)
            }
            (mine, theirs) => mine == theirs,
        }
    }

    /// Resolves the film in this view: three bytes per pixel, top row first.
    pub fn resolve(&self, film: &Film, transfer: Transfer) -> Vec<u8> {
        let heat = |scale: HeatScale, value: &dyn Fn(usize) -> f64| -> Vec<u8> {
            let pixels = film.width() as usize * film.height() as usize;
            (0..pixels).flat_map(|pixel| scale.colour(value(pixel))).collect()
        };
        match self {
            View::StandardError => {
                let errors = standard_errors(film);
                heat(HeatScale::ERROR, &|pixel| errors[pixel])
            }
            View::Difference(reference)
                if (reference.width, reference.height) == (film.width(), film.height()) =>
            {
                heat(HeatScale::DIFFERENCE, &|pixel| {
                    let (mean, other) = (film.mean(pixel), reference.means[pixel]);
                    root_mean_square([0, 1, 2].map(|i| mean[i] - f64::from(other[i])))
                })
            }
            View::Luminance(stops) => {
                heat(HeatScale::luminance(*stops), &|pixel| luminance(film.mean(pixel)))
            }
            View::Exposed(stops) => film.exposed(transfer, *stops),
            View::Picture | View::Difference(_) => film.to_rgb8(transfer),
            View::Denoised(denoised, view) if !denoised.is_of(film) => view.resolve(film, transfer),
            View::Denoised(denoised, view) if **view == View::StandardError => {
                heat(HeatScale::ERROR, &|pixel| f64::from(denoised.errors[pixel]))
            }
            View::Denoised(denoised, view) => view.resolve(&denoised.film, transfer),
        }
    }
}

/// The luminance of a linear RGB colour, by Rec. 709.
fn luminance([red, green, blue]: [f64; 3]) -> f64 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn root_mean_square(v: [f64; 3]) -> f64 {
    (v.iter().map(|x| x * x).sum::<f64>() / 3.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PixelSum;

    fn film(a: u64, b: u64) -> Film {
        let mut film = Film::new(1, 1);
        for (half, k) in [a, b].into_iter().enumerate() {
            film.halves_mut()[half][0] = PixelSum([k << 24; 3]);
        }
        film.record(0..2, 0).unwrap();
        film
    }

    #[test]
    fn halves_are_weighted_by_their_counts() {
        // Two samples of 3 in one half, one of 0 in the other: (3 - 0)^2 2 1 / 3^2.
        let mut film = Film::new(1, 1);
        film.halves_mut()[0][0] = PixelSum([6 << 24; 3]);
        film.record(0..3, 0).unwrap();
        let error = standard_error(&film, 0).unwrap();
        assert!(error.iter().all(|x| (x - 2.0_f64.sqrt()).abs() < 1e-12), "{error:?}");
        film.halves_mut()[1][0] = PixelSum([1 << 24; 3]);
        film.record(3..4, 0).unwrap();
        let error = standard_error(&film, 0).unwrap();
        assert!((film.error().unwrap().rmse - error[0]).abs() < 1e-12);
        assert_eq!(standard_error(&Film::new(1, 1), 0), None);
    }

    #[test]
    fn halves_that_agree_by_accident_are_not_certain() {
        let mut film = Film::new(3, 1);
        for (half, k) in [1, 3].into_iter().enumerate() {
            film.halves_mut()[half] = [k, 2, k].map(|k| PixelSum([k << 24; 3])).to_vec();
        }
        film.record(0..2, 0).unwrap();
        let errors = standard_errors(&film);
        assert!(standard_error(&film, 1) == Some([0.0; 3]) && errors[1] > 0.5, "{errors:?}");
    }

    #[test]
    fn a_known_error_has_its_colour() {
        // 0.01 is in the middle of a scale of four decades, which has the fourth of seven colours.
        let middle = [159, 42, 99];
        let film = film(1, 1);
        let off = |by: [f32; 3]| {
            let means = vec![by.map(|x| 1.0 + x)];
            let view = View::Difference(Arc::new(ReferenceMeans { means, ..ReferenceMeans::of(&film) }));
            view.resolve(&film, Transfer::Linear)
        };
        assert_eq!(off([0.01, -0.01, 0.01]), middle);
        // All of the difference in one channel: the root mean square is the same.
        assert_eq!(off([0.0, 0.01 * 3.0_f32.sqrt(), 0.0]), middle);
        let mut noisy = Film::new(1, 1);
        for (half, k) in [98, 100].into_iter().enumerate() {
            noisy.halves_mut()[half][0] = PixelSum([(k << 24) / 100; 3]);
        }
        noisy.record(0..2, 0).unwrap();
        assert_eq!(View::StandardError.resolve(&noisy, Transfer::Linear), middle);
    }

    #[test]
    fn views_show_what_they_say() {
        let film = film(1, 1);
        let shown = |view: View| view.resolve(&film, Transfer::Linear);
        assert_eq!(shown(View::StandardError), HeatScale::ERROR.colour(0.0));
        let same = View::Difference(Arc::new(ReferenceMeans::of(&film)));
        assert_eq!(shown(same), HeatScale::ERROR.colour(0.0));
        let far = ReferenceMeans { means: vec![[0.0; 3]], ..ReferenceMeans::of(&film) };
        assert_eq!(shown(View::Difference(Arc::new(far))), HeatScale::ERROR.colour(1.0));
        let other_size = ReferenceMeans { width: 2, means: vec![[0.0; 3]; 2], ..ReferenceMeans::of(&film) };
        let picture = film.to_rgb8(Transfer::Linear);
        assert_eq!(shown(View::Difference(Arc::new(other_size))), picture);
        assert_eq!(shown(View::Picture), picture);
    }

    #[test]
    fn brightness_is_shown_in_stops() {
        let mut film = Film::new(1, 1);
        // Luminance: 0.7152 / 4 + 0.0722 / 4 + 0.2126 / 4 = 1/4, the middle of the scale.
        film.halves_mut()[0][0] = PixelSum([1 << 22; 3]);
        film.record(0..1, 0).unwrap();
        let shown = |view: View| view.resolve(&film, Transfer::Linear);
        assert_eq!(shown(View::Luminance([-8.0, 4.0])), [159, 42, 99]);
        assert_eq!([shown(View::Exposed(1.0)), shown(View::Exposed(-1.0))], [[128; 3], [32; 3]]);
        let primaries = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(primaries.map(luminance), [0.2126, 0.7152, 0.0722]);
    }
}
