//! The flags of `weekender report` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::raw::{ProgressChoice, RawSwitch};
use super::sources;
use super::values::{parse_rmse, parse_seconds, parse_size, whole};
use crate::backends::BackendChoice;
use crate::recipe::{Recipe, plain_name};
use crate::render::{SAMPLE_LIMIT, SamplerKind};
use crate::render_cpu::CpuOptions;
use crate::render_gpu::GpuOptions;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawReport {
    /// Directory of the report: report.md, .csv and .json, error-vs-time.png and .svg, references
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,

    /// Check the accuracy of the error estimates. Other defaults apply: 24 pictures of 96x54 per curve, 256 samples, no
    /// time limit; scenes three-spheres, book, close-up and hollow glass from nearby; backends cpu and, if there is
    /// one,
    /// gpu
    #[arg(long, help_heading = "What is compared")]
    pub calibration: bool,
    /// Built-in scenes, field:N or scene files, separated by commas [default: three-spheres,book]
    #[arg(
        long = "scenes",
        alias = "scene",
        value_name = "A,B,...",
        value_delimiter = ',',
        help_heading = "What is compared"
    )]
    pub scenes: Vec<String>,
    /// Backends: cpu (the widest packets), scalar (one lane), portable, reference (f64), gpu,
    /// c89 (the plain C program) [default: cpu,scalar, gpu if there is one, c89 if there is a C compiler]
    #[arg(long, value_name = "A,B,...", value_delimiter = ',', help_heading = "What is compared")]
    pub backends: Vec<String>,
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
    pub adapter: Option<String>,

    /// Width and height of all pictures in pixels, each 1 to 16384 [default: 160x90]
    #[arg(long, value_name = "WxH", value_parser = parse_size, help_heading = "How it is measured")]
    pub size: Option<(u32, u32)>,
    /// Pictures per curve, which differ only in their random numbers, 1 to 1000 [default: 8]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1000_u32, 8),
          allow_hyphen_values = true, help_heading = "How it is measured")]
    pub seeds: Option<u32>,
    /// Seconds of tracing for all pictures of a curve; each picture ends with the last doubling that fits
    /// [default: 12]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true,
          help_heading = "How it is measured")]
    pub time_limit: Option<f64>,
    /// Maximum samples per pixel, 2 to 4294967296 [default: 1024]
    #[arg(long, alias = "max-spp", value_name = "COUNT", value_parser = whole(2..=SAMPLE_LIMIT, 1024),
          allow_hyphen_values = true, help_heading = "How it is measured")]
    pub max_samples: Option<u64>,
    /// Keep samples in two halves, which is needed to estimate the error; off keeps them as a single point set
    #[arg(
        long,
        value_enum,
        default_value = "on",
        conflicts_with = "calibration",
        help_heading = "How it is measured"
    )]
    pub estimate_error: RawSwitch,
    /// Also report the seconds needed to reach this RMSE, and mark it in the plot [default: 0.01]
    #[arg(long, value_name = "RMSE", value_parser = parse_rmse, allow_hyphen_values = true,
          help_heading = "How it is measured")]
    pub target: Option<f64>,
    /// Measure relative to this film: of the only scene, at this size and with two halves
    #[arg(long, value_name = "FILM.exr", help_heading = "How it is measured")]
    pub reference: Option<PathBuf>,
    /// Otherwise, the backend that renders the references, named as for --backends
    #[arg(
        long,
        value_name = "BACKEND",
        default_value = "reference",
        conflicts_with = "reference",
        help_heading = "How it is measured"
    )]
    pub reference_backend: String,
    /// Samples per pixel of the references [default: 4 times --max-samples, with --calibration 16 times]
    #[arg(long, value_name = "COUNT", value_parser = whole(2..=SAMPLE_LIMIT, 1024),
          allow_hyphen_values = true, conflicts_with = "reference", help_heading = "How it is measured")]
    pub reference_samples: Option<u64>,

    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Options of `weekender report`.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// The scenes, at their final size.
    pub scenes: Vec<Recipe>,
    /// Names and backends.
    pub backends: Vec<(String, ReportBackend)>,
    /// Samplers.
    pub samplers: Vec<SamplerKind>,
    /// Number of pictures of each curve.
    pub seeds: u32,
    /// Width and height of all pictures.
    pub size: (u32, u32),
    /// Seconds of tracing for all pictures of a curve.
    pub time_limit: f64,
    /// Most samples per pixel.
    pub max_samples: u64,
    /// Whether samples are kept in two halves.
    pub estimate_error: bool,
    /// Target errors; the first is marked in the plot.
    pub targets: Vec<f64>,
    /// The reference for errors.
    pub reference: ReferenceChoice,
    /// Directory of the report.
    pub out: PathBuf,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// The command as typed, with file names instead of paths.
    pub command: String,
}

