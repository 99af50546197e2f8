//! The final figures of a picture, as text and as JSON.

use crate::cli::RenderOptions;
use crate::console::printable;
use crate::describe::{counted, seconds};
use crate::files::{JsonPath, ShownPath};
use crate::film::{ErrorEstimate, Film};
use crate::progressive::{Contribution, HistoryPoint, Phase, Status};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// The JSON of one picture, or of all stages.
#[derive(Serialize)]
pub(super) struct SummaryJson {
    schema: u32,
    version: &'static str,
    #[serde(flatten)]
    content: Content,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Content {
    One(Box<Summary>),
    All { stages: Vec<Summary> },
}

impl SummaryJson {
    pub(super) fn of_one(summary: Summary) -> Self {
        SummaryJson::new(Content::One(Box::new(summary)))
    }

    pub(super) fn of_all(stages: Vec<Summary>) -> Self {
        SummaryJson::new(Content::All { stages })
    }

    fn new(content: Content) -> Self {
        SummaryJson { schema: SCHEMA, version: env!("CARGO_PKG_VERSION"), content }
    }
}

/// Time and quality of one picture. Times and counts are those of this run; `samples_per_pixel`, `rejected_samples`
/// and the estimates are those of the film, including its earlier samples.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Summary {
    scene: String,
    stage: Option<&'static str>,
    width: u32,
    height: u32,
    max_depth: u32,
    sampler: &'static str,
    seed: u32,
    backend: Option<&'static str>,
    device: Option<String>,
    lanes: Option<usize>,
    threads: Option<usize>,
    kernel: String,
    left_out: Vec<&'static str>,
    samples_per_pixel: u64,
    sample_ranges: String,
    added_samples_per_pixel: u64,
    prepare_seconds: f64,
    hierarchy_seconds: f64,
    trace_seconds: f64,
    write_seconds: f64,
    total_seconds: f64,
    paths: u64,
    rays: u64,
    paths_per_second: f64,
    rays_per_second: f64,
    lane_occupancy: Option<f64>,
    rmse_estimate: Option<f64>,
    rmse_deviation: Option<f64>,
    rel_mse_estimate: Option<f64>,
    rejected_samples: u64,
    ended_by: &'static str,
    #[serde(skip)]
    ended_by_words: String,
    #[serde(skip)]
    error: Option<ErrorEstimate>,
    backends: Vec<Contribution>,
    history: Vec<HistoryPoint>,
    warnings: Vec<String>,
    files: Vec<JsonPath>,
}

impl Summary {
    pub(super) fn new(
        render: &RenderOptions,
        status: &Status,
        film: Option<&Film>,
        files: Vec<PathBuf>,
        write: Duration,
    ) -> Self {
        let settings = render.job.settings();
        let backend = status.backend.as_ref();
        let (ended_by, ended_by_words) = ending(&status.phase);
        Summary {
            scene: render.recipe.name.clone(),
            stage: render.stage.map(|stage| stage.id),
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            sampler: settings.sampler.name(),
            seed: settings.seed,
            backend: backend.map(|info| info.name),
            device: backend.map(|info| info.device.clone()),
            lanes: backend.map(|info| info.lanes),
            threads: backend.map(|info| info.threads),
            kernel: status.kernel.clone(),
            left_out: status.left_out.clone(),
            samples_per_pixel: status.samples_per_pixel,
            sample_ranges: film.map_or_else(String::new, |film| film.samples().to_string()),
            added_samples_per_pixel: status.contributions.iter().map(|part| part.samples_per_pixel).sum(),
            prepare_seconds: status.prepare.saturating_sub(status.hierarchy).as_secs_f64(),
            hierarchy_seconds: status.hierarchy.as_secs_f64(),
            trace_seconds: status.trace.as_secs_f64(),
            write_seconds: write.as_secs_f64(),
            total_seconds: (status.elapsed + write).as_secs_f64(),
            paths: status.stats.paths,
            rays: status.stats.rays,
            paths_per_second: status.paths_per_second(),
            rays_per_second: status.rays_per_second(),
            lane_occupancy: status.lane_occupancy(),
            rmse_estimate: status.error.map(|error| error.rmse),
            rmse_deviation: status.error.map(|error| error.rmse_deviation),
            rel_mse_estimate: status.error.map(|error| error.rel_mse),
            rejected_samples: status.rejected_samples,
            ended_by,
            ended_by_words,
            error: status.error,
            backends: status.contributions.clone(),
            history: status.history.clone(),
            warnings: status.messages.clone(),
            files: files.into_iter().map(JsonPath).collect(),
        }
    }
}

