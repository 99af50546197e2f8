//! The flags of `weekender report`.

use super::error::CliError;
use super::paths::Paths;
use super::raw::{ProgressChoice, RawSwitch};
use super::sources;
use super::values::{parse_rmse, parse_seconds, parse_size, whole};
use crate::backends::BackendChoice;
use crate::job::recipe::{Recipe, plain_name};
use crate::job::render::{SAMPLE_LIMIT, SamplerKind};
use clap::Args;
use std::path::PathBuf;

/// Options of `weekender report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Directory of the report: report.md, .csv and .json, error-vs-time.png and .svg, references
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,

    /// Check the accuracy of the error estimates. Other defaults apply: 24 pictures of 96x54 per curve, 256 samples, no
    /// time limit; scenes three-spheres, book, close-up and hollow glass from nearby; backends cpu and, if there is
    /// one, gpu
    #[arg(long, help_heading = "What is compared")]
    calibration: bool,
    /// Built-in scenes, field:N or scene files, separated by commas [default: three-spheres,book]
    #[arg(
        long = "scenes",
        alias = "scene",
        value_name = "A,B,...",
        value_delimiter = ',',
        help_heading = "What is compared"
    )]
    scenes: Vec<String>,
    /// Backends: cpu (the widest packets), scalar (one lane), portable, reference (f64), gpu,
    /// c89 (the plain C program) [default: cpu,scalar, gpu if there is one, c89 if there is a C compiler]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', help_heading = "What is compared")]
    backends: Vec<String>,
    /// Samplers
    #[arg(
        long,
        value_enum,
        value_name = "A,B",
        value_delimiter = ',',
        default_value = "sobol,independent",
        help_heading = "What is compared"
    )]
    pub samplers: Vec<SamplerKind>,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "What is compared")]
    adapter: Option<String>,

    /// Width and height of all pictures in pixels, each 1 to 16384 [default: 160x90]
    #[arg(long, value_name = "WxH", value_parser = parse_size, help_heading = "How it is measured")]
    size: Option<(u32, u32)>,
    /// Pictures per curve, which differ only in their random numbers, 1 to 1000 [default: 8]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1000_u32, 8),
          allow_hyphen_values = true, help_heading = "How it is measured")]
    seeds: Option<u32>,
    /// Seconds of tracing for all pictures of a curve; each picture ends with the last doubling that fits
    /// [default: 12]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true,
          help_heading = "How it is measured")]
    time_limit: Option<f64>,
    /// Maximum samples per pixel, 2 to 4294967296 [default: 1024]
    #[arg(long, alias = "max-spp", value_name = "COUNT", value_parser = whole(2..=SAMPLE_LIMIT, 1024),
          allow_hyphen_values = true, help_heading = "How it is measured")]
    max_samples: Option<u64>,
    /// Keep samples in two halves, which is needed to estimate the error; off keeps them as a single point set
    #[arg(
        long,
        value_enum,
        default_value = "on",
        conflicts_with = "calibration",
        help_heading = "How it is measured"
    )]
    estimate_error: RawSwitch,
    /// Also report the seconds needed to reach this RMSE, and mark it in the plot [default: 0.01]
    #[arg(long, value_name = "RMSE", value_parser = parse_rmse, allow_hyphen_values = true,
          help_heading = "How it is measured")]
    target: Option<f64>,
    /// The backend that renders the references, named as for --backends
    #[arg(long, value_name = "BACKEND", default_value = "reference", help_heading = "How it is measured")]
    reference_backend: String,
    /// Samples per pixel of the references [default: 4 times --max-samples, with --calibration 16 times]
    #[arg(long, value_name = "COUNT", value_parser = whole(2..=SAMPLE_LIMIT, 1024),
          allow_hyphen_values = true, help_heading = "How it is measured")]
    reference_samples: Option<u64>,

    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    /// The command as typed, with file names instead of paths.
    #[arg(skip)]
    pub command: String,
}

