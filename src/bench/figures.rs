//! The measured figures: runs, medians and ranges.

use super::machine::Machine;
use crate::statistics::median;
use serde::Serialize;

/// Version of the JSON: it grows when a key changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// If the range of the runs is above this share of their median, the figures are doubtful.
pub const SPREAD_LIMIT: f64 = 0.1;

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct BenchFigures {
    /// [`SCHEMA`].
    pub schema: u32,
    /// Where.
    pub machine: Machine,
    /// Scenes, with a row for each candidate.
    pub scenes: Vec<SceneFigures>,
    /// Fields of growing size.
    pub scale: Vec<ScaleFigures>,
    /// Why the figures are doubtful, if so.
    pub warnings: Vec<String>,
    /// Whether it was ended early.
    pub interrupted: bool,
}

/// A scene and its rows.
#[derive(Clone, Debug, Serialize)]
pub struct SceneFigures {
    /// Its name.
    pub scene: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Most rays of a path.
    pub max_depth: u32,
    /// Where numbers come from; the baseline has the book's independent ones.
    pub sampler: &'static str,
    /// Spheres.
    pub spheres: usize,
    /// In the order of the table.
    pub rows: Vec<Row>,
}

/// What kind of program a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Plain C.
    Baseline,
    /// One ray at a time.
    Scalar,
    /// Packets on one thread.
    Packets,
    /// All threads.
    Threads,
    /// A graphics processor.
    Gpu,
}

/// A candidate and its runs.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What it is.
    pub name: String,
    /// Its kind.
    pub kind: Kind,
    /// Paths that advance in step.
    pub lanes: usize,
    /// Threads.
    pub threads: usize,
    /// Samples per pixel of a run.
    pub samples_per_pixel: u64,
    /// All runs but the warm-up.
    pub runs: Vec<Run>,
    /// Over the runs.
    pub paths_per_second: Option<Spread>,
    /// Over the runs.
    pub rays_per_second: Option<Spread>,
    /// Share of lanes that traced a ray.
    pub lanes_in_use: Option<f64>,
    /// Median against that of the baseline.
    pub ratio_to_baseline: Option<f64>,
    /// 1 / (mean squared error times seconds), as the film estimates it; `None` where it sees no error.
    pub efficiency: Option<f64>,
    /// Why it was not measured.
    pub skipped: Option<String>,
}

/// A run. Reading, preparing and writing are not in its time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Run {
    /// Wall time of tracing.
    pub seconds: f64,
    /// Pixels times samples.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Lanes that traced a ray, over all intersections.
    pub busy_lanes: u64,
    /// Lanes there were.
    pub offered_lanes: u64,
    /// The film's estimate of its error.
    pub rmse: Option<f64>,
}

/// A field of some size.
#[derive(Clone, Debug, Serialize)]
pub struct ScaleFigures {
    /// Small spheres of the field.
    pub spheres: u64,
    /// Time to generate the scene.
    pub generate_seconds: f64,
    /// Time to build the tables, hierarchy included.
    pub build_seconds: f64,
    /// Time to build the hierarchy.
    pub hierarchy_seconds: f64,
    /// Memory of a sphere in the scene.
    pub scene_bytes_per_sphere: f64,
    /// Memory of a sphere in the tables that are traced, hierarchy included.
    pub table_bytes_per_sphere: f64,
    /// Largest memory of the process from generating to the last run.
    pub peak_memory_bytes: Option<u64>,
    /// Samples per pixel of a run.
    pub samples_per_pixel: u64,
    /// Over the runs.
    pub paths_per_second: Option<Spread>,
    /// Over the runs.
    pub rays_per_second: Option<Spread>,
}

/// Runs in three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// In the middle.
    pub median: f64,
    /// Least.
    pub min: f64,
    /// Most.
    pub max: f64,
}

impl Spread {
    /// `None` without values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let min = values.iter().copied().reduce(f64::min)?;
        let max = values.iter().copied().reduce(f64::max)?;
        Some(Spread { median: median(values)?, min, max })
    }

    /// Range as a share of the median.
    pub fn share(self) -> f64 {
        (self.max - self.min) / self.median
    }
}

impl Row {
    /// Works out what the runs say.
    pub fn sum_up(&mut self) {
        let per_second =
            |count: fn(&Run) -> u64| Spread::of(self.runs.iter().map(|run| count(run) as f64 / run.seconds));
        self.paths_per_second = per_second(|run| run.paths);
        self.rays_per_second = per_second(|run| run.rays);
        let total = |count: fn(&Run) -> u64| self.runs.iter().map(count).sum::<u64>();
        let offered = total(|run| run.offered_lanes);
        let has_lanes = offered > 0 && self.kind != Kind::Gpu;
        self.lanes_in_use = has_lanes.then(|| total(|run| run.busy_lanes) as f64 / offered as f64);
        let error = |run: &Run| run.rmse.filter(|rmse| *rmse > 0.0);
        let efficiency = |run: &Run| Some(1.0 / (error(run)?.powi(2) * run.seconds));
        self.efficiency = Spread::of(self.runs.iter().filter_map(efficiency)).map(|spread| spread.median);
    }
}

impl SceneFigures {
    /// Works out all rows.
    pub fn sum_up(&mut self) {
        self.rows.iter_mut().for_each(Row::sum_up);
        let median = |row: &Row| row.paths_per_second.map(|spread| spread.median);
        let baseline = self.rows.iter().find(|row| row.kind == Kind::Baseline).and_then(median);
        for row in &mut self.rows {
            row.ratio_to_baseline = median(row).zip(baseline).map(|(own, baseline)| own / baseline);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_has_the_middle_and_both_ends() {
        assert_eq!(Spread::of([3.0, 1.0, 2.0]), Some(Spread { median: 2.0, min: 1.0, max: 3.0 }));
        assert_eq!(Spread::of([4.0, 1.0, 2.0, 3.0]), Some(Spread { median: 2.5, min: 1.0, max: 4.0 }));
        assert_eq!(Spread::of([]), None);
    }
}
