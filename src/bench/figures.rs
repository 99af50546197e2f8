//! The measured figures: runs, medians and ranges.

use super::machine::Machine;
use crate::film::Film;
use crate::render::Stats;
use crate::statistics::median;
use serde::Serialize;

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
pub const SCHEMA: u32 = 1;

/// The figures are doubtful if the range of the runs exceeds this fraction of their median.
pub const SPREAD_LIMIT: f64 = 0.1;

/// Everything that was measured.
#[derive(Clone, Debug, Serialize)]
pub struct BenchFigures {
    /// See [`SCHEMA`].
    pub schema: u32,
    /// The machine on which it was measured.
    pub machine: Machine,
    /// Scenes, each with a row per candidate.
    pub scenes: Vec<SceneFigures>,
    /// Fields of growing size.
    pub scale: Vec<ScaleFigures>,
    /// What leaving things out of kernels gains, by device.
    pub features: Vec<DeviceFigures>,
    /// Reasons to doubt the figures.
    pub warnings: Vec<String>,
    /// Whether the user interrupted the measurement.
    pub interrupted: bool,
}

/// A scene and its rows.
#[derive(Clone, Debug, Serialize)]
pub struct SceneFigures {
    /// Name of the scene.
    pub scene: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Most rays per path.
    pub max_depth: u32,
    /// The sampler; the baseline always uses independent numbers, as the book does.
    pub sampler: &'static str,
    /// Number of spheres.
    pub spheres: usize,
    /// The rows in the order of the table.
    pub rows: Vec<Row>,
}

/// What kind of candidate a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The plain C program.
    Baseline,
    /// One ray at a time.
    Scalar,
    /// Packets on one thread.
    Packets,
    /// Several threads.
    Threads,
    /// A GPU.
    Gpu,
}

/// A candidate and its runs.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Its name in the table.
    pub name: String,
    /// Its kind.
    pub kind: Kind,
    /// Number of paths that advance in step.
    pub lanes: usize,
    /// Number of threads.
    pub threads: usize,
    /// Samples per pixel of each run.
    pub samples_per_pixel: u64,
    /// All runs except the warm-up.
    pub runs: Vec<Run>,
    /// Paths per second over the runs.
    pub paths_per_second: Option<Spread>,
    /// Rays per second over the runs.
    pub rays_per_second: Option<Spread>,
    /// Fraction of lanes that traced a ray.
    pub lanes_in_use: Option<f64>,
    /// Median paths per second, relative to the baseline's.
    pub ratio_to_baseline: Option<f64>,
    /// 1 / (mean squared error times seconds), from the film's own estimate; `None` if it has none.
    pub efficiency: Option<f64>,
    /// Why it was not measured.
    pub skipped: Option<String>,
}

/// A run. Its time does not include reading, preparing and writing.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Run {
    /// Wall time of tracing, seconds.
    pub seconds: f64,
    /// Number of paths: pixels times samples.
    pub paths: u64,
    /// Number of rays traced.
    pub rays: u64,
    /// Lanes that traced a ray, summed over all intersection steps.
    pub busy_lanes: u64,
    /// Lanes available, summed over the same steps.
    pub offered_lanes: u64,
    /// RMSE that the film estimates.
    pub rmse: Option<f64>,
}

/// A field of a certain size.
#[derive(Clone, Debug, Serialize)]
pub struct ScaleFigures {
    /// Number of small spheres.
    pub spheres: u64,
    /// Time to generate the scene, seconds.
    pub generate_seconds: f64,
    /// Time to build the prepared scene, hierarchy included, seconds.
    pub build_seconds: f64,
    /// Time to build the hierarchy, seconds.
    pub hierarchy_seconds: f64,
    /// Bytes per sphere in the scene.
    pub scene_bytes_per_sphere: f64,
    /// Bytes per sphere in the prepared scene, hierarchy included.
    pub table_bytes_per_sphere: f64,
    /// Peak memory of the process, from generating the scene to the last run.
    pub peak_memory_bytes: Option<u64>,
    /// Samples per pixel of each run.
    pub samples_per_pixel: u64,
    /// Paths per second over the runs.
    pub paths_per_second: Option<Spread>,
    /// Rays per second over the runs.
    pub rays_per_second: Option<Spread>,
}

/// The gain of leaving things out of kernels, on one device.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceFigures {
    /// The device, with lanes and threads of a CPU.
    pub device: String,
    /// Stages and scenes in the order of the table.
    pub rows: Vec<GainRow>,
    /// Why it was not measured.
    pub skipped: Option<String>,
}

/// A stage or scene, rendered with its own kernel and with the general one in turn.
#[derive(Clone, Debug, Default, Serialize)]
pub struct GainRow {
    /// Id of the stage or name of the scene.
    pub name: String,
    /// Whether it is a stage of the book.
    pub is_stage: bool,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Most rays per path.
    pub max_depth: u32,
    /// The sampler.
    pub sampler: &'static str,
    /// Samples per pixel of each run.
    pub samples_per_pixel: u64,
    /// What its own kernel has.
    pub kernel: String,
    /// What its own kernel leaves out, of what the general kernel has.
    pub left_out: Vec<&'static str>,
    /// All runs of its own kernel except the warm-up.
    pub own_runs: Vec<Run>,
    /// As many runs of the general kernel.
    pub general_runs: Vec<Run>,
    /// Paths per second of its own kernel.
    pub own_paths_per_second: Option<Spread>,
    /// Paths per second of the general kernel.
    pub general_paths_per_second: Option<Spread>,
    /// Time of the general kernel relative to its own, over the pairs of runs.
    pub gain: Option<Spread>,
    /// Whether the films of both kernels are equal to the bit; `None` if they were not compared.
    pub same_bits: Option<bool>,
    /// Why it was not measured.
    pub skipped: Option<String>,
}