fn ending(phase: &Phase) -> (&'static str, String) {
    match phase {
        Phase::Done(reason) => (reason.name(), reason.words().to_owned()),
        Phase::Failed(_) => ("failure", "a failure".to_owned()),
        _ => ("nothing", "nothing".to_owned()),
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { scene, width, height, max_depth, sampler, seed, .. } = self;
        let scene = printable(scene);
        writeln!(f, "scene    {scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}")?;
        if let (Some(backend), Some(device)) = (self.backend, &self.device) {
            let [lanes, threads] = [self.lanes, self.threads].map(Option::unwrap_or_default);
            let (lanes, threads) = (counted(lanes as u64, "lane"), counted(threads as u64, "thread"));
            writeln!(f, "backend  {backend} {device}, {lanes}, {threads}")?;
            writeln!(f, "kernel   {}", self.kernel)?;
            let left_out =
                if self.left_out.is_empty() { "nothing".to_owned() } else { self.left_out.join(", ") };
            writeln!(f, "left out {left_out}")?;
        }
        if self.backends.len() > 1 {
            let part = |c: &Contribution| {
                format!("{} by {} {}", c.samples_per_pixel, c.backend.name, c.backend.device)
            };
            writeln!(f, "shares   {}", self.backends.iter().map(part).collect::<Vec<_>>().join(", "))?;
        }
        let added = match self.added_samples_per_pixel {
            added if added == self.samples_per_pixel => String::new(),
            added => format!(" ({added} of them new)"),
        };
        writeln!(
            f,
            "samples  {}{added} per pixel, ended by {}",
            self.samples_per_pixel, self.ended_by_words
        )?;
        writeln!(
            f,
            "time     {} (prepare {:.3} s, build hierarchy {:.3} s, trace {:.3} s, write {:.3} s)",
            seconds(self.total_seconds),
            self.prepare_seconds,
            self.hierarchy_seconds,
            self.trace_seconds,
            self.write_seconds
        )?;
        write!(
            f,
            "speed    {:.2} Mpaths/s, {:.2} Mrays/s",
            self.paths_per_second / 1e6,
            self.rays_per_second / 1e6
        )?;
        match self.lane_occupancy {
            Some(share) => writeln!(f, ", {:.1} % of lanes in use", 100.0 * share)?,
            None => writeln!(f)?,
        }
        let rejected = counted(self.rejected_samples, "rejected sample");
        match &self.error {
            Some(error) => {
                let source = match error.is_without_noise() {
                    true => "the two halves agree",
                    false => "estimated from the two halves",
                };
                writeln!(f, "error    {} ({source}), {rejected}", error.words())?;
            }
            None => writeln!(f, "error    not estimated, {rejected}")?,
        }
        if self.files.is_empty() {
            return writeln!(f, "files    none");
        }
        let files: Vec<String> = self.files.iter().map(|path| path.0.shown()).collect();
        writeln!(f, "files    {}", files.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::tests::options;
    use crate::film::ROUNDING_LIMIT;
    use crate::progressive::EndReason;
    use crate::render::{BackendInfo, Stats};
    use serde_json::json;

    /// The status of a render that has ended.
    fn ended() -> Status {
        Status {
            samples_per_pixel: 10,
            stats: Stats {
                paths: 6_000_000,
                rays: 15_000_000,
                busy_lanes: 3,
                offered_lanes: 4,
                ..Stats::default()
            },
            prepare: Duration::from_secs(3),
            hierarchy: Duration::from_secs(1),
            trace: Duration::from_secs(2),
            elapsed: Duration::from_secs(6),
            kernel: "glass".to_owned(),
            left_out: vec!["lens"],
            error: Some(ErrorEstimate { rmse: 0.02, rmse_deviation: 0.001, rel_mse: 0.3 }),
            ..Status::default()
        }
    }

    #[test]
    fn the_summary_tells_what_the_status_holds() {
        let part = |name, samples_per_pixel| Contribution {
            backend: BackendInfo { name, device: "x".to_owned(), lanes: 8, threads: 1 },
            samples_per_pixel,
        };
        let status = Status {
            phase: Phase::Done(EndReason::NoiseTarget),
            backend: Some(part("cpu", 0).backend),
            rejected_samples: 1,
            contributions: vec![part("cpu", 5), part("gpu", 3)],
            ..ended()
        };
        let files = vec![PathBuf::from("a.png")];
        let summary =
            Summary::new(&options(&["--depth", "24"]), &status, None, files, Duration::from_millis(500));
        assert_eq!(
            summary.to_string(),
            "scene    three-spheres, 4x3, depth 24, sobol, seed 0\n\
             backend  cpu x, 8 lanes, 1 thread\n\
             kernel   glass\n\
             left out lens\n\
             shares   5 by cpu x, 3 by gpu x\n\
             samples  10 (8 of them new) per pixel, ended by the noise target\n\
             time     6.5 s (prepare 2.000 s, build hierarchy 1.000 s, trace 2.000 s, write 0.500 s)\n\
             speed    3.00 Mpaths/s, 7.50 Mrays/s, 75.0 % of lanes in use\n\
             error    2.000e-2 ± 5.0 % RMSE (estimated from the two halves), 1 rejected sample\n\
             files    a.png\n"
        );
        let error = Some(ErrorEstimate { rmse: ROUNDING_LIMIT, rmse_deviation: 0.0, rel_mse: 0.0 });
        let told = Summary { error, ..summary.clone() }.to_string();
        let line = "\nerror    3e-8 RMSE, by rounding alone (the two halves agree), 1 rejected sample\n";
        assert!(told.contains(line), "{told}");
        let told = Summary { error: None, ..summary.clone() }.to_string();
        assert!(told.contains("\nerror    not estimated, 1 rejected sample\n"), "{told}");
        let json = serde_json::to_value(&summary).unwrap();
        for (key, value) in [("prepare_seconds", 2.0), ("total_seconds", 6.5), ("rel_mse_estimate", 0.3)] {
            assert_eq!(json[key], value, "{key}");
        }
    }

    #[test]
    fn the_json_has_each_figure_under_its_key() {
        let backend = BackendInfo { name: "cpu", device: "x".to_owned(), lanes: 8, threads: 3 };
        let status = Status {
            phase: Phase::Failed("it broke".to_owned()),
            backend: Some(backend.clone()),
            rejected_samples: 9,
            contributions: vec![Contribution { backend, samples_per_pixel: 7 }],
            messages: vec!["warned".to_owned()],
            ..ended()
        };
        let options = options(&["--depth", "24", "--seed", "5", "--stage", "metal"]);
        let mut film = options.job.new_film();
        film.record(2..12, 0).unwrap();
        let files = vec![PathBuf::from("a.png"), PathBuf::from("b.exr")];
        let summary = Summary::new(&options, &status, Some(&film), files, Duration::from_millis(500));
        let json = serde_json::to_value(SummaryJson::of_one(summary.clone())).unwrap();
        for (key, value) in [
            ("schema", json!(1)),
            ("version", json!(env!("CARGO_PKG_VERSION"))),
            ("stage", json!("metal")),
            ("width", json!(4)),
            ("height", json!(3)),
            ("max_depth", json!(24)),
            ("seed", json!(5)),
            ("backend", json!("cpu")),
            ("device", json!("x")),
            ("lanes", json!(8)),
            ("threads", json!(3)),
            ("kernel", json!("glass")),
            ("left_out", json!(["lens"])),
            ("samples_per_pixel", json!(10)),
            ("sample_ranges", json!("2..12")),
            ("added_samples_per_pixel", json!(7)),
            ("prepare_seconds", json!(2.0)),
            ("hierarchy_seconds", json!(1.0)),
            ("trace_seconds", json!(2.0)),
            ("write_seconds", json!(0.5)),
            ("total_seconds", json!(6.5)),
            ("paths", json!(6_000_000)),
            ("rays", json!(15_000_000)),
            ("paths_per_second", json!(3e6)),
            ("rays_per_second", json!(7.5e6)),
            ("lane_occupancy", json!(0.75)),
            ("rmse_estimate", json!(0.02)),
            ("rmse_deviation", json!(0.001)),
            ("rel_mse_estimate", json!(0.3)),
            ("rejected_samples", json!(9)),
            ("ended_by", json!("failure")),
            ("warnings", json!(["warned"])),
            ("files", json!(["a.png", "b.exr"])),
        ] {
            assert_eq!(json[key], value, "{key}");
        }
        assert!(
            summary.to_string().contains(" (7 of them new) per pixel, ended by a failure\n"),
            "{summary}"
        );
        let all = serde_json::to_value(SummaryJson::of_all(vec![summary.clone(), summary])).unwrap();
        assert_eq!((&all["schema"], all["stages"].as_array().map(Vec::len)), (&json!(1), Some(2)));
        assert_eq!(all["stages"][1]["seed"], 5);
    }
}
