//! The GPU against the CPU, sample by sample: the same counters, so the same paths but for rounding.
//! (Case 13 of docs/numerics.md.)
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use gpu_common::{cpu, gpu, job_of, jobs};
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::render_gpu::GpuOptions;
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::{Rules, Surface};

/// Beyond this a pair of samples has taken different ways.
const DIVERGED: f64 = 1e-3;

/// Rounding alone makes some paths part: where a scene parts more of them than this share between the CPU's own
/// two ways of rounding, twice that share is allowed.
const DIVERGED_SHARE: f64 = 1e-4;

/// How two renderers' samples differ.
#[derive(Debug, Default)]
struct Difference {
    samples: usize,
    /// Samples with a difference above [`DIVERGED`].
    diverged: usize,
    sum: f64,
    square_sum: f64,
}

impl Difference {
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

    fn mean(&self) -> f64 {
        self.sum / self.samples as f64
    }

    fn rms(&self) -> f64 {
        (self.square_sum / self.samples as f64).sqrt()
    }
}

fn one(renderer: &mut dyn Renderer, job: &RenderJob, index: u64) -> Film {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, index..index + 1, &mut film, &AtomicBool::new(false)).unwrap();
    assert_eq!(stats.rejected, 0);
    film
}

/// The share of samples that part between fused and unfused arithmetic on the CPU; 0 where there is one alone.
fn share_by_rounding(job: &RenderJob) -> f64 {
    let mut unfused =
        CpuRenderer::new(CpuOptions { isa: Some(Isa::Baseline), ..CpuOptions::default() }).unwrap();
    let mut fused = cpu();
    let mut difference = Difference::default();
    for index in INDICES {
        difference.add(&one(&mut unfused, job, index), &one(&mut fused, job, index));
    }
    difference.diverged as f64 / difference.samples as f64
}

const INDICES: [u64; 4] = [0, 5, 50, 499];

#[test]
fn every_stage_and_scene_is_the_cpus_sample_by_sample() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let mut failures = Vec::new();
    for (name, job) in jobs(160, 90) {
        if job.rules().surface == Surface::Acne {
            // What is seen there is rounding itself.
            continue;
        }
        let mut difference = Difference::default();
        let mut rays = [0, 0];
        for index in INDICES {
            let (mut on_gpu, mut on_cpu) = (job.new_film(), job.new_film());
            let go_on = AtomicBool::new(false);
            rays[0] += gpu.accumulate(&job, index..index + 1, &mut on_gpu, &go_on).unwrap().rays;
            rays[1] += cpu.accumulate(&job, index..index + 1, &mut on_cpu, &go_on).unwrap().rays;
            difference.add(&on_gpu, &on_cpu);
        }
        let share = difference.diverged as f64 / difference.samples as f64;
        println!(
            "{name:24} mean {:+.1e} rms {:.1e} diverged {} of {} rays {rays:?} compiled in {:.1?}: {}",
            difference.mean(),
            difference.rms(),
            difference.diverged,
            difference.samples,
            gpu.report().compile_time,
            gpu.report().features,
        );
        if difference.mean().abs() > 2e-6 || difference.rms() > 5e-5 {
            failures.push(name);
        } else if share > DIVERGED_SHARE {
            let by_rounding = share_by_rounding(&job);
            println!("{name:24} diverged {share:.1e}, between the CPU's own roundings {by_rounding:.1e}");
            if share > 2.0 * by_rounding {
                failures.push(name);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn blocks_of_other_samples_agree() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    // Other seeds on the two sides, so that nothing is shared but what the picture tends to; the two halves of
    // each film tell its variance.
    let (width, height) = (96, 56);
    let side = 8;
    let mut z = Vec::new();
    let film_of = |renderer: &mut dyn Renderer, seed| {
        let settings = RenderSettings {
            width,
            height,
            max_depth: 24,
            sampler: SamplerKind::Independent,
            seed,
            estimate_error: true,
        };
        let job = RenderJob::new(scene.clone(), camera, settings, Rules::default()).unwrap();
        let mut film = job.new_film();
        renderer.accumulate(&job, 0..128, &mut film, &AtomicBool::new(false)).unwrap();
        film
    };
    let films = [film_of(&mut gpu, 1), film_of(&mut cpu, 2)];
    for block_y in 0..height / side {
        for block_x in 0..width / side {
            let [mut difference, mut variance] = [0.0, 0.0];
            for y in 0..side {
                for x in 0..side {
                    let index = ((block_y * side + y) * width + block_x * side + x) as usize;
                    let green = |film: &Film| film.mean(index)[1];
                    let half = |film: &Film, half: usize| {
                        film.halves()[half][index].radiance()[1] / film.half_sample_count(half) as f64
                    };
                    difference += green(&films[0]) - green(&films[1]);
                    variance +=
                        films.iter().map(|film| (half(film, 0) - half(film, 1)).powi(2) / 4.0).sum::<f64>();
                }
            }
            if variance > 0.0 {
                z.push(difference / variance.sqrt());
            }
        }
    }
    let count = z.len() as f64;
    let square_sum: f64 = z.iter().map(|z| z * z).sum();
    let largest = z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
    println!("sum of squares {square_sum:.1} of {count} blocks, largest {largest:.2}");
    // The variance of a block is itself an estimate from 64 pixels, which widens the tails by some 1/32.
    assert!((square_sum - count * (1.0 + 1.0 / 31.0)).abs() < 4.0 * (2.0 * count).sqrt());
    assert!(largest < 5.0);
}

#[test]
fn both_samplers_and_two_halves_are_paired() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    for sampler in SamplerKind::ALL {
        for estimate_error in [false, true] {
            let job = job_of(&scene, camera, [97, 61], 24, sampler, estimate_error);
            let mut difference = Difference::default();
            for index in [1, 2, 1000] {
                difference.add(&one(&mut gpu, &job, index), &one(&mut cpu, &job, index));
            }
            assert!(difference.mean().abs() < 2e-6 && difference.rms() < 5e-5, "{difference:?}");
            assert!(difference.diverged <= 3, "{difference:?}");
        }
    }
}
