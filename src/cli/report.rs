//! The flags of `weekender report`.

use super::sources;
use super::values::{backend_named, number, parse_seconds, parse_size, whole};
use crate::backends::BackendChoice;
use crate::job::recipe::Recipe;
use crate::job::render::{SAMPLE_LIMIT, SamplerKind};
use crate::system::terminal::ProgressChoice;
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::path::PathBuf;

/// Options of `weekender report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Directory of the report: report.md, report.json, error-vs-time.svg
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,
    /// Built-in scenes, field:N or scene files, separated by commas
    #[arg(
        long,
        alias = "scene",
        value_name = "A,B,...",
        value_delimiter = ',',
        default_value = "three-spheres,book"
    )]
    scenes: Vec<String>,
    /// Backends: cpu (the widest packets), scalar (one lane), portable, reference (f64), gpu,
    /// c89 (the plain C program) [default: cpu,scalar, gpu if available, c89 with a C compiler]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    backends: Vec<String>,
    /// Samplers
    #[arg(long, value_enum, value_name = "A,B", value_delimiter = ',', default_value = "sobol,independent")]
    pub samplers: Vec<SamplerKind>,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Width and height of all pictures in pixels, each 1 to 16384
    #[arg(long, value_name = "WxH", value_parser = parse_size, default_value = "160x90")]
    pub size: (u32, u32),
    /// Pictures per curve, which differ only in their random numbers, 1 to 1000
    #[arg(long, value_name = "COUNT", value_parser = whole::<u32>(1..=1000), default_value = "8")]
    pub seeds: u32,
    /// Seconds of tracing for all pictures of a curve; each picture doubles its samples as long as they fit
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, default_value = "12")]
    pub time_limit: f64,
    /// Maximum samples per pixel, 2 to 4294967296
    #[arg(long, alias = "max-spp", value_name = "COUNT", value_parser = whole::<u64>(2..=SAMPLE_LIMIT),
          default_value = "1024")]
    pub max_samples: u64,
    /// Also report the seconds needed to reach this RMSE, and mark it in the plot
    #[arg(long, value_name = "RMSE", default_value = "0.01",
          value_parser = number(f64::MIN_POSITIVE..=100.0, "above 0 and at most 100, such as 0.005"))]
    target: f64,
    /// The backend that renders the references, named as for --backends
    #[arg(long, value_name = "BACKEND", default_value = "reference")]
    pub reference_backend: String,
    /// Samples per pixel of the references [default: 4 times --max-samples]
    #[arg(long, value_name = "COUNT", value_parser = whole::<u64>(2..=SAMPLE_LIMIT))]
    reference_samples: Option<u64>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    /// The command line, as the report records it.
    #[arg(skip)]
    pub command: String,
}

/// Name of the C program among the backends of a report.
const BASELINE: &str = "c89";

/// Target errors that every report has.
const TARGETS: [f64; 2] = [0.01, 0.001];

impl ReportOptions {
    /// Checks the backends.
    ///
    /// # Errors
    /// If there is no such backend, or flags conflict.
    pub fn check(&self) -> Result<()> {
        let names = self.backends();
        let uses_gpu = names.iter().chain([&self.reference_backend]).any(|name| name == "gpu");
        ensure!(
            self.adapter.is_none() || uses_gpu,
            "--adapter needs gpu in --backends: it chooses among GPUs; otherwise leave it out"
        );
        names.iter().try_for_each(|name| self.backend(name).map(drop))?;
        self.reference().map(drop)
    }

    /// Whether backends were named; the default ones may be missing.
    pub fn names_backends(&self) -> bool {
        !self.backends.is_empty()
    }

    pub fn backends(&self) -> Vec<String> {
        if self.names_backends() {
            return self.backends.clone();
        }
        let has_gpu = BackendChoice::gpu_if_present(self.adapter.as_deref()).is_some();
        let usual = ["cpu", "scalar", "gpu", BASELINE].into_iter();
        usual.filter(|name| has_gpu || *name != "gpu").map(str::to_owned).collect()
    }

    /// The backend of this name; `None` is the C program.
    ///
    /// # Errors
    /// If there is none.
    pub fn backend(&self, name: &str) -> Result<Option<BackendChoice>> {
        if name == BASELINE {
            return Ok(None);
        }
        let backend = backend_named(name, self.adapter.as_deref());
        backend.map(Some).context("--backends takes c89, the plain C program, and these")
    }

    /// The scenes at their final size.
    ///
    /// # Errors
    /// If one is unknown, too large or named twice.
    pub fn scenes(&self) -> Result<Vec<Recipe>> {
        let mut scenes: Vec<Recipe> = self.scenes.iter().map(sources::scene).collect::<Result<_>>()?;
        for index in 0..scenes.len() {
            let name = scenes[index].name.clone();
            ensure!(
                scenes[..index].iter().all(|scene| scene.name != name),
                "--scenes has two scenes called {name}; leave one out or rename its file"
            );
            (scenes[index].settings.width, scenes[index].settings.height) = self.size;
            // A film, its reference, and the denoised one.
            scenes[index].job()?.check_memory(4, 0)?;
        }
        Ok(scenes)
    }

    /// Target errors; the first is marked in the plot.
    pub fn targets(&self) -> Vec<f64> {
        let usual = TARGETS.into_iter().filter(|target| self.target != *target);
        std::iter::once(self.target).chain(usual).collect()
    }

    /// The backend of the references.
    ///
    /// # Errors
    /// If there is no such backend.
    pub fn reference(&self) -> Result<BackendChoice> {
        backend_named(&self.reference_backend, self.adapter.as_deref())
    }

    pub fn reference_samples(&self) -> u64 {
        self.reference_samples.unwrap_or((4 * self.max_samples).min(SAMPLE_LIMIT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::request;
    use crate::cli::{Command, Request};

    fn parsed(words: &str) -> ReportOptions {
        match request(&format!("report --out r {words}")) {
            Ok(Request::Command(Command::Report(options))) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn adapter_flag_requires_the_gpu() {
        let names = |words: &str| parsed(words).backends();
        assert_eq!(names("--adapter some"), ["cpu", "scalar", "gpu", "c89"]);
        assert_eq!(names("--adapter some --backends portable,gpu"), ["portable", "gpu"]);
        assert!(parsed("--backends portable --adapter some --reference-backend gpu").check().is_ok());
    }

    #[test]
    fn reference_samples_stay_within_the_limit() {
        for (words, expected) in [
            ("--max-samples 64", 256),
            ("--max-samples 4294967296", SAMPLE_LIMIT),
            ("--max-samples 64 --reference-samples 100", 100),
        ] {
            let found = parsed(&format!("--backends portable {words}")).reference_samples();
            assert_eq!(found, expected, "{words}");
        }
    }
}
