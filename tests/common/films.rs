//! Renders films and compares them.

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::job::render::{RenderJob, Renderer, Stats};

/// A film of samples `range`, none of them rejected.
pub fn render_with_stats(renderer: &mut dyn Renderer, job: &RenderJob, range: Range<u64>) -> (Film, Stats) {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, range.clone(), &mut film, &AtomicBool::new(false)).unwrap();
    assert_eq!(stats.rejected, 0, "samples were rejected");
    assert_eq!(film.sample_count(), range.end - range.start);
    (film, stats)
}

pub fn render(renderer: &mut dyn Renderer, job: &RenderJob, range: Range<u64>) -> Film {
    render_with_stats(renderer, job, range).0
}

/// A film of this many samples.
pub fn rendered(renderer: &mut dyn Renderer, job: &RenderJob, samples: u64) -> Film {
    render(renderer, job, 0..samples)
}

fn pixels(film: &Film) -> usize {
    film.width() as usize * film.height() as usize
}

/// The mean of all pixels and channels.
pub fn mean(film: &Film) -> f64 {
    (0..pixels(film)).flat_map(|pixel| film.mean(pixel)).sum::<f64>() / (3 * pixels(film)) as f64
}

/// Number of pixels with a channel in which two films differ by more than `by`.
pub fn parted(a: &Film, b: &Film, by: f64) -> usize {
    let apart = |pixel: &usize| (0..3).any(|c| (a.mean(*pixel)[c] - b.mean(*pixel)[c]).abs() > by);
    (0..pixels(a)).filter(apart).count()
}

/// Mean squared error by a reference with independent samples, whose own noise is subtracted.
pub fn squared_error(film: &Film, reference: &Film) -> f64 {
    let of_pixel = |pixel| {
        let (mean, truth) = (film.mean(pixel), reference.mean(pixel));
        (0..3).map(|c| (mean[c] - truth[c]).powi(2)).sum::<f64>()
    };
    let sum = (0..pixels(film)).map(of_pixel).sum::<f64>();
    sum / (3 * pixels(film)) as f64 - reference.error().unwrap().rmse.powi(2)
}

/// How two renderers differ on the same samples.
#[derive(Debug, Default)]
pub struct Paired {
    pub bias: f64,
    /// Share of samples with a channel off by more than 1e-3: they took different paths.
    pub outliers: f64,
    /// Mean and root mean square of the other samples.
    pub inlier_bias: f64,
    pub inlier_rms: f64,
}

/// Renders single samples with both and compares them pixel by pixel.
pub fn paired(job: &RenderJob, indices: &[u64], a: &mut dyn Renderer, b: &mut dyn Renderer) -> Paired {
    let mut found = Paired::default();
    let paths = (indices.len() * pixels(&job.new_film())) as f64;
    for index in indices {
        let (a, b) = (render(a, job, *index..index + 1), render(b, job, *index..index + 1));
        for pixel in 0..pixels(&a) {
            let difference = [0, 1, 2].map(|channel| a.mean(pixel)[channel] - b.mean(pixel)[channel]);
            let bias = difference.iter().sum::<f64>() / (3.0 * paths);
            found.bias += bias;
            if difference.iter().any(|x| x.abs() > 1e-3) {
                found.outliers += 1.0 / paths;
            } else {
                found.inlier_bias += bias;
                found.inlier_rms += difference.iter().map(|x| x * x).sum::<f64>() / (3.0 * paths);
            }
        }
    }
    Paired { inlier_rms: found.inlier_rms.sqrt(), ..found }
}