/// The spread of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
}

impl Spread {
    /// `None` if there are no values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let min = values.iter().copied().reduce(f64::min)?;
        let max = values.iter().copied().reduce(f64::max)?;
        Some(Spread { median: median(values)?, min, max })
    }

    /// The range as a fraction of the median.
    pub fn share(self) -> f64 {
        (self.max - self.min) / self.median
    }
}

impl Run {
    /// The figures of a pass that a renderer added to an empty film.
    pub fn of(stats: &Stats, film: &Film) -> Self {
        Run {
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
    /// Computes the row's figures from its runs.
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

impl GainRow {
    /// Computes the row's figures from its runs.
    pub fn sum_up(&mut self) {
        let speeds = |runs: &[Run]| Spread::of(runs.iter().map(|run| run.paths as f64 / run.seconds));
        self.own_paths_per_second = speeds(&self.own_runs);
        self.general_paths_per_second = speeds(&self.general_runs);
        let pairs = self.own_runs.iter().zip(&self.general_runs);
        self.gain = Spread::of(pairs.map(|(own, general)| general.seconds / own.seconds));
    }
}

impl SceneFigures {
    /// Computes the figures of all rows.
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

    fn row(kind: Kind, runs: Vec<Run>) -> Row {
        Row {
            name: String::new(),
            kind,
            lanes: 4,
            threads: 1,
            samples_per_pixel: 1,
            runs,
            paths_per_second: None,
            rays_per_second: None,
            lanes_in_use: None,
            ratio_to_baseline: None,
            efficiency: None,
            skipped: None,
        }
    }

    #[test]
    fn rows_are_compared_with_the_baseline_of_their_own_scene() {
        let run = |paths: u64| Run {
            seconds: 2.0,
            paths,
            rays: 7 * paths,
            busy_lanes: 0,
            offered_lanes: 0,
            rmse: None,
        };
        let ratios = |rows: Vec<Row>| -> Vec<Option<f64>> {
            let mut figures = SceneFigures {
                scene: "book".to_owned(),
                width: 4,
                height: 3,
                max_depth: 2,
                sampler: "sobol",
                spheres: 1,
                rows,
            };
            figures.sum_up();
            figures.rows.iter().map(|row| row.ratio_to_baseline).collect()
        };
        // The medians of the baseline are 10 in the first scene and 40 in the second.
        let first = vec![
            row(Kind::Packets, vec![run(80), run(60), run(90)]),
            row(Kind::Baseline, vec![run(20), run(10), run(90)]),
            row(Kind::Gpu, Vec::new()),
        ];
        assert_eq!(ratios(first), [Some(4.0), Some(1.0), None]);
        let second = vec![row(Kind::Baseline, vec![run(80)]), row(Kind::Packets, vec![run(20)])];
        assert_eq!(ratios(second), [Some(1.0), Some(0.25)]);
        let without = vec![row(Kind::Packets, vec![run(80)]), row(Kind::Baseline, Vec::new())];
        assert_eq!(ratios(without), [None, None]);
    }

    #[test]
    fn a_row_sums_up_its_runs() {
        let run = Run { seconds: 2.0, paths: 8, rays: 20, busy_lanes: 3, offered_lanes: 4, rmse: Some(0.5) };
        let row = |kind| {
            let mut row = row(kind, vec![run, Run { seconds: 1.0, ..run }, Run { seconds: 4.0, ..run }]);
            row.sum_up();
            row
        };
        let packets = row(Kind::Packets);
        assert_eq!(packets.paths_per_second, Some(Spread { median: 4.0, min: 2.0, max: 8.0 }));
        assert_eq!(packets.rays_per_second, Some(Spread { median: 10.0, min: 5.0, max: 20.0 }));
        assert_eq!((packets.efficiency, packets.lanes_in_use), (Some(2.0), Some(0.75)));
        // A film without noise, such as a black one, tells nothing about the efficiency.
        let mut black = Row { runs: vec![Run { rmse: Some(0.0), ..run }], ..packets };
        black.sum_up();
        assert_eq!(black.efficiency, None);
        // A GPU has threads instead.
        assert_eq!(row(Kind::Gpu).lanes_in_use, None);
    }

    #[test]
    fn a_run_has_the_figures_of_its_pass_and_the_error_of_its_film() {
        let trace = std::time::Duration::from_millis(250);
        let stats = Stats { paths: 1, rays: 2, rejected: 3, busy_lanes: 4, offered_lanes: 5, trace };
        let run = Run::of(&stats, &Film::new(2, 1, 1));
        assert_eq!((run.seconds, run.paths, run.rays), (0.25, 1, 2));
        assert_eq!((run.busy_lanes, run.offered_lanes, run.rmse), (4, 5, None));
        // The halves differ in one pixel.
        let mut film = Film::new(2, 1, 2);
        film.halves_mut()[0][1] = crate::film::PixelSum([1 << 24, 0, 0]);
        film.record(0..4, 0).unwrap();
        let run = Run::of(&Stats { trace: std::time::Duration::ZERO, ..stats }, &film);
        assert_eq!(run.rmse, film.error().map(|error| error.rmse));
        assert!(run.rmse.is_some_and(|rmse| rmse > 0.0));
        assert!(run.seconds > 0.0, "speeds are divided by it");
    }
}
