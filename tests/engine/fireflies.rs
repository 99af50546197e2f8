//! Error estimates of scenes in which few paths find the light.

use crate::common::noisy_scenes::cage;
use std::sync::atomic::AtomicBool;
use weekender::film::ErrorEstimate;
use weekender::job::render::{Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};

/// The error estimates of several films, and whether each is marked as doubtful or left out.
fn estimates(ball: f64, seeds: u32) -> Vec<(ErrorEstimate, bool)> {
    let mut renderer = CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).unwrap();
    let mut estimate = |seed| {
        let mut recipe = cage(ball);
        (recipe.settings.sampler, recipe.settings.seed) = (SamplerKind::Independent, seed);
        let job = recipe.job().unwrap();
        let mut film = job.new_film();
        renderer.accumulate(&job, 0..16, &mut film, &AtomicBool::new(false)).unwrap();
        match film.error() {
            Some(estimate) => (estimate, film.doubt(&estimate).is_some()),
            // No path has found light: nothing is stated.
            None => (ErrorEstimate { rmse: 0.0, rmse_deviation: 0.0, rel_mse: 0.0 }, true),
        }
    };
    (0..seeds).map(&mut estimate).collect()
}

/// From nearly closed to wide open: the stated interval of two deviations contains the true error, or the estimate is
/// marked as doubtful.
#[test]
fn interval_covers_the_truth_or_is_doubted() {
    for ball in [1.4, 1.38, 1.35, 1.3, 1.2, 0.5] {
        let estimates = estimates(ball, 40);
        // Squared errors are unbiased.
        let square: f64 = estimates.iter().map(|(e, _)| e.rmse * e.rmse).sum();
        let truth = (square / estimates.len() as f64).sqrt();
        let covers = |e: &ErrorEstimate| (e.rmse - truth).abs() <= 2.0 * e.rmse_deviation;
        let doubted = estimates.iter().filter(|(_, is_doubted)| *is_doubted).count();
        let either = estimates.iter().filter(|(e, is_doubted)| covers(e) || *is_doubted).count();
        let ratios: Vec<f64> = estimates.iter().map(|(e, _)| e.rmse / truth).collect();
        let [least, most] =
            [f64::min, f64::max].map(|pick| ratios.iter().copied().reduce(pick).unwrap_or(0.0));
        assert!(either >= 36, "ball {ball}: {either} of 40");
        if most > 2.0 * least {
            assert_eq!(doubted, 40, "ball {ball}");
        } else if most < 1.2 * least {
            assert_eq!(doubted, 0, "ball {ball}");
        }
    }
}
