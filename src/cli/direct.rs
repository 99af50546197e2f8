//! Commands whose flags are their options: merge, info, gallery and companion.

use super::raw::ProgressChoice;
use super::values::parse_duration;
use crate::backends::BackendChoice;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Options of `weekender merge`.
#[derive(Clone, Debug, Args)]
pub struct MergeOptions {
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
    /// Interval at which --watch writes the picture so far: 0.1s to 30d
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", requires = "watch")]
    pub every: Duration,
    /// Write nothing; read everything, list what is missing, damaged, foreign or there twice, and print the commands
    /// for what is missing
    #[arg(long, conflicts_with_all = ["out", "watch"])]
    pub check: bool,
    /// How commands call this program.
    #[arg(skip)]
    pub program: String,
}

/// Options of `weekender info`.
#[derive(Clone, Debug, Args)]
pub struct InfoOptions {
    /// A film, picture, scene file or plan
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Print it as JSON
    #[arg(long)]
    pub json: bool,
}

/// Options of `weekender gallery`.
#[derive(Clone, Debug, Args)]
pub struct GalleryOptions {
    /// The directory for the pictures and their page, index.html
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,
    /// Small pictures with some noise, within a minute; finished full ones are kept
    #[arg(long)]
    pub quick: bool,
    /// Render only these figures or stages
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub backend: BackendChoice,
}

/// Options of `weekender companion`.
#[derive(Clone, Debug, Args)]
pub struct CompanionOptions {
    /// Write index.html and its figures to this directory
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,
    /// Show the figures of this benchmark, made by weekender bench --json, instead of those of the release machine
    #[arg(long, value_name = "FILE.json")]
    pub bench: Option<PathBuf>,
    /// Read texts and sources from this checkout instead of the copies in the program, to see a changed text at once
    #[arg(long, value_name = "DIRECTORY")]
    pub source: Option<PathBuf>,
    /// Small figures with some noise, within a minute; finished full ones are kept
    #[arg(long)]
    pub quick: bool,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub backend: BackendChoice,
}
