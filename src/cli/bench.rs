//! The flags of `weekender bench`, and what they mean together.

use super::error::CliError;
use super::paths::Paths;
use super::raw::ProgressChoice;
use super::sources;
use super::values::{JsonTarget, Levels, parse_counts, parse_levels, parse_seconds, parse_size};
use crate::backends::BackendError;
use crate::chart::ChartFormat;
use crate::recipe::Recipe;
use crate::render::{RenderJob, SAMPLE_LIMIT, SamplerKind};
use crate::render_cpu::{CpuError, Isa};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawBench {
    /// A built-in scene, field:N or a scene file; may be given several times [default: three-spheres and book]
    #[arg(long, value_name = "NAME|FILE.toml", help_heading = "What is measured")]
    pub scene: Vec<String>,
    /// Measure fields of so many spheres instead, each about three times as large as the one before
    #[arg(long, value_name = "A..B", value_parser = parse_counts, conflicts_with = "scene",
          help_heading = "What is measured")]
    pub scale: Option<Vec1<u64>>,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size, help_heading = "What is measured")]
    pub size: Option<(u32, u32)>,
    /// Samples per pixel of a run, at most [default: the scene's, if that makes no more than 75 million paths]
    #[arg(long, alias = "spp", value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=SAMPLE_LIMIT),
          allow_hyphen_values = true, help_heading = "What is measured")]
    pub samples: Option<u64>,
    /// Where random numbers come from [default: sobol, or the scene's]
    #[arg(long, value_enum, help_heading = "What is measured")]
    pub sampler: Option<SamplerKind>,

    /// Instruction levels with commas between them; auto is the best of this processor, all are all it has
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto",
          help_heading = "Who is measured")]
    pub isa: Levels,
    /// Threads of the rows with several, 1 to 1024 [default: one a core]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=1024),
          allow_hyphen_values = true, help_heading = "Who is measured")]
    pub threads: Option<u64>,
    /// The GPU whose name, kind, backend or driver contains this; the only way to a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Who is measured")]
    pub adapter: Option<String>,

    /// Runs of each row, after a warm-up that is not counted, 1 to 1000 [default: 5, or 3 with --quick]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=1000),
          allow_hyphen_values = true, help_heading = "How")]
    pub runs: Option<u64>,
    /// Seconds that a run may take, about; slow rows take fewer samples [default: 10, or 1 with --quick]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, help_heading = "How")]
    pub run_limit: Option<f64>,
    /// Fewer samples and runs: a first impression in a minute
    #[arg(long, help_heading = "How")]
    pub quick: bool,

    /// Write all runs and figures as JSON; - is standard output
    #[arg(long, value_name = "FILE|-", help_heading = "Files")]
    pub json: Option<PathBuf>,
    /// Write a chart, .png or .svg
    #[arg(long, value_name = "FILE", help_heading = "Files")]
    pub plot: Option<PathBuf>,
    /// Progress on standard error; auto: when it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Values of one flag. (clap would take a plain `Vec` for a flag that is given several times.)
pub(super) type Vec1<T> = Box<[T]>;

/// What is measured, and how.
#[derive(Debug)]
pub struct BenchOptions {
    /// Pictures.
    pub scenes: Vec<BenchScene>,
    /// Sizes of fields, rising; empty: scenes are measured.
    pub scale: Vec<u64>,
    /// Instruction levels, the most capable last; at least one.
    pub levels: Vec<Isa>,
    /// Threads of the rows with several.
    pub threads: usize,
    /// The GPU that was named.
    pub adapter: Option<String>,
    /// Runs of each row.
    pub runs: usize,
    /// What a run may take, about.
    pub run_limit_seconds: f64,
    /// Where the JSON goes.
    pub json: Option<JsonTarget>,
    /// Where the chart goes.
    pub plot: Option<PathBuf>,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    size: Option<(u32, u32)>,
    samples: Option<u64>,
    sampler: Option<SamplerKind>,
    path_limit: u64,
}

