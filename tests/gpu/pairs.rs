//! Compares the GPU with the CPU sample by sample: equal random numbers give equal paths, except for rounding. (Case 13
//! of docs/numerics.md.)

use crate::common::films::{mean, paired, rendered};
use crate::common::gpu::{cpu, gpu, job_of, jobs};
use glam::DVec3;
use weekender::job::render::{Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::render_gpu::GpuOptions;
use weekender::scene::builtin::BuiltinScene;
use weekender::scene::{Camera, Material, Scene};
use weekender::stages::SurfaceRule;

/// Allowed share of diverging paths. If rounding alone, compared between the CPU's two ways of rounding, diverts more
/// of a scene's paths, twice that share is allowed.
const DIVERGED_SHARE: f64 = 1e-4;

const INDICES: [u64; 4] = [0, 5, 50, 499];

/// The CPU with multiply and add rounded separately.
fn unfused() -> CpuRenderer {
    CpuRenderer::new(CpuOptions { isa: Some(Isa::Portable), ..CpuOptions::default() }).unwrap()
}

/// Balls of which only the fuzz uses the random direction.
fn metals(fuzz: f64) -> Scene {
    let mut scene = Scene::default();
    let metal = scene.add_material("metal", Material::Metal { albedo: DVec3::new(0.9, 0.7, 0.5), fuzz });
    [-1.0, 0.0, 1.0].into_iter().for_each(|x| scene.add_sphere(DVec3::new(x, 0.0, -1.0), 0.5, metal));
    scene
}

/// All stages and scenes, lone metals, and three spheres under both samplers.
#[test]
fn every_job_matches_cpu_by_sample() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let (mut cpu, mut failures) = (cpu(), Vec::new());
    let mut pairs = jobs(160, 90);
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    for sampler in SamplerKind::ALL {
        pairs.push((format!("{sampler:?}"), job_of(&scene, camera, [97, 61], 24, sampler)));
    }
    for fuzz in [0.4, 1.0] {
        let job = job_of(&metals(fuzz), Camera::default(), [160, 90], 20, SamplerKind::Sobol);
        pairs.push((format!("fuzz {fuzz}"), job));
    }
    // The other stages show rounding errors on purpose.
    pairs.retain(|(_, job)| job.rules().surface == SurfaceRule::Exact);
    for (name, job) in pairs {
        let found = paired(&job, &INDICES, &mut gpu, &mut cpu);
        println!("{name}: {found:?}");
        let is_by_rounding = found.inlier_bias.abs() < 2e-6 && found.inlier_rms < 5e-5;
        // 0 if the CPU has only one way of rounding.
        let mut by_rounding = || paired(&job, &INDICES, &mut unfused(), &mut cpu).outliers;
        if !is_by_rounding || found.outliers > DIVERGED_SHARE && found.outliers > 2.0 * by_rounding() {
            failures.push(name);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// How much rounding shows depends on the device, but the picture is the same.
#[test]
fn rounding_stages_are_equally_bright() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    for (name, job) in jobs(48, 32).into_iter().filter(|(_, job)| job.rules().surface != SurfaceRule::Exact) {
        let of = |renderer: &mut dyn Renderer| mean(&rendered(renderer, &job, 64));
        let [on_gpu, on_cpu, other] = [of(&mut gpu), of(&mut cpu()), of(&mut unfused())];
        let allowed = 0.01 + 2.0 * (on_cpu - other).abs();
        assert!((on_gpu - on_cpu).abs() < allowed, "{name}: {on_gpu}, but {on_cpu} and {other} on the CPU");
    }
}
