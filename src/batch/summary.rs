//! The final figures of a picture, as text and as JSON.

use crate::cli::BatchOptions;
use crate::denoise::DenoisedError;
use crate::progressive::describe::{counted, seconds};
use crate::progressive::{Contribution, Phase, Status};
use crate::system::console::printable;
use crate::system::files::ShownPath;
use serde_json::{Value, json};
use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

/// Version of the JSON. Incremented when a key is removed or changes meaning.
pub(super) const SCHEMA: u32 = 1;

/// Time and quality of one picture. Times and counts are those of this run; samples per pixel, rejected samples and the
/// estimates are those of the film, including its earlier samples.
pub(super) struct Summary<'a> {
    pub render: &'a BatchOptions,
    /// The samples in the film.
    pub samples: Option<String>,
    pub status: Status,
    /// The error of the denoised picture.
    pub denoised: Option<DenoisedError>,
    pub files: Vec<PathBuf>,
    /// Time spent writing the files.
    pub writing: Duration,
}

impl Summary<'_> {
    fn ended_by(&self) -> (&'static str, &'static str) {
        match &self.status.phase {
            Phase::Done(reason) => (reason.name(), reason.words()),
            Phase::Failed(_) => ("failure", "a failure"),
            _ => ("nothing", "nothing"),
        }
    }

    fn preparing_seconds(&self) -> f64 {
        self.status.prepare.saturating_sub(self.status.hierarchy).as_secs_f64()
    }

    fn total_seconds(&self) -> f64 {
        (self.status.elapsed + self.writing).as_secs_f64()
    }

    pub fn json(&self) -> Value {
        let Summary { render, status, .. } = self;
        let (settings, backend, error) = (render.job.settings(), status.backend.as_ref(), status.error);
        json!({
            "scene": render.recipe.name,
            "stage": render.stage.map(|stage| stage.id),
            "width": settings.width,
            "height": settings.height,
            "max_depth": settings.max_depth,
            "sampler": settings.sampler.name(),
            "seed": settings.seed,
            "backend": backend.map(|info| info.name),
            "device": backend.map(|info| &info.device),
            "lanes": backend.map(|info| info.lanes),
            "threads": backend.map(|info| info.threads),
            "kernel": status.kernel,
            "left_out": status.left_out,
            "samples_per_pixel": status.samples_per_pixel,
            "sample_ranges": self.samples.as_deref().unwrap_or_default(),
            "added_samples_per_pixel": status.added(),
            "prepare_seconds": self.preparing_seconds(),
            "hierarchy_seconds": status.hierarchy.as_secs_f64(),
            "trace_seconds": status.trace.as_secs_f64(),
            "write_seconds": self.writing.as_secs_f64(),
            "total_seconds": self.total_seconds(),
            "paths": status.stats.paths,
            "rays": status.stats.rays,
            "paths_per_second": status.paths_per_second(),
            "rays_per_second": status.rays_per_second(),
            "lane_occupancy": status.lane_occupancy(),
            "rmse_estimate": error.map(|error| error.rmse),
            "rmse_deviation": error.map(|error| error.rmse_deviation),
            "rel_mse_estimate": error.map(|error| error.rel_mse),
            "denoised_rmse_estimate": self.denoised.map(|error| error.rmse()),
            "denoised_rmse_deviation": self.denoised.map(|error| error.rmse_deviation()),
            "rejected_samples": status.rejected_samples,
            "ended_by": self.ended_by().0,
            "backends": status.contributions,
            "history": status.history,
            "warnings": status.messages,
            "files": self.files.iter().map(|file| file.to_string_lossy()).collect::<Vec<_>>(),
        })
    }

    /// Lines about what rendered it.
    fn backend_lines(&self) -> Vec<(&'static str, String)> {
        let Status { backend: Some(backend), kernel, left_out, contributions, .. } = &self.status else {
            return Vec::new();
        };
        let lanes = counted(backend.lanes as u64, "lane");
        let threads = counted(backend.threads as u64, "thread");
        let left_out = if left_out.is_empty() { "nothing".to_owned() } else { left_out.join(", ") };
        let mut lines = vec![
            ("backend", format!("{} {}, {lanes}, {threads}", backend.name, backend.device)),
            ("kernel", kernel.clone()),
            ("left out", left_out),
        ];
        if contributions.len() > 1 {
            let share = |part: &Contribution| {
                format!("{} by {} {}", part.samples_per_pixel, part.backend.name, part.backend.device)
            };
            lines.push(("shares", contributions.iter().map(share).collect::<Vec<_>>().join(", ")));
        }
        lines
    }
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { render, status, .. } = self;
        let settings = render.job.settings();
        let scene = format!(
            "{}, {}x{}, depth {}, {}, seed {}",
            printable(&render.recipe.name),
            settings.width,
            settings.height,
            settings.max_depth,
            settings.sampler.name(),
            settings.seed
        );
        let (held, added) = (status.samples_per_pixel, status.added());
        let new = if added == held { String::new() } else { format!(" ({added} of them new)") };
        let samples = format!("{held}{new} per pixel, ended by {}", self.ended_by().1);
        let time = format!(
            "{} (prepare {:.3} s, build hierarchy {:.3} s, trace {:.3} s, write {:.3} s)",
            seconds(self.total_seconds()),
            self.preparing_seconds(),
            status.hierarchy.as_secs_f64(),
            status.trace.as_secs_f64(),
            self.writing.as_secs_f64()
        );
        let [paths, rays] = [status.paths_per_second(), status.rays_per_second()].map(|speed| speed / 1e6);
        let lanes = status.lane_occupancy().map(|share| format!(", {:.1} % of lanes in use", 100.0 * share));
        let speed = format!("{paths:.2} Mpaths/s, {rays:.2} Mrays/s{}", lanes.unwrap_or_default());
        let rejected = counted(status.rejected_samples, "rejected sample");
        let error = match &status.error {
            Some(error) if error.is_without_noise() => {
                format!("{} (the two halves agree), {rejected}", error.words())
            }
            Some(error) => format!("{} (estimated from the two halves), {rejected}", error.words()),
            None => format!("not estimated, {rejected}"),
        };
        let denoised = self.denoised.map(|error| ("denoised", error.words()));
        let files = self.files.iter().map(ShownPath::shown).collect::<Vec<_>>().join(", ");
        let files = if files.is_empty() { "none".to_owned() } else { files };
        let figures = [("samples", samples), ("time", time), ("speed", speed), ("error", error)];
        let lines = std::iter::once(("scene", scene)).chain(self.backend_lines()).chain(figures);
        let lines = lines.chain(denoised).chain([("files", files)]);
        lines.into_iter().try_for_each(|(name, value)| writeln!(f, "{name:<8} {value}"))
    }
}
