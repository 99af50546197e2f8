//! The flags of `weekender bench` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::raw::ProgressChoice;
use super::sources;
use super::values::{JsonTarget, Levels, parse_counts, parse_levels, parse_seconds, parse_size, whole};
use crate::backends::BackendError;
use crate::chart::ChartFormat;
use crate::recipe::Recipe;
use crate::render::{RenderJob, SAMPLE_LIMIT, SIZE_LIMIT, SamplerKind};
use crate::render_cpu::{CpuError, Isa};
use crate::scene::builtin::BuiltinScene;
use crate::stages::Stage;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawBench {
    /// A built-in scene, field:N or a scene file; may be given several times [default: three-spheres and book]
    #[arg(long, value_name = "NAME|FILE.toml", help_heading = "Scenes")]
    pub scene: Vec<String>,
    /// Measure fields of A to B spheres instead, each about three times as large as the one before
    #[arg(long, value_name = "A..B", value_parser = parse_counts, conflicts_with = "scene",
          help_heading = "Scenes")]
    pub scale: Option<Vec1<u64>>,
    /// Measure the gain from leaving out of each kernel the code that its picture does not need, for all stages and
    /// built-in scenes
    #[arg(long, conflicts_with_all = ["scale", "plot"], help_heading = "Scenes")]
    pub features: bool,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's; with --features, 200 pixels across]
    #[arg(long, value_name = "WxH", value_parser = parse_size, help_heading = "Scenes")]
    pub size: Option<(u32, u32)>,
    /// Maximum samples per pixel of a run [default: the scene's, but no more than 75 million paths; with --features, as
    /// many as --run-limit allows]
    #[arg(long, alias = "spp", value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100),
          allow_hyphen_values = true, help_heading = "Scenes")]
    pub samples: Option<u64>,
    /// Source of random numbers [default: sobol, or the scene's]
    #[arg(long, value_enum, help_heading = "Scenes")]
    pub sampler: Option<SamplerKind>,

    /// Instruction levels, separated by commas; auto: the best of this processor, all: all that it has
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto",
          help_heading = "Candidates")]
    pub isa: Levels,
    /// Threads of the rows with several threads, 1 to 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1024_u64, 8),
          allow_hyphen_values = true, help_heading = "Candidates")]
    pub threads: Option<u64>,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Candidates")]
    pub adapter: Option<String>,

    /// Runs of each row, after a warm-up that does not count, 1 to 1000 [default: 5, or 3 with --quick]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1000_u64, 5),
          allow_hyphen_values = true, help_heading = "Measurement")]
    pub runs: Option<u64>,
    /// Approximate time limit of a run in seconds; slow rows take fewer samples [default: 10, or 1 with --quick; with
    /// --features .4 and .1]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, help_heading = "Measurement")]
    pub run_limit: Option<f64>,
    /// Fewer samples and runs, for a first impression within a minute
    #[arg(long, help_heading = "Measurement")]
    pub quick: bool,

    /// Write all runs and figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", help_heading = "Files")]
    pub json: Option<PathBuf>,
    /// Write a chart as .png or .svg
    #[arg(long, value_name = "FILE", help_heading = "Files")]
    pub plot: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Values of a flag that itself takes a list. (clap would take a plain `Vec` for a flag that may be repeated.)
pub(super) type Vec1<T> = Box<[T]>;

/// Options of `weekender bench`.
#[derive(Debug)]
pub struct BenchOptions {
    /// Scenes to measure.
    pub scenes: Vec<BenchScene>,
    /// Numbers of spheres in fields, ascending; if empty, scenes are measured.
    pub scale: Vec<u64>,
    /// Whether each scene's own kernel is compared with the general one.
    pub features: bool,
    /// Instruction levels, the most capable last; at least one.
    pub levels: Vec<Isa>,
    /// Number of threads of the rows with several threads.
    pub threads: usize,
    /// The GPU that was named.
    pub adapter: Option<String>,
    /// Number of runs of each row.
    pub runs: usize,
    /// Approximate time limit of a run.
    pub run_limit_seconds: f64,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
    /// Where the chart is written.
    pub plot: Option<PathBuf>,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    size: Option<(u32, u32)>,
    samples: Option<u64>,
    sampler: Option<SamplerKind>,
    path_limit: u64,
}

/// A scene to measure.
#[derive(Debug)]
pub struct BenchScene {
    /// Its name.
    pub name: String,
    /// Whether it is a stage of the book.
    pub is_stage: bool,
    /// The job to render.
    pub job: RenderJob,
    /// Most samples per pixel of a run.
    pub samples: u64,
}

/// Scenes that are measured if none is named.
const DEFAULT_SCENES: [&str; 2] = ["three-spheres", "book"];

/// Most paths of a run by default.
const PATH_LIMIT: u64 = 75_000_000;
const QUICK_PATH_LIMIT: u64 = 3_000_000;

/// Width of pictures with `--features`, pixels.
const FEATURES_WIDTH: u32 = 200;

impl BenchOptions {
    /// Most samples per pixel of a run.
    pub fn samples_of(&self, recipe: &Recipe) -> u64 {
        let (width, height) = self.size.unwrap_or((recipe.settings.width, recipe.settings.height));
        let pixels = u64::from(width) * u64::from(height);
        if self.features {
            return self.samples.unwrap_or(SAMPLE_LIMIT);
        }
        self.samples.unwrap_or_else(|| {
            let most = (self.path_limit / pixels).max(1);
            // Sobol points are best at powers of two.
            if recipe.samples_per_pixel <= most { recipe.samples_per_pixel } else { 1 << most.ilog2() }
        })
    }

