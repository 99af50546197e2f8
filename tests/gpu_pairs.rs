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
use weekender::scene::{Material, Scene};
use weekender::stages::SurfaceRule;

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

/// The CPU with multiply and add rounded apart.
fn unfused() -> CpuRenderer {
    CpuRenderer::new(CpuOptions { isa: Some(Isa::Portable), ..CpuOptions::default() }).unwrap()
}

/// The share of samples that part between two renderers.
fn parted_share(a: &mut dyn Renderer, b: &mut dyn Renderer, job: &RenderJob) -> f64 {
    let mut difference = Difference::default();
    for index in INDICES {
        difference.add(&one(a, job, index), &one(b, job, index));
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
        if job.rules().surface != SurfaceRule::Exact {
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
            // 0 where the CPU has one way of rounding alone.
            let by_rounding = parted_share(&mut unfused(), &mut cpu, &job);
            let from_unfused = parted_share(&mut gpu, &mut unfused(), &job);
            println!(
                "{name:24} parted: from the CPU {share:.1e}, from the CPU unfused {from_unfused:.1e}, the CPU's two {by_rounding:.1e}"
            );
            if share > 2.0 * by_rounding {
                failures.push(name);
            }
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// Pixels across and down a block.
const SIDE: usize = 8;

/// Independent pictures of each side, whose spread tells the deviation of their mean.
const PICTURES: usize = 8;

/// Samples of each picture.
const SAMPLES: u64 = 32;

/// What the largest of all scenes' and stages' blocks stays below in 99 of 100 cases: Student's distribution of 14
/// degrees, 1200 independent blocks.
const LARGEST_BLOCK: f64 = 6.8;

/// Mean radiance of each block and channel.
fn block_means(film: &Film) -> Vec<f64> {
    let means = film.means();
    let [width, height] = [film.width(), film.height()].map(|pixels| pixels as usize);
    let mut blocks = Vec::new();
    for y in (0..height).step_by(SIDE) {
        for x in (0..width).step_by(SIDE) {
            for channel in 0..3 {
                let rows = (y..y + SIDE).map(|y| &means[y * width + x..][..SIDE]);
                let sum: f64 = rows.flatten().map(|pixel| f64::from(pixel[channel])).sum();
                blocks.push(sum / (SIDE * SIDE) as f64);
            }
        }
    }
    blocks
}

/// By block, the mean over the pictures and the variance of that mean.
fn mean_and_variance(pictures: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let count = pictures.len() as f64;
    let of_block = |block: usize| {
        let mean = pictures.iter().map(|picture| picture[block]).sum::<f64>() / count;
        let squares = pictures.iter().map(|picture| (picture[block] - mean).powi(2)).sum::<f64>();
        [mean, squares / (count - 1.0) / count]
    };
    (0..pictures[0].len()).map(of_block).collect()
}

/// The job with independent numbers of another seed.
fn with_seed(job: &RenderJob, seed: u32) -> RenderJob {
    let settings = RenderSettings { seed, sampler: SamplerKind::Independent, ..*job.settings() };
    RenderJob::new(job.scene().clone(), *job.camera(), settings, *job.rules()).unwrap()
}

/// Each block's difference in deviations, of pictures with other numbers on the two sides. With as few pictures
/// as these it has Student's distribution of `2 PICTURES - 2` degrees.
fn block_differences(sides: [(&mut dyn Renderer, &RenderJob); 2]) -> Vec<f64> {
    let mut seed = 100;
    let sides = sides.map(|(renderer, job)| {
        let mut picture = || {
            seed += 1;
            let job = with_seed(job, seed);
            let mut film = job.new_film();
            renderer.accumulate(&job, 0..SAMPLES, &mut film, &AtomicBool::new(false)).unwrap();
            block_means(&film)
        };
        mean_and_variance(&(0..PICTURES).map(|_| picture()).collect::<Vec<_>>())
    });
    let mut z = Vec::new();
    for ([a, variance_a], [b, variance_b]) in sides[0].iter().zip(&sides[1]) {
        // What does not vary has rounding errors alone.
        if (a - b).abs() > 1e-6 {
            z.push((a - b) / (variance_a + variance_b).sqrt());
        }
    }
    z
}

/// Whether two sides show the same picture.
fn blocks_agree(name: &str, sides: [(&mut dyn Renderer, &RenderJob); 2]) -> bool {
    let z = block_differences(sides);
    let degrees = (2 * PICTURES - 2) as f64;
    // Mean and variance of the square of Student's number.
    let mean = degrees / (degrees - 2.0);
    let variance = 2.0 * mean * mean * (degrees - 1.0) / (degrees - 4.0);
    let count = z.len() as f64;
    let square_sum: f64 = z.iter().map(|z| z * z).sum();
    let largest = z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
    // The channels of a block go together, so there are a third as many independent ones.
    let bound = count * mean + 4.0 * (3.0 * variance * count).sqrt();
    println!("{name:24} {count} blocks: squares {square_sum:.1} of {bound:.1}, largest {largest:.2}");
    square_sum <= bound && largest <= LARGEST_BLOCK
}

#[test]
fn blocks_of_other_samples_agree() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let mut unfused = unfused();
    let mut failures = jobs(48, 32);
    // Where rounding itself is seen, as in shadow-acne, the device rounds in one of the CPU's two ways.
    failures.retain(|(name, job)| {
        !blocks_agree(name, [(&mut gpu, job), (&mut cpu, job)])
            && !blocks_agree(name, [(&mut gpu, job), (&mut unfused, job)])
    });
    let names: Vec<_> = failures.into_iter().map(|(name, _)| name).collect();
    assert!(names.is_empty(), "{names:?}");
}

#[test]
fn blocks_of_other_pictures_do_not() {
    let (mut scene, camera) = (BuiltinScene::ALL[0].build)();
    let job = |scene: &Scene| job_of(scene, camera, [48, 32], 20, SamplerKind::Sobol, false);
    let right = job(&scene);
    // A ground that reflects 2 % more.
    let Some(Material::Lambertian { albedo }) = scene.materials.first_mut().map(|m| &mut m.material) else {
        panic!("the ground comes first");
    };
    *albedo *= 1.02;
    assert!(!blocks_agree("a lighter ground", [(&mut cpu(), &right), (&mut cpu(), &job(&scene))]));
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
