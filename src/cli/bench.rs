//! The flags of `weekender bench`.

use super::values::{Auto, parse_levels, parse_seconds, parse_size, whole};
use super::{check_outputs, sources};
use crate::job::recipe::Recipe;
use crate::job::render::{RenderJob, SAMPLE_LIMIT, SamplerKind};
use crate::render_cpu::Isa;
use crate::system::terminal::ProgressChoice;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Options of `weekender bench`.
#[derive(Debug, Args)]
pub struct BenchOptions {
    /// A built-in scene, field:N or a scene file; may be given several times [default: three-spheres and book]
    #[arg(long, value_name = "NAME|FILE.toml")]
    scene: Vec<String>,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Maximum samples per pixel of a run [default: the scene's, but no more than 75 million paths]
    #[arg(long, alias = "spp", value_name = "COUNT", value_parser = whole::<u64>(1..=SAMPLE_LIMIT))]
    samples: Option<u64>,
    /// Source of random numbers [default: sobol, or the scene's]
    #[arg(long, value_enum)]
    sampler: Option<SamplerKind>,
    /// Instruction levels, separated by commas; auto: the best that this processor supports; all: every one it supports
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto")]
    isa: Auto<Vec<Isa>>,
    /// Number of threads in the multi-threaded rows, 1 to 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = whole::<usize>(1..=1024))]
    threads: Option<usize>,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    pub adapter: Option<String>,
    /// Runs of each row, after an untimed warm-up, 1 to 1000; with --quick, 3 by default
    #[arg(long, value_name = "COUNT", value_parser = whole::<usize>(1..=1000), default_value = "5",
          default_value_if("quick", "true", "3"))]
    pub runs: usize,
    /// Approximate time limit of a run in seconds; slow rows take fewer samples; with --quick, 1 by default
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "10",
          default_value_if("quick", "true", "1"))]
    pub run_limit: f64,
    /// Fewer samples and runs, for a first impression within a minute
    #[arg(long)]
    quick: bool,
    /// Write all runs and figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// A scene to measure.
#[derive(Debug)]
pub struct BenchScene {
    pub name: String,
    pub job: RenderJob,
    /// Most samples per pixel of a run.
    pub samples: u64,
}

/// Scenes measured by default.
const DEFAULT_SCENES: [&str; 2] = ["three-spheres", "book"];

/// Default maximum number of paths per run.
const PATH_LIMIT: u64 = 75_000_000;
const QUICK_PATH_LIMIT: u64 = 3_000_000;

impl BenchOptions {
    /// Checks that the JSON can be written and does not replace a scene file.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self) -> Result<()> {
        let inputs: Vec<PathBuf> =
            self.scene.iter().flat_map(|scene| sources::inputs(Some(scene.as_ref()))).collect();
        check_outputs(inputs.iter().map(PathBuf::as_path), self.json.as_deref())
    }

    /// Instruction levels, the most capable last; at least one.
    pub fn levels(&self) -> Vec<Isa> {
        self.isa.clone().unwrap_or_else(|| Isa::available().last().copied().into_iter().collect())
    }

    pub fn threads(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    }

    /// The scenes to measure.
    ///
    /// # Errors
    /// If one is unknown, not valid or too large.
    pub fn scenes(&self) -> Result<Vec<BenchScene>> {
        let named: Vec<&str> = match self.scene.as_slice() {
            [] => DEFAULT_SCENES.to_vec(),
            named => named.iter().map(String::as_str).collect(),
        };
        named.into_iter().map(|name| self.scene_of(sources::scene(name)?)).collect()
    }

    /// A recipe with the changes of the flags.
    ///
    /// # Errors
    /// If it is not valid or too large.
    fn scene_of(&self, recipe: Recipe) -> Result<BenchScene> {
        let samples = self.samples_of(&recipe);
        let mut settings = recipe.settings;
        if let Some((width, height)) = self.size {
            (settings.width, settings.height) = (width, height);
        }
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        let job = RenderJob::new(recipe.scene, recipe.camera, settings, recipe.rules)?;
        job.check_memory(2, 0)?;
        Ok(BenchScene { name: recipe.name, job, samples })
    }

    /// Most samples per pixel of a run.
    fn samples_of(&self, recipe: &Recipe) -> u64 {
        if let Some(samples) = self.samples {
            return samples;
        }
        let (width, height) = self.size.unwrap_or((recipe.settings.width, recipe.settings.height));
        let paths = if self.quick { QUICK_PATH_LIMIT } else { PATH_LIMIT };
        let most = (paths / (u64::from(width) * u64::from(height))).max(1);
        // Sobol points are best at powers of two.
        if recipe.samples_per_pixel <= most { recipe.samples_per_pixel } else { 1 << most.ilog2() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::request;
    use crate::cli::{Command, Request};

    fn options(words: &str) -> BenchOptions {
        match request(&format!("bench --scene metals --isa portable --threads 1 {words}")) {
            Ok(Request::Command(Command::Bench(options))) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn samples_fit_the_path_limit() {
        let mut recipe = Recipe::builtin("metals").unwrap();
        let mut samples = |words: &str, wanted: u64| {
            recipe.samples_per_pixel = wanted;
            options(words).samples_of(&recipe)
        };
        // 75 million paths are 75 samples of each of a million pixels, and with --quick 3.
        for (wanted, expected) in [(1, 1), (75, 75), (76, 64), (1000, 64)] {
            assert_eq!(samples("--size 1000x1000", wanted), expected, "{wanted}");
        }
        assert_eq!(samples("--size 1000x1000 --quick", 4), 2);
        assert_eq!(samples("--size 1800x1700 --quick", 5), 1, "less than one");
        assert_eq!(samples("--size 1800x1700 --quick --samples 9", 5), 9);
    }
}