/// How to render the pictures that errors are measured against.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReferenceChoice {
    /// Name of the backend.
    pub name: String,
    pub choice: BackendChoice,
    pub samples: u64,
}

/// Defaults for the flags of a report.
struct ReportDefaults {
    scenes: &'static [&'static str],
    backends: &'static [&'static str],
    seeds: u32,
    size: (u32, u32),
    time_limit: f64,
    max_samples: u64,
    /// Samples of the reference, relative to those of the longest curve.
    reference_factor: u64,
}

const RACE: ReportDefaults = ReportDefaults {
    scenes: &["three-spheres", "book"],
    backends: &["cpu", "scalar", "gpu", BASELINE],
    seeds: 8,
    size: (160, 90),
    time_limit: 12.0,
    max_samples: 1024,
    reference_factor: 4,
};

const CALIBRATION: ReportDefaults = ReportDefaults {
    scenes: &["three-spheres", "book", "close-up", sources::NEAR_GLASS],
    backends: &["cpu", "gpu"],
    seeds: 24,
    size: (96, 54),
    time_limit: 1e9,
    max_samples: 256,
    reference_factor: 16,
};

/// Name of the C program among the backends of a report.
const BASELINE: &str = "c89";

/// Target errors that every report has.
const TARGETS: [f64; 2] = [0.01, 0.001];

/// The files that a report writes to its directory, apart from references.
const REPORT_FILES: [&str; 5] =
    ["report.json", "report.md", "report.csv", "error-vs-time.png", "error-vs-time.svg"];

impl ReportOptions {
    /// Returns an error if there is no such backend or flags conflict; `command` is what the report says of itself.
    pub(super) fn check(self, command: String) -> Result<Self, CliError> {
        let names = self.backends();
        let uses_gpu = names.iter().chain([&self.reference_backend]).any(|name| name == "gpu");
        if self.adapter.is_some() && !uses_gpu {
            let reason = "it chooses among GPUs; otherwise leave it out";
            return Err(CliError::Needs { flag: "--adapter", other: "gpu in --backends", reason });
        }
        for name in &names {
            self.backend(name)?;
        }
        self.reference()?;
        Ok(ReportOptions { command, ..self })
    }

