//! The measured figures, as they appear in the JSON.

use super::super::{Candidate, Traced};
use crate::job::render::{RenderJob, RenderSettings};
use crate::numbers::statistics::median;
use serde::Serialize;

#[derive(Default, Serialize)]
pub struct BenchFigures {
    /// Scenes, with one row per candidate.
    pub scenes: Vec<SceneFigures>,
    /// Reasons to doubt the figures.
    pub warnings: Vec<String>,
    pub interrupted: bool,
}

#[derive(Serialize)]
pub struct SceneFigures {
    pub scene: String,
    /// The C program always uses independent numbers, as the book does.
    #[serde(flatten)]
    pub settings: RenderSettings,
    pub spheres: usize,
    /// Rows in the table's order.
    pub rows: Vec<Row>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The C program.
    #[default]
    Baseline,
    /// One ray at a time.
    Scalar,
    /// Packets on one thread.
    Packets,
    /// Packets on several threads.
    Threads,
    Gpu,
}

#[derive(Default, Serialize)]
pub struct Row {
    pub name: String,
    pub kind: Kind,
    /// Number of paths that advance in lockstep.
    pub lanes: usize,
    pub threads: usize,
    pub samples_per_pixel: u64,
    /// All runs except the warm-up.
    pub runs: Vec<Run>,
    pub paths_per_second: Option<Spread>,
    pub rays_per_second: Option<Spread>,
    /// Share of the lanes that traced a ray; `None` for the C program and a GPU.
    pub lanes_in_use: Option<f64>,
    /// Paths per second relative to the C program in the same scene.
    pub ratio_to_baseline: Option<f64>,
    /// `1 / (MSE seconds)`; `None` if the error is unknown.
    pub efficiency: Option<f64>,
    /// Why it was not measured.
    pub skipped: Option<String>,
}

/// A run. The time excludes reading, preparing and writing.
#[derive(Clone, Copy, Serialize)]
pub struct Run {
    /// Wall time of tracing.
    pub seconds: f64,
    /// Pixels times samples.
    pub paths: u64,
    pub rays: u64,
    /// Lanes that traced a ray, summed over all intersection steps.
    pub busy_lanes: u64,
    /// Lanes available, summed over the same steps.
    pub offered_lanes: u64,
    /// RMSE that the film estimates.
    pub rmse: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    pub median: f64,
    pub min: f64,
    pub max: f64,
}

impl Spread {
    /// `None` without values.
    pub fn of(values: impl Iterator<Item = f64> + Clone) -> Option<Self> {
        let min = values.clone().reduce(f64::min)?;
        let max = values.clone().reduce(f64::max)?;
        Some(Spread { median: median(values)?, min, max })
    }

    fn of_speeds(runs: &[Run], count: fn(&Run) -> u64) -> Option<Self> {
        Spread::of(runs.iter().map(|run| count(run) as f64 / run.seconds))
    }
}

impl Run {
    pub fn of(Traced { film, stats, .. }: &Traced) -> Self {
        Run {
            // Speeds are divided by it.
            seconds: stats.trace.as_secs_f64().max(1e-9),
            paths: stats.paths,
            rays: stats.rays,
            busy_lanes: stats.busy_lanes,
            offered_lanes: stats.offered_lanes,
            rmse: film.error().map(|error| error.rmse),
        }
    }
}

impl Row {
    pub fn new(kind: Kind, candidate: &mut Candidate) -> Self {
        let skipped = candidate.start().err().map(|error| format!("{error:#}"));
        let (lanes, threads) = candidate.info().map_or((0, 0), |info| (info.lanes, info.threads));
        Row { name: candidate.name.clone(), kind, lanes, threads, skipped, ..Row::default() }
    }

    pub fn sum_up(&mut self) {
        self.paths_per_second = Spread::of_speeds(&self.runs, |run| run.paths);
        self.rays_per_second = Spread::of_speeds(&self.runs, |run| run.rays);
        let total = |count: fn(&Run) -> u64| self.runs.iter().map(count).sum::<u64>();
        let offered = total(|run| run.offered_lanes);
        let has_lanes = offered > 0 && self.kind != Kind::Gpu;
        self.lanes_in_use = has_lanes.then(|| total(|run| run.busy_lanes) as f64 / offered as f64);
        let error = |run: &Run| run.rmse.filter(|rmse| *rmse > 0.0);
        self.efficiency =
            median(self.runs.iter().filter_map(|run| Some(1.0 / (error(run)?.powi(2) * run.seconds))));
    }
}

impl SceneFigures {
    /// Relates the rows to the first one, the C program.
    pub fn new(scene: &str, job: &RenderJob, mut rows: Vec<Row>) -> Self {
        let speed = |row: &Row| row.paths_per_second.map(|spread| spread.median);
        let baseline = rows.first().and_then(speed);
        for row in &mut rows {
            row.ratio_to_baseline = speed(row).zip(baseline).map(|(own, baseline)| own / baseline);
        }
        let (scene, spheres) = (scene.to_owned(), job.scene().spheres.len());
        SceneFigures { scene, settings: *job.settings(), spheres, rows }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::backends::BackendChoice;

    fn row(kind: Kind, runs: Vec<Run>) -> Row {
        let choice = BackendChoice::Reference { threads: Some(1) };
        let mut row = Row::new(kind, &mut Candidate::new("reference", choice));
        row.runs = runs;
        row.sum_up();
        row
    }

    #[test]
    fn rows_sum_up_their_runs() {
        let run = Run { seconds: 2.0, paths: 8, rays: 20, busy_lanes: 3, offered_lanes: 4, rmse: Some(0.5) };
        let runs = vec![run, Run { seconds: 1.0, ..run }, Run { seconds: 4.0, ..run }];
        let packets = row(Kind::Packets, runs.clone());
        assert_eq!(packets.paths_per_second, Some(Spread { median: 4.0, min: 2.0, max: 8.0 }));
        assert_eq!(packets.rays_per_second, Some(Spread { median: 10.0, min: 5.0, max: 20.0 }));
        assert_eq!((packets.efficiency, packets.lanes_in_use), (Some(2.0), Some(0.75)));
        // A black film has no noise, so its efficiency is unknown.
        assert_eq!(row(Kind::Packets, vec![Run { rmse: Some(0.0), ..run }]).efficiency, None);
        // A GPU has threads instead of lanes.
        assert_eq!(row(Kind::Gpu, runs).lanes_in_use, None);
    }
}