/// What renders a curve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReportBackend {
    /// A backend of this program.
    Renderer(BackendChoice),
    /// The plain C89 program.
    Baseline {
        /// Whether it was named; otherwise it may be missing.
        is_asked_for: bool,
    },
}

/// The reference for errors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ReferenceChoice {
    /// An existing film.
    File(PathBuf),
    /// A reference that is rendered.
    Make {
        /// Name of the backend.
        name: String,
        /// The backend.
        choice: BackendChoice,
        /// Samples per pixel.
        samples: u64,
    },
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

/// Name of the baseline among the backends of a report.
const BASELINE: &str = "c89";

/// Target errors that every report has.
const TARGETS: [f64; 2] = [0.01, 0.001];

/// The files that a report writes to its directory, apart from references.
const REPORT_FILES: [&str; 5] =
    ["report.json", "report.md", "report.csv", "error-vs-time.png", "error-vs-time.svg"];

/// Validates the flags of `weekender report`; `command` is what the report says of itself.
pub(super) fn report(raw: RawReport, command: String) -> Result<ReportOptions, CliError> {
    let defaults = if raw.calibration { CALIBRATION } else { RACE };
    let backends = report_backends(&raw, &defaults)?;
    let size = raw.size.unwrap_or(defaults.size);
    let scenes = report_scenes(&raw, &defaults, size)?;
    check_paths(&raw, &scenes)?;
    let max_samples = raw.max_samples.unwrap_or(defaults.max_samples);
    let reference = match raw.reference {
        Some(_) if scenes.len() > 1 => {
            let reason = "a film is the reference for only one scene; name that scene with --scenes";
            return Err(CliError::Together { flag: "--reference", other: "several --scenes", reason });
        }
        Some(path) => ReferenceChoice::File(path),
        None => {
            let choice = backend_named(&raw.reference_backend, raw.adapter.as_deref(), &[])?;
            let samples = (defaults.reference_factor * max_samples).min(SAMPLE_LIMIT);
            let samples = raw.reference_samples.unwrap_or(samples);
            ReferenceChoice::Make { name: raw.reference_backend, choice, samples }
        }
    };
    let mut targets: Vec<f64> = raw.target.into_iter().collect();
    targets.extend(TARGETS.into_iter().filter(|target| raw.target != Some(*target)));
    Ok(ReportOptions {
        scenes,
        backends,
        samplers: raw.samplers,
        seeds: raw.seeds.unwrap_or(defaults.seeds),
        size,
        time_limit: raw.time_limit.unwrap_or(defaults.time_limit),
        max_samples,
        estimate_error: raw.estimate_error == RawSwitch::On,
        targets,
        reference,
        out: raw.out,
        progress: raw.progress,
        command,
    })
}

/// Returns an error if the report would replace one of its inputs. Each of its `scenes` gets a reference, unless that is
/// given.
fn check_paths(raw: &RawReport, scenes: &[Recipe]) -> Result<(), CliError> {
    let reference = |scene: &Recipe| format!("reference-{}.exr", plain_name(&scene.name));
    let made: &[Recipe] = if raw.reference.is_some() { &[] } else { scenes };
    let names = REPORT_FILES.iter().map(|name| (*name).to_owned()).chain(made.iter().map(reference));
    let files = raw.scenes.iter().filter_map(|scene| sources::scene_file(Some(scene)));
    let paths = files.fold(Paths::default(), |paths, file| paths.read("--scenes", Some(file)));
    names
        .fold(paths.read("--reference", raw.reference.as_deref()), |paths, name| {
            paths.write("a file of --out,", Some(&raw.out.join(name)))
        })
        .check(&[])
}

/// Finds a backend; `more` are further names to list if there is none with this name.
fn backend_named(name: &str, adapter: Option<&str>, more: &[&str]) -> Result<BackendChoice, CliError> {
    BackendChoice::named(name, adapter).ok_or_else(|| {
        let choices = [&BackendChoice::NAMES[..], more].concat().join(", ");
        CliError::BackendName { name: name.to_owned(), choices }
    })
}

