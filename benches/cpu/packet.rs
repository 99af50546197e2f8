//! The path loop: a tile from the camera to the film, on one thread.

use crate::widths::widths;
use divan::Bencher;
use divan::counter::ItemsCount;
use std::sync::atomic::AtomicBool;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderJob, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};

/// Side of the picture, pixels: a tile.
const SIDE: u32 = 64;

const SAMPLES: u64 = 16;

pub fn job(scene: &str, sampler: SamplerKind) -> RenderJob {
    let mut recipe = Recipe::find(scene).expect("built in");
    (recipe.settings.width, recipe.settings.height) = (SIDE, SIDE);
    recipe.settings.sampler = sampler;
    recipe.job().expect("valid")
}

/// Measures a renderer with these options.
pub fn trace(bencher: Bencher, options: CpuOptions, job: &RenderJob) {
    let mut renderer = CpuRenderer::new(options).expect("a lane count of this processor");
    let cancel = AtomicBool::new(false);
    renderer.prepare(job, &cancel).expect("a kernel");
    bencher
        .counter(ItemsCount::new(u64::from(SIDE * SIDE) * SAMPLES))
        .with_inputs(|| job.new_film())
        .bench_local_refs(|film| renderer.accumulate(job, 0..SAMPLES, film, &cancel).expect("traced"));
}

fn at_width(bencher: Bencher, lanes: usize, scene: &str, sampler: SamplerKind) {
    let options = CpuOptions { lanes: Some(lanes), threads: Some(1), ..CpuOptions::default() };
    trace(bencher, options, &job(scene, sampler));
}

#[divan::bench(args = widths(), sample_count = 10)]
fn three_spheres_sobol(bencher: Bencher, lanes: usize) {
    at_width(bencher, lanes, "three-spheres", SamplerKind::Sobol);
}

#[divan::bench(args = widths(), sample_count = 10)]
fn three_spheres_independent(bencher: Bencher, lanes: usize) {
    at_width(bencher, lanes, "three-spheres", SamplerKind::Independent);
}

#[divan::bench(args = widths(), sample_count = 10)]
fn book_sobol(bencher: Bencher, lanes: usize) {
    at_width(bencher, lanes, "book", SamplerKind::Sobol);
}