    fn add(&mut self, recipe: Recipe, is_stage: bool) -> Result<(), CliError> {
        let (name, samples) = (recipe.name.clone(), self.samples_of(&recipe));
        let job = self.change(recipe)?;
        job.check_memory(2)?;
        self.scenes.push(BenchScene { name, is_stage, job, samples });
        Ok(())
    }

    /// Whether the same job is measured already.
    fn has(&self, recipe: &Recipe) -> Result<bool, CliError> {
        let job = self.change(recipe.clone())?;
        Ok(self.scenes.iter().any(|scene| scene.job == job))
    }

    /// The job of a recipe with the changes of the flags. The recipe's scene is not copied.
    ///
    /// # Errors
    /// See [`RenderJob::new`].
    pub fn change(&self, recipe: Recipe) -> Result<RenderJob, CliError> {
        let mut settings = recipe.settings;
        let own_size = (settings.width, settings.height);
        (settings.width, settings.height) = self.size.unwrap_or(match self.features {
            true => (FEATURES_WIDTH, scaled_height(own_size)),
            false => own_size,
        });
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        Ok(RenderJob::new(recipe.scene, recipe.camera, settings, recipe.rules)?)
    }
}

/// The height that a picture of `own_size` has at [`FEATURES_WIDTH`].
fn scaled_height((width, height): (u32, u32)) -> u32 {
    let scaled = f64::from(height) * f64::from(FEATURES_WIDTH) / f64::from(width);
    (scaled.round() as u32).clamp(1, SIZE_LIMIT)
}

/// Validates the flags of `weekender bench`.
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
        features: raw.features,
        levels,
        threads: raw.threads.and_then(|threads| usize::try_from(threads).ok()).unwrap_or_else(cores),
        adapter: raw.adapter,
        runs: raw.runs.map_or(if raw.quick { 3 } else { 5 }, |runs| runs as usize),
        run_limit_seconds: raw.run_limit.unwrap_or(match (raw.features, raw.quick) {
            (false, false) => 10.0,
            (false, true) => 1.0,
            (true, false) => 0.4,
            (true, true) => 0.1,
        }),
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
    let named: Vec<&str> = match raw.scene.as_slice() {
        [] if options.features => BuiltinScene::ALL.iter().map(|scene| scene.name).collect(),
        [] => DEFAULT_SCENES.to_vec(),
        named => named.iter().map(String::as_str).collect(),
    };
    if options.features && raw.scene.is_empty() {
        for stage in Stage::ALL {
            options.add(stage.recipe(), true)?;
        }
    }
    for name in named {
        let recipe = sources::scene(name)?;
        // Some stages show a built-in scene.
        let is_new = !options.features || !options.has(&recipe)?;
        if is_new {
            options.add(recipe, false)?;
        }
    }
    Ok(options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};

    fn options(words: &str) -> BenchOptions {
        let line = format!("weekender bench --scene metals --isa portable --threads 1 {words}");
        match parse(line.split(' ').map(Into::into)).unwrap() {
            Request::Bench(options) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn samples_are_those_of_the_scene_or_a_power_of_two_that_can_be_paid_for() {
        let mut recipe = Recipe::builtin("metals").unwrap();
        let mut samples = |words: &str, wanted: u64| {
            recipe.samples_per_pixel = wanted;
            options(words).samples_of(&recipe)
        };
        // 75 million paths are 75 samples of each of a million pixels, and with --quick 3.
        for (wanted, expected) in [(1, 1), (74, 74), (75, 75), (76, 64), (1000, 64)] {
            assert_eq!(samples("--size 1000x1000", wanted), expected, "{wanted}");
        }
        for (wanted, expected) in [(2, 2), (3, 3), (4, 2)] {
            assert_eq!(samples("--size 1000x1000 --quick", wanted), expected, "{wanted}");
        }
        assert_eq!(samples("--size 1800x1700 --quick", 5), 1, "less than one");
        assert_eq!(samples("--size 1800x1700 --quick --samples 9", 5), 9);
        assert_eq!(samples("--features", 5), SAMPLE_LIMIT);
        assert_eq!(samples("--features --samples 9", 5), 9);
        (recipe.settings.width, recipe.settings.height) = (1000, 1000);
        recipe.samples_per_pixel = 76;
        assert_eq!(options("--quick --runs 1").samples_of(&recipe), 2, "the scene's own size");
    }

    #[test]
    fn runs_have_a_number_and_a_time_limit() {
        for (words, runs, limit) in [
            ("--progress off", 5, 10.0),
            ("--quick", 3, 1.0),
            ("--features", 5, 0.4),
            ("--features --quick", 3, 0.1),
            ("--quick --runs 7 --run-limit .5", 7, 0.5),
        ] {
            let options = options(words);
            assert_eq!((options.runs, options.run_limit_seconds), (runs, limit), "{words}");
        }
    }

    #[test]
    fn a_picture_keeps_its_shape_when_it_is_narrowed() {
        for (own, height) in [((400, 225), 113), ((400, 224), 112), ((200, 7), 7), ((100, 7), 14)] {
            assert_eq!(scaled_height(own), height, "{own:?}");
        }
        assert_eq!(scaled_height((SIZE_LIMIT, 1)), 1);
        assert_eq!(scaled_height((1, SIZE_LIMIT)), SIZE_LIMIT);
    }
}
