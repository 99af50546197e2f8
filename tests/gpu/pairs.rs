//! Compares the GPU with the CPU sample by sample: equal random numbers give equal paths, except for rounding. (Case 13
//! of docs/numerics.md.)

use crate::common::gpu::{cpu, go_on, gpu, job_of, jobs, picture_mean, rendered};
use weekender::film::Film;
use weekender::job::render::{RenderJob, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::render_gpu::GpuOptions;
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::SurfaceRule;

/// Samples that differ by more took different paths.
const DIVERGED: f64 = 1e-3;

/// Allowed share of diverging paths. If rounding alone, compared between the CPU's two ways of rounding, diverts more
/// of a scene's paths, twice that share is allowed.
const DIVERGED_SHARE: f64 = 1e-4;

const INDICES: [u64; 4] = [0, 5, 50, 499];

/// The difference between the samples of two renderers.
#[derive(Debug, Default)]
struct Difference {
    samples: usize,
    /// Samples that differ by more than [`DIVERGED`].
    diverged: usize,
    sum: f64,
    square_sum: f64,
}

impl Difference {
    fn between(a: &mut dyn Renderer, b: &mut dyn Renderer, job: &RenderJob) -> Difference {
        let mut difference = Difference::default();
        for index in INDICES {
            difference.add(&one(a, job, index), &one(b, job, index));
        }
        difference
    }

    fn add(&mut self, a: &Film, b: &Film) {
        for (a, b) in a.means().iter().zip(b.means()) {
            self.samples += 1;
            let by = [0, 1, 2].map(|i| f64::from(a[i]) - f64::from(b[i]));
            if by.iter().any(|x| x.abs() > DIVERGED) {
                self.diverged += 1;
                continue;
            }
            self.sum += by.iter().sum::<f64>() / 3.0;
            self.square_sum += by.iter().map(|x| x * x).sum::<f64>() / 3.0;
        }
    }

    fn is_by_rounding(&self) -> bool {
        let samples = self.samples as f64;
        (self.sum / samples).abs() < 2e-6 && (self.square_sum / samples).sqrt() < 5e-5
    }

    fn diverged_share(&self) -> f64 {
        self.diverged as f64 / self.samples as f64
    }
}

fn one(renderer: &mut dyn Renderer, job: &RenderJob, index: u64) -> Film {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, index..index + 1, &mut film, &go_on()).unwrap();
    assert_eq!(stats.rejected, 0);
    film
}

/// The CPU with multiply and add rounded separately.
fn unfused() -> CpuRenderer {
    CpuRenderer::new(CpuOptions { isa: Some(Isa::Portable), ..CpuOptions::default() }).unwrap()
}

/// All stages and scenes, and three spheres under both samplers.
#[test]
fn every_job_matches_cpu_by_sample() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let (mut cpu, mut failures) = (cpu(), Vec::new());
    let mut pairs = jobs(160, 90);
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    for sampler in SamplerKind::ALL {
        pairs.push((format!("{sampler:?}"), job_of(&scene, camera, [97, 61], 24, sampler)));
    }
    // The other stages show rounding errors on purpose.
    pairs.retain(|(_, job)| job.rules().surface == SurfaceRule::Exact);
    for (name, job) in pairs {
        let difference = Difference::between(&mut gpu, &mut cpu, &job);
        println!("{name}: {difference:?}");
        let share = difference.diverged_share();
        // 0 if the CPU has only one way of rounding.
        let mut by_rounding = || Difference::between(&mut unfused(), &mut cpu, &job).diverged_share();
        if !difference.is_by_rounding() || share > DIVERGED_SHARE && share > 2.0 * by_rounding() {
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
        let of = |renderer: &mut dyn Renderer| picture_mean(&rendered(renderer, &job, 64));
        let [on_gpu, on_cpu, other] = [of(&mut gpu), of(&mut cpu()), of(&mut unfused())];
        let allowed = 0.01 + 2.0 * (on_cpu - other).abs();
        assert!((on_gpu - on_cpu).abs() < allowed, "{name}: {on_gpu}, but {on_cpu} and {other} on the CPU");
    }
}