/// A picture that is measured.
#[derive(Debug)]
pub struct BenchScene {
    /// Its name.
    pub name: String,
    /// The job.
    pub job: RenderJob,
    /// Samples per pixel of a run, at most.
    pub samples: u64,
}

/// What is measured if nothing is asked for.
const DEFAULT_SCENES: [&str; 2] = ["three-spheres", "book"];

/// Most paths of a run.
const PATH_LIMIT: u64 = 75_000_000;
const QUICK_PATH_LIMIT: u64 = 3_000_000;

impl BenchOptions {
    /// Samples per pixel of a run, at most.
    pub fn samples_of(&self, recipe: &Recipe) -> u64 {
        let (width, height) = self.size.unwrap_or((recipe.settings.width, recipe.settings.height));
        let pixels = u64::from(width) * u64::from(height);
        self.samples.unwrap_or_else(|| {
            let most = (self.path_limit / pixels).max(1);
            // A power of two is what Sobol's points like best.
            if recipe.samples_per_pixel <= most { recipe.samples_per_pixel } else { 1 << most.ilog2() }
        })
    }

    /// The job of a recipe as the flags change it. The recipe's scene is not copied.
    ///
    /// # Errors
    /// See [`RenderJob::new`].
    pub fn change(&self, recipe: Recipe) -> Result<RenderJob, CliError> {
        let mut settings = recipe.settings;
        (settings.width, settings.height) = self.size.unwrap_or((settings.width, settings.height));
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        Ok(RenderJob::new(recipe.scene, recipe.camera, settings, recipe.rules)?)
    }
}

/// What `weekender bench` is asked for.
pub(super) fn bench(raw: RawBench) -> Result<BenchOptions, CliError> {
    let available = Isa::available();
    let levels = match raw.isa {
        Levels::Auto => available.last().copied().into_iter().collect(),
        Levels::All => available.clone(),
        Levels::Named(levels) => levels,
    };
    if let Some(isa) = levels.iter().copied().find(|isa| !available.contains(isa)) {
        return Err(BackendError::Cpu(CpuError::Isa { isa, available }).into());
    }
    if let Some(plot) = &raw.plot {
        ChartFormat::from_path(plot)?;
    }
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let mut options = BenchOptions {
        scenes: Vec::new(),
        scale: raw.scale.map_or_else(Vec::new, Vec::from),
        levels,
        threads: raw.threads.and_then(|threads| usize::try_from(threads).ok()).unwrap_or_else(cores),
        adapter: raw.adapter,
        runs: raw.runs.map_or(if raw.quick { 3 } else { 5 }, |runs| runs as usize),
        run_limit_seconds: raw.run_limit.unwrap_or(if raw.quick { 1.0 } else { 10.0 }),
        json: raw.json.map(JsonTarget::from),
        plot: raw.plot,
        progress: raw.progress,
        size: raw.size,
        samples: raw.samples,
        sampler: raw.sampler,
        path_limit: if raw.quick { QUICK_PATH_LIMIT } else { PATH_LIMIT },
    };
    let files = raw.scene.iter().filter_map(|scene| sources::scene_file(Some(scene)));
    files
        .fold(Paths::default(), |paths, file| paths.read("--scene", Some(file)))
        .write_json(options.json.as_ref())
        .write("--plot", options.plot.as_deref())
        .check(&[])?;
    if !options.scale.is_empty() {
        return Ok(options);
    }
    let named = raw.scene.iter().map(String::as_str);
    let names: Vec<&str> = if raw.scene.is_empty() { DEFAULT_SCENES.to_vec() } else { named.collect() };
    for name in names {
        let recipe = sources::scene(name)?;
        let (name, samples) = (recipe.name.clone(), options.samples_of(&recipe));
        let job = options.change(recipe)?;
        job.check_memory(2)?;
        options.scenes.push(BenchScene { name, job, samples });
    }
    Ok(options)
}
