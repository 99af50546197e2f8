//! Measures how build time, memory and speed depend on the number of spheres.

use super::super::machine::{forget_peak_memory, peak_memory};
use super::figures::{Kind, ScaleFigures};
use super::{Bench, cpu};
use crate::job::recipe::Recipe;
use crate::prepared::PreparedScene;
use crate::scene::Sphere;
use anyhow::{Result, bail};
use std::time::Instant;

impl Bench<'_> {
    /// Measures fields of these sizes with the widest packets on all threads.
    pub(super) fn fields(&mut self, counts: &[u64]) -> Result<()> {
        self.expect_runs(counts.len() * (1 + self.options.runs));
        for count in counts {
            let field = self.field(*count)?;
            if self.is_cancelled() {
                break;
            }
            self.figures.scale.push(field);
        }
        Ok(())
    }

    fn field(&mut self, count: u64) -> Result<ScaleFigures> {
        let name = format!("field:{count}");
        self.progress.at(&format!("{name}: building"), 0.0);
        forget_peak_memory();
        let begin = Instant::now();
        let recipe = Recipe::find(&name)?;
        let generate_seconds = begin.elapsed().as_secs_f64();
        let scene = self.options.scene_of(recipe, false)?;
        let job = &scene.job;

        let begin = Instant::now();
        let tables = PreparedScene::<f32>::new(job);
        let build_seconds = begin.elapsed().as_secs_f64();
        let hierarchy_seconds = tables.hierarchy_time.as_secs_f64();
        let spheres = &job.scene().spheres;
        let table_bytes_per_sphere = tables.bytes() as f64 / spheres.len() as f64;
        drop(tables);

        let isa = self.best_level();
        let mut candidates = [(Kind::Threads, cpu(isa, isa.native_lanes(), self.options.threads()))];
        let rows = self.rows(&name, job, scene.samples, &mut candidates);
        let Some(row) = rows.into_iter().next() else { bail!("{name} has no row") };
        if let Some(reason) = row.skipped {
            bail!("{name}: {reason}");
        }
        Ok(ScaleFigures {
            spheres: count,
            generate_seconds,
            build_seconds,
            hierarchy_seconds,
            scene_bytes_per_sphere: (spheres.capacity() * size_of::<Sphere>()) as f64 / spheres.len() as f64,
            table_bytes_per_sphere,
            peak_memory_bytes: peak_memory(),
            samples_per_pixel: row.samples_per_pixel,
            paths_per_second: row.paths_per_second,
            rays_per_second: row.rays_per_second,
        })
    }
}
