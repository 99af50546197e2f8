//! What the error estimate says where few paths find the light.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use glam::DVec3;
use std::sync::atomic::AtomicBool;
use weekender::film::ErrorEstimate;
use weekender::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::Rules;

const PIXELS: usize = 48 * 27;

/// A white shaft that a ball closes but for its corners, and an eye at its bottom. `ball` is the ball's radius.
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
    let settings = RenderSettings {
        width: 48,
        height: 27,
        max_depth: 50,
        sampler: SamplerKind::Independent,
        seed,
        estimate_error: true,
    };
    RenderJob::new(scene, camera, settings, Rules::default()).unwrap()
}

fn estimates(ball: f64, seeds: u32) -> Vec<ErrorEstimate> {
    let mut renderer = CpuRenderer::new(CpuOptions { threads: Some(2), ..CpuOptions::default() }).unwrap();
    let mut estimate = |seed| {
        let job = cage(ball, seed);
        let mut film = job.new_film();
        renderer.accumulate(&job, 0..16, &mut film, &AtomicBool::new(false)).unwrap();
        film.error().unwrap()
    };
    (0..seeds).map(&mut estimate).collect()
}

/// From nearly closed to wide open: the stated interval of two deviations holds the truth, or the estimate is doubted.
#[test]
fn the_stated_interval_covers_the_truth_or_the_estimate_is_doubted() {
    for ball in [1.4, 1.38, 1.35, 1.3, 1.2, 0.5] {
        let estimates = estimates(ball, 40);
        // Squared errors are unbiased.
        let truth = (estimates.iter().map(|e| e.rmse * e.rmse).sum::<f64>() / estimates.len() as f64).sqrt();
        let ratios: Vec<f64> = estimates.iter().map(|e| e.rmse / truth).collect();
        let covers = |e: &&ErrorEstimate| (e.rmse - truth).abs() <= 2.0 * e.rmse_deviation;
        let doubted = estimates.iter().filter(|e| e.doubt(PIXELS).is_some()).count();
        let covered = estimates.iter().filter(covers).count();
        let either = estimates.iter().filter(|e| covers(e) || e.doubt(PIXELS).is_some()).count();
        let [least, most] =
            [f64::min, f64::max].map(|pick| ratios.iter().copied().reduce(pick).unwrap_or(0.0));
        let mut effect: Vec<f64> = estimates.iter().map(ErrorEstimate::pixels_in_effect).collect();
        effect.sort_by(f64::total_cmp);
        println!(
            "ball {ball}: truth {truth:.4}, estimates {least:.2} to {most:.2} of it, {covered} of 40 cover it, \
             {doubted} are doubted, {:.0} to {:.0} pixels in effect",
            effect[0], effect[39]
        );
        assert!(either >= 36, "ball {ball}: {either} of 40");
        if ball < 1.0 {
            assert_eq!(doubted, 0, "an open shaft");
        } else if most / least > 2.0 {
            assert!(doubted >= 36, "ball {ball}: {doubted} of 40 are doubted");
        }
    }
}
