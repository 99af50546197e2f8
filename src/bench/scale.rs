//! Measures how build time, memory and speed depend on the number of spheres.

use super::candidate::{Cancelled, Candidate};
use super::figures::{Kind, ScaleFigures};
use super::machine::{forget_peak_memory, peak_memory};
use super::progress::Progress;
use crate::cli::BenchOptions;
use crate::prepared::PreparedScene;
use crate::recipe::Recipe;
use crate::render::RenderJob;
use crate::render_cpu::Isa;
use crate::scene::Sphere;
use anyhow::Result;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Measures a field of `count` spheres with the widest packets on all threads. `None` if cancelled.
pub fn measure(
    options: &BenchOptions,
    count: u64,
    progress: &mut Progress,
    cancel: &AtomicBool,
) -> Result<Option<ScaleFigures>> {
    let name = format!("field:{count}");
    progress.begin(&format!("{name}: building"));
    forget_peak_memory();
    let begin = Instant::now();
    let recipe = Recipe::find(&name)?;
    let generate_seconds = begin.elapsed().as_secs_f64();
    let samples = options.samples_of(&recipe);
    let job = options.change(recipe)?;

    let begin = Instant::now();
    let tables = PreparedScene::<f32>::new(&job);
    let build_seconds = begin.elapsed().as_secs_f64();
    let hierarchy_seconds = tables.hierarchy_time.as_secs_f64();
    let spheres = job.scene().spheres.len() as f64;
    let table_bytes_per_sphere = tables.bytes() as f64 / spheres;
    drop(tables);

    let isa = options.levels.last().copied().unwrap_or(Isa::Portable);
    let mut candidate = Candidate::cpu(isa, isa.native_lanes(), options.threads, Kind::Threads, &job);
    progress.begin(&format!("{name}: tracing"));
    if run(options, &mut candidate, &job, samples, progress, cancel).is_err() {
        return Ok(None);
    }
    if let Some(reason) = candidate.row.skipped {
        anyhow::bail!("{name}: {reason}");
    }
    candidate.row.sum_up();
    Ok(Some(ScaleFigures {
        spheres: count,
        generate_seconds,
        build_seconds,
        hierarchy_seconds,
        scene_bytes_per_sphere: (job.scene().spheres.capacity() * size_of::<Sphere>()) as f64 / spheres,
        table_bytes_per_sphere,
        peak_memory_bytes: peak_memory(),
        samples_per_pixel: candidate.row.samples_per_pixel,
        paths_per_second: candidate.row.paths_per_second,
        rays_per_second: candidate.row.rays_per_second,
    }))
}

fn run(
    options: &BenchOptions,
    candidate: &mut Candidate,
    job: &RenderJob,
    samples: u64,
    progress: &mut Progress,
    cancel: &AtomicBool,
) -> Result<(), Cancelled> {
    candidate.warm_up(job, samples, options.run_limit_seconds, cancel)?;
    for _ in 0..options.runs {
        candidate.measure(job, cancel)?;
        progress.step();
    }
    Ok(())
}
