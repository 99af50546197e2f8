//! The noise of two films' difference, estimated from their halves.

use crate::film::Film;

/// A film with samples in both halves.
struct Halves<'a> {
    film: &'a Film,
    /// One over each half's number of samples.
    scale: [f64; 2],
}

impl<'a> Halves<'a> {
    fn of(film: &'a Film) -> Option<Self> {
        let counts =
            [0, 1].map(|half| if half < film.halves().len() { film.half_sample_count(half) } else { 0 });
        let scale = counts.map(|count| 1.0 / count as f64);
        counts.iter().all(|count| *count > 0).then_some(Halves { film, scale })
    }

    /// Half the difference of the halves' means. Its square estimates the variance of their mean.
    fn deviation(&self, pixel: usize) -> [f64; 3] {
        let mean = |half: usize| self.film.halves()[half][pixel].radiance().map(|sum| sum * self.scale[half]);
        let (a, b) = (mean(0), mean(1));
        [0, 1, 2].map(|channel| 0.5 * (a[channel] - b[channel]))
    }
}

/// Variances and deviations of the difference of two films.
pub(super) struct Variances {
    /// Variance of each pixel's difference. Noise that the films share cancels.
    pub of_difference: Vec<[f64; 3]>,
    /// Root mean square noise of both films, as if they shared none.
    pub of_both: f64,
    /// Standard deviation of the mean difference over all pixels and channels.
    pub of_mean: f64,
    /// What two samples of radiance 1, one in each half, add to a pixel.
    pub rare: f64,
}

impl Variances {
    /// `None` unless both films have samples in two halves.
    pub(super) fn of(a: &Film, b: &Film) -> Option<Self> {
        let (a, b) = (Halves::of(a)?, Halves::of(b)?);
        let count = a.film.width() as usize * a.film.height() as usize;
        let (mut both, mut of_mean) = (0.0, 0.0);
        let of_difference = (0..count)
            .map(|pixel| {
                let (a, b) = (a.deviation(pixel), b.deviation(pixel));
                both += a.iter().chain(&b).map(|x| x * x).sum::<f64>();
                let deviation = [0, 1, 2].map(|channel| b[channel] - a[channel]);
                // Channels of a pixel share their noise.
                of_mean += (deviation.iter().sum::<f64>() / 3.0).powi(2);
                deviation.map(|x| x * x)
            })
            .collect();
        // Both halves may hold the same rare path, which their difference then does not show.
        let pair = |film: &Film| std::f64::consts::SQRT_2 / film.sample_count() as f64;
        let rare = pair(a.film).hypot(pair(b.film));
        Some(Variances {
            of_difference,
            of_mean: of_mean.sqrt().hypot(rare) / count as f64,
            of_both: (both / (3 * count) as f64).sqrt(),
            rare,
        })
    }
}