fn report_backends(
    raw: &RawReport,
    defaults: &ReportDefaults,
) -> Result<Vec<(String, ReportBackend)>, CliError> {
    let adapter = raw.adapter.as_deref();
    let is_asked_for = !raw.backends.is_empty();
    let names = if is_asked_for {
        raw.backends.clone()
    } else {
        let auto = || BackendChoice::auto(CpuOptions::default(), GpuOptions::default());
        let has_gpu = adapter.is_some() || matches!(auto(), BackendChoice::Gpu(_));
        let present = defaults.backends.iter().filter(|name| has_gpu || **name != "gpu");
        present.map(|name| (*name).to_owned()).collect()
    };
    if adapter.is_some() && !names.iter().chain([&raw.reference_backend]).any(|name| name == "gpu") {
        let reason = "it chooses among GPUs; otherwise leave it out";
        return Err(CliError::Needs { flag: "--adapter", other: "gpu in --backends", reason });
    }
    let of_name = |name: String| {
        let backend = match name.as_str() {
            BASELINE => ReportBackend::Baseline { is_asked_for },
            name => ReportBackend::Renderer(backend_named(name, adapter, &[BASELINE])?),
        };
        Ok((name, backend))
    };
    names.into_iter().map(of_name).collect()
}

fn report_scenes(
    raw: &RawReport,
    defaults: &ReportDefaults,
    size: (u32, u32),
) -> Result<Vec<Recipe>, CliError> {
    let sized = |recipe: Result<Recipe, CliError>| {
        let mut recipe = recipe?;
        (recipe.settings.width, recipe.settings.height) = size;
        // A film, its reference, and the film of a pass.
        recipe.job()?.check_memory(4)?;
        Ok::<Recipe, CliError>(recipe)
    };
    let scenes: Vec<Recipe> = if raw.scenes.is_empty() {
        defaults.scenes.iter().map(|name| sized(sources::carried(name))).collect::<Result<_, CliError>>()?
    } else {
        raw.scenes.iter().map(|name| sized(sources::scene(name))).collect::<Result<_, CliError>>()?
    };
    let twice = |(index, scene): &(usize, &Recipe)| scenes[..*index].iter().any(|s| s.name == scene.name);
    match scenes.iter().enumerate().find(twice) {
        Some((_, scene)) => Err(CliError::SameScene { name: scene.name.clone() }),
        None => Ok(scenes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};

    fn options(words: &str) -> ReportOptions {
        let line = format!("weekender report --out r {words}");
        match parse(line.split(' ').map(Into::into)).unwrap() {
            Request::Report(options) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_gpu_that_is_named_is_measured_even_if_there_is_none() {
        let names = |words: &str| {
            let backends = options(words).backends;
            assert!(backends.contains(&("gpu".to_owned(), ReportBackend::Renderer(gpu()))), "{backends:?}");
            backends.into_iter().map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(names("--adapter some"), ["cpu", "scalar", "gpu", "c89"]);
        assert_eq!(names("--adapter some --calibration"), ["cpu", "gpu"]);
        assert_eq!(names("--adapter some --backends portable,gpu"), ["portable", "gpu"]);
    }

    fn gpu() -> BackendChoice {
        BackendChoice::Gpu(GpuOptions::of_adapter(Some("some")))
    }

    #[test]
    fn an_adapter_needs_a_gpu_among_the_backends_or_as_the_reference() {
        let line = "weekender report --out r --backends portable --adapter some";
        let parsed = |line: &str| parse(line.split(' ').map(Into::into));
        let told = parsed(line).unwrap_err().to_string();
        assert!(told.contains("--adapter") && told.contains("gpu in --backends"), "{told}");
        let Request::Report(options) = parsed(&format!("{line} --reference-backend gpu")).unwrap() else {
            panic!("no report")
        };
        let name = "gpu".to_owned();
        assert_eq!(options.reference, ReferenceChoice::Make { name, choice: gpu(), samples: 4096 });
    }

    #[test]
    fn the_reference_has_several_times_the_samples_within_the_limit() {
        for (words, expected) in [
            ("--max-samples 64", 256),
            ("--max-samples 64 --calibration", 1024),
            ("--max-samples 4294967296", SAMPLE_LIMIT),
            ("--max-samples 64 --reference-samples 100", 100),
        ] {
            let found = options(&format!("--backends portable --scenes metals {words}")).reference;
            assert!(matches!(found, ReferenceChoice::Make { samples, .. } if samples == expected), "{words}");
        }
    }

    #[test]
    fn the_own_target_comes_first_and_only_once() {
        let targets = |words: &str| options(&format!("--backends portable --scenes metals {words}")).targets;
        assert_eq!(targets("--seeds 3"), [0.01, 0.001]);
        assert_eq!(targets("--target .02"), [0.02, 0.01, 0.001]);
        assert_eq!(targets("--target .001"), [0.001, 0.01]);
    }
}
