//! Compares the GPU with the CPU sample by sample: equal random numbers give equal paths, except for rounding. (Case 13
//! of docs/numerics.md.)
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use gpu_common::{cpu, gpu, job_of, jobs};
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::job::render::{RenderJob, RenderSettings, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer, Isa};
use weekender::render_gpu::GpuOptions;
use weekender::scene::builtin::BuiltinScene;
use weekender::scene::{Material, Scene};
use weekender::stages::SurfaceRule;

/// Samples that differ by more took different paths.
const DIVERGED: f64 = 1e-3;

/// Allowed share of diverging paths. If rounding alone, compared between the CPU's two ways of rounding, diverts more
/// of a scene's paths, twice that share is allowed.
const DIVERGED_SHARE: f64 = 1e-4;

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

/// The CPU with multiply and add rounded separately.
fn unfused() -> CpuRenderer {
    CpuRenderer::new(CpuOptions { isa: Some(Isa::Portable), ..CpuOptions::default() }).unwrap()
}

/// Share of samples that diverge between two renderers.
fn parted_share(a: &mut dyn Renderer, b: &mut dyn Renderer, job: &RenderJob) -> f64 {
    let mut difference = Difference::default();
    for index in INDICES {
        difference.add(&one(a, job, index), &one(b, job, index));
    }
    difference.diverged as f64 / difference.samples as f64
}

const INDICES: [u64; 4] = [0, 5, 50, 499];

#[test]
fn every_job_matches_cpu_by_sample() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let mut failures = Vec::new();
    for (name, job) in jobs(160, 90) {
        if job.rules().surface != SurfaceRule::Exact {
            // These stages show rounding errors on purpose.
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
            // 0 if the CPU has only one way of rounding.
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

/// Side of a block, pixels.
const SIDE: usize = 8;

/// Independent pictures per side; their spread gives the deviation of the mean.
const PICTURES: usize = 8;

/// Samples per pixel of each picture.
const SAMPLES: u64 = 32;

/// Limit that the largest block keeps in 99 of 100 cases, by Student's distribution with 14 degrees of freedom and 1200
/// independent blocks.
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

/// For each block, the mean over the pictures and the variance of that mean.
fn mean_and_variance(pictures: &[Vec<f64>]) -> Vec<[f64; 2]> {
    let count = pictures.len() as f64;
    let of_block = |block: usize| {
        let mean = pictures.iter().map(|picture| picture[block]).sum::<f64>() / count;
        let squares = pictures.iter().map(|picture| (picture[block] - mean).powi(2)).sum::<f64>();
        [mean, squares / (count - 1.0) / count]
    };
    (0..pictures[0].len()).map(of_block).collect()
}

/// The job with independent random numbers and another seed.
fn with_seed(job: &RenderJob, seed: u32) -> RenderJob {
    let settings = RenderSettings { seed, sampler: SamplerKind::Independent, ..*job.settings() };
    RenderJob::new(job.scene().clone(), *job.camera(), settings, *job.rules()).unwrap()
}

/// Each block's difference in deviations. The two sides' pictures have different random numbers. With so few pictures,
/// the differences follow Student's distribution with `2 PICTURES - 2` degrees of freedom.
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
        // Blocks without noise may still differ by rounding.
        if (a - b).abs() > 1e-6 {
            z.push((a - b) / (variance_a + variance_b).sqrt());
        }
    }
    z
}

/// Sum of the blocks' squared differences, its bound for equal pictures, and the largest difference.
fn differences_of_blocks(name: &str, sides: [(&mut dyn Renderer, &RenderJob); 2]) -> [f64; 3] {
    let z = block_differences(sides);
    let degrees = (2 * PICTURES - 2) as f64;
    // Mean and variance of the square of a number with Student's distribution.
    let mean = degrees / (degrees - 2.0);
    let variance = 2.0 * mean * mean * (degrees - 1.0) / (degrees - 4.0);
    let count = z.len() as f64;
    let square_sum: f64 = z.iter().map(|z| z * z).sum();
    let largest = z.iter().fold(0.0_f64, |a, z| a.max(z.abs()));
    // A block's channels are correlated, so only a third of the numbers are independent.
    let bound = count * mean + 4.0 * (3.0 * variance * count).sqrt();
    println!("{name:24} {count} blocks: squares {square_sum:.1} of {bound:.1}, largest {largest:.2}");
    [square_sum, bound, largest]
}

/// Whether two sides show the same picture.
fn blocks_agree(name: &str, sides: [(&mut dyn Renderer, &RenderJob); 2]) -> bool {
    let [square_sum, bound, largest] = differences_of_blocks(name, sides);
    square_sum <= bound && largest <= LARGEST_BLOCK
}

#[test]
fn independent_samples_agree_by_block() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let mut cpu = cpu();
    let mut unfused = unfused();
    let mut failures = jobs(48, 32);
    failures.retain(|(name, job)| {
        let [squares, bound, largest] = differences_of_blocks(name, [(&mut gpu, job), (&mut cpu, job)]);
        if squares <= bound && largest <= LARGEST_BLOCK {
            return false;
        }
        // Stages such as shadow-acne show rounding itself. A device may round in either of the CPU's two ways, or fuse
        // operations of its choice, and then differs from the CPU about as much as those two from each other.
        let [by_rounding, _, largest_by_rounding] =
            differences_of_blocks(name, [(&mut unfused, job), (&mut cpu, job)]);
        job.rules().surface == SurfaceRule::Exact
            || squares > 2.0 * by_rounding.max(bound)
            || largest > 1.5 * largest_by_rounding.max(LARGEST_BLOCK)
    });
    let names: Vec<_> = failures.into_iter().map(|(name, _)| name).collect();
    assert!(names.is_empty(), "{names:?}");
}

#[test]
fn different_pictures_disagree_by_block() {
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
            // Four deviations above the mean of a Poisson distribution.
            let expected = DIVERGED_SHARE * difference.samples as f64;
            assert!(difference.diverged as f64 <= expected + 4.0 * expected.sqrt(), "{difference:?}");
        }
    }
}
