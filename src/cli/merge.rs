//! Flags of `weekender merge` and `weekender info`.

use super::error::CliError;
use super::paths::Paths;
use super::plan;
use super::values::parse_duration;
use crate::output::OutputFormat;
use crate::plan::AnyPlan;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Interval at which `--watch` writes the picture by default.
const WATCH_INTERVAL: Duration = Duration::from_secs(60);

#[derive(Debug, Args)]
pub(super) struct RawMerge {
    /// Film files (.exr), as --checkpoint, --out and merge write them, or one plan: its directory, or its plan.json
    #[arg(required = true, num_args = 1.., value_name = "FILM|PLAN")]
    pub films: Vec<PathBuf>,
    /// Where the result is written: .exr for the film, .png or .ppm for the picture; .png for an animation; may be
    /// repeated
    #[arg(long, value_name = "FILE", required_unless_present = "check")]
    pub out: Vec<PathBuf>,
    /// Merge the parts of a plan as they come, and write the picture so far, until the plan is complete or Ctrl-C; an
    /// animation is written once it is complete
    #[arg(long)]
    pub watch: bool,
    /// Interval at which --watch writes the picture so far: 0.1s to 30d [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, allow_hyphen_values = true,
          requires = "watch")]
    pub every: Option<Duration>,
    /// Write nothing; read everything, list what is missing, damaged, foreign or there twice, and print the commands
    /// for what is missing
    #[arg(long, conflicts_with_all = ["out", "watch"])]
    pub check: bool,
}

#[derive(Debug, Args)]
pub(super) struct RawInfo {
    /// A film, picture, scene file or plan
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

/// What `weekender merge` reads.
#[derive(Clone, Debug)]
pub enum MergeSource {
    /// These films.
    Films(Vec<PathBuf>),
    /// The parts of a plan: its manifest, or the directory.
    Plan(PathBuf),
}

/// Options of `weekender merge`.
#[derive(Clone, Debug)]
pub struct MergeOptions {
    /// What is merged.
    pub source: MergeSource,
    /// Where the result is written.
    pub out: Vec<PathBuf>,
    /// The interval at which the picture so far is written, if parts are awaited.
    pub watch: Option<Duration>,
    /// Whether films are only checked.
    pub check: bool,
    /// How commands call this program.
    pub program: String,
}

/// Options of `weekender info`.
#[derive(Clone, Debug)]
pub struct InfoOptions {
    /// The file.
    pub file: PathBuf,
    /// Whether JSON is printed.
    pub json: bool,
}

pub(super) fn merge(raw: RawMerge, program: &str) -> Result<MergeOptions, CliError> {
    let source = match raw.films.as_slice() {
        [plan] if AnyPlan::is_at(plan) || plan.is_dir() => MergeSource::Plan(plan.clone()),
        films => MergeSource::Films(films.to_vec()),
    };
    if let MergeSource::Films(films) = &source {
        if raw.watch {
            let reason = "only a plan says which parts are to come; make one with `weekender plan`";
            return Err(CliError::Needs { flag: "--watch", other: "a plan", reason });
        }
        if films.iter().any(|film| AnyPlan::is_at(film)) {
            let reason =
                "a plan names its parts itself; merge it alone, then merge the result with the films";
            return Err(CliError::Together { flag: "a plan", other: "other files", reason });
        }
    }
    for out in &raw.out {
        OutputFormat::from_path(out)?;
    }
    let films = if let MergeSource::Films(films) = &source { films.as_slice() } else { &[] };
    let paths = films
        .iter()
        .fold(Paths::default(), |paths, film| paths.read("one of the films to merge", Some(film)));
    let paths = match &source {
        MergeSource::Plan(plan) if !raw.check => plan::files_of(paths, plan, false),
        _ => paths,
    };
    raw.out.iter().fold(paths, |paths, out| paths.write("--out", Some(out))).check(&[])?;
    let watch = raw.watch.then(|| raw.every.unwrap_or(WATCH_INTERVAL));
    Ok(MergeOptions { source, out: raw.out, watch, check: raw.check, program: program.to_owned() })
}

pub(super) fn info(raw: RawInfo) -> InfoOptions {
    InfoOptions { file: raw.file, json: raw.json }
}
