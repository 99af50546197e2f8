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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{self, Request};

    fn options() -> BenchOptions {
        let line = "weekender bench --scale 1..30 --isa portable --threads 1 --runs 3 --size 8x4 --samples 4";
        match cli::parse(line.split(' ').map(Into::into)).unwrap() {
            Request::Bench(options) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_field_has_its_times_its_bytes_and_its_speed() {
        let options = options();
        let mut progress = Progress::new(options.progress, 3);
        let field = measure(&options, 30, &mut progress, &AtomicBool::new(false)).unwrap().unwrap();
        assert_eq!(progress.done, 3);
        assert_eq!(field.spheres, 30);
        assert!((2..=4).contains(&field.samples_per_pixel));
        assert!(field.generate_seconds > 0.0 && field.build_seconds > 0.0);
        let scene = field.scene_bytes_per_sphere / size_of::<Sphere>() as f64;
        assert!((1.0..4.0).contains(&scene), "{scene} times the bytes of a sphere");
        let tables = field.table_bytes_per_sphere;
        assert!((40.0..1000.0).contains(&tables), "{tables} bytes a sphere");
        let [paths, rays] = [field.paths_per_second, field.rays_per_second].map(Option::unwrap);
        assert!(0.0 < paths.median && paths.median <= rays.median);
    }

    #[test]
    fn a_field_that_is_cancelled_has_no_figures() {
        let options = options();
        let mut progress = Progress::new(options.progress, 3);
        let found = measure(&options, 30, &mut progress, &AtomicBool::new(true)).unwrap();
        assert!(found.is_none() && progress.done == 0);
    }
}
