//! Error estimates of scenes in which few paths find the light.

use glam::DVec3;
use std::sync::atomic::AtomicBool;
use weekender::film::ErrorEstimate;
use weekender::job::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::Rules;

/// A white shaft that a ball of this radius closes except for its corners, with the eye at the bottom.
fn cage(ball: f64, seed: u32) -> RenderJob {
    let mut scene =
        Scene { sky: Sky { bottom: DVec3::splat(50.0), top: DVec3::splat(50.0) }, ..Scene::default() };
    let white = scene.add_material("white", Material::Lambertian { albedo: DVec3::splat(0.98) });
    for wall in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z, DVec3::NEG_Y] {
        scene.add_sphere(wall * 101.0, 100.0, white);
    }
    scene.add_sphere(DVec3::new(0.0, 1.6, 0.0), ball, white);
    let camera = Camera {
        look_from: DVec3::new(0.0, -0.5, 0.8),
        look_at: DVec3::new(0.0, -0.6, 0.0),
        ..Camera::default()
    };
    let settings =
        RenderSettings { width: 48, height: 27, max_depth: 50, sampler: SamplerKind::Independent, seed };
    RenderJob::new(scene, camera, settings, Rules::default()).unwrap()
}

/// The error estimates of several films, and whether each is marked as doubtful or left out.
fn estimates(ball: f64, seeds: u32) -> Vec<(ErrorEstimate, bool)> {
    let mut renderer = CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).unwrap();
    let mut estimate = |seed| {
        let job = cage(ball, seed);
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