    fn defaults(&self) -> &'static ReportDefaults {
        if self.calibration { &CALIBRATION } else { &RACE }
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
        let present = self.defaults().backends.iter().filter(|name| has_gpu || **name != "gpu");
        present.map(|name| (*name).to_owned()).collect()
    }

    /// The backend of this name; `None` is the C program.
    ///
    /// # Errors
    /// If there is none.
    pub fn backend(&self, name: &str) -> Result<Option<BackendChoice>, CliError> {
        if name == BASELINE { Ok(None) } else { self.backend_among(name, &[BASELINE]).map(Some) }
    }

    /// `more` are further names to list if there is no backend of this name.
    fn backend_among(&self, name: &str, more: &[&str]) -> Result<BackendChoice, CliError> {
        BackendChoice::named(name, self.adapter.as_deref()).ok_or_else(|| {
            let choices = [&BackendChoice::NAMES[..], more].concat().join(", ");
            CliError::BackendName { name: name.to_owned(), choices }
        })
    }

    /// The scenes at their final size.
    ///
    /// # Errors
    /// If one is unknown, too large or named twice, or if the report would replace an input.
    pub fn scenes(&self) -> Result<Vec<Recipe>, CliError> {
        let mut scenes: Vec<Recipe> = match self.scenes.as_slice() {
            [] => {
                self.defaults().scenes.iter().map(|name| sources::carried(name)).collect::<Result<_, _>>()?
            }
            named => named.iter().map(|name| sources::scene(name)).collect::<Result<_, _>>()?,
        };
        for index in 0..scenes.len() {
            let name = scenes[index].name.clone();
            if scenes[..index].iter().any(|scene| scene.name == name) {
                return Err(CliError::SameScene { name });
            }
            (scenes[index].settings.width, scenes[index].settings.height) = self.size();
            // A film, its reference, and the film of a pass.
            scenes[index].job()?.check_memory(4)?;
        }
        self.check_paths(&scenes)?;
        Ok(scenes)
    }

    fn check_paths(&self, scenes: &[Recipe]) -> Result<(), CliError> {
        let names =
            REPORT_FILES.iter().map(|name| (*name).to_owned()).chain(scenes.iter().map(reference_name));
        let files = self.scenes.iter().filter_map(|scene| sources::scene_file(Some(scene)));
        let paths = files.fold(Paths::default(), |paths, file| paths.read("--scenes", Some(file)));
        names
            .fold(paths, |paths, name| paths.write("a file of --out,", Some(&self.out.join(name))))
            .check(&[])
    }

    /// Where the reference of a scene is kept.
    pub fn reference_path(&self, scene: &Recipe) -> PathBuf {
        self.out.join(reference_name(scene))
    }

    /// Number of pictures of each curve.
    pub fn seeds(&self) -> u32 {
        self.seeds.unwrap_or(self.defaults().seeds)
    }

    pub fn size(&self) -> (u32, u32) {
        self.size.unwrap_or(self.defaults().size)
    }

    /// Seconds of tracing for all pictures of a curve.
    pub fn time_limit(&self) -> f64 {
        self.time_limit.unwrap_or(self.defaults().time_limit)
    }

    pub fn max_samples(&self) -> u64 {
        self.max_samples.unwrap_or(self.defaults().max_samples)
    }

    /// Whether samples are kept in two halves.
    pub fn estimates_error(&self) -> bool {
        self.estimate_error == RawSwitch::On
    }

    /// Target errors; the first is marked in the plot.
    pub fn targets(&self) -> Vec<f64> {
        let usual = TARGETS.into_iter().filter(|target| self.target != Some(*target));
        self.target.into_iter().chain(usual).collect()
    }

    /// The references for errors.
    ///
    /// # Errors
    /// If there is no such backend.
    pub fn reference(&self) -> Result<ReferenceChoice, CliError> {
        let name = self.reference_backend.clone();
        let choice = self.backend_among(&name, &[])?;
        let samples = (self.defaults().reference_factor * self.max_samples()).min(SAMPLE_LIMIT);
        Ok(ReferenceChoice { name, choice, samples: self.reference_samples.unwrap_or(samples) })
    }
}

fn reference_name(scene: &Recipe) -> String {
    format!("reference-{}.exr", plain_name(&scene.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};

    fn parsed(words: &str) -> Result<ReportOptions, String> {
        let line = format!("weekender report --out r {words}");
        match parse(line.split(' ').map(Into::into)) {
            Ok(Request::Report(options)) => Ok(*options),
            Ok(other) => panic!("{other:?}"),
            Err(failure) => Err(failure.to_string()),
        }
    }

    #[test]
    fn adapter_flag_requires_the_gpu() {
        let names = |words: &str| parsed(words).unwrap().backends();
        assert_eq!(names("--adapter some"), ["cpu", "scalar", "gpu", "c89"]);
        assert_eq!(names("--adapter some --calibration"), ["cpu", "gpu"]);
        assert_eq!(names("--adapter some --backends portable,gpu"), ["portable", "gpu"]);
        let error = parsed("--backends portable --adapter some").unwrap_err();
        assert!(error.contains("--adapter") && error.contains("gpu in --backends"), "{error}");
        assert!(parsed("--backends portable --adapter some --reference-backend gpu").is_ok());
    }

    #[test]
    fn reference_samples_stay_within_the_limit() {
        for (words, expected) in [
            ("--max-samples 64", 256),
            ("--max-samples 64 --calibration", 1024),
            ("--max-samples 4294967296", SAMPLE_LIMIT),
            ("--max-samples 64 --reference-samples 100", 100),
        ] {
            let found = parsed(&format!("--backends portable {words}")).unwrap().reference().unwrap();
            assert_eq!(found.samples, expected, "{words}");
        }
    }
}
