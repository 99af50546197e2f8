//! The flags of `weekender stress` and their validation.

use super::error::CliError;
use super::paths::Paths;
use super::raw::ProgressChoice;
use super::values::{JsonTarget, Levels, parse_levels, parse_seconds, whole};
use crate::backends::BackendError;
use crate::render_cpu::{CpuError, Isa};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct RawStress {
    /// Run only cases whose id contains this, such as copies or moved/1e5
    #[arg(long, value_name = "TEXT", help_heading = "Cases")]
    pub filter: Option<String>,
    /// Afterwards, try random scenes for this many seconds; failing ones are shrunk and saved as scene files
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, help_heading = "Cases")]
    pub search: Option<f64>,
    /// Seed of the random scenes, 0 to 4294967295
    #[arg(long, value_name = "NUMBER", value_parser = whole(0..=u32::MAX, 7), default_value = "0",
          allow_hyphen_values = true, requires = "search", help_heading = "Cases")]
    pub seed: u32,

    /// Instruction levels, separated by commas; auto: the best that fuses multiply and add and the best that does not,
    /// all: all that this processor has
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto",
          help_heading = "Backends")]
    pub isa: Levels,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter [default: the
    /// best one, if there is one]
    #[arg(long, value_name = "SUBSTRING", help_heading = "Backends")]
    pub adapter: Option<String>,

    /// Write all figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", help_heading = "Files")]
    pub json: Option<PathBuf>,
    /// Write pictures, the table as Markdown and an HTML page to this directory; failing scenes of a search are saved
    /// there, too [default for these: stress]
    #[arg(long, value_name = "DIRECTORY", help_heading = "Files")]
    pub out: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Options of `weekender stress`.
#[derive(Clone, Debug)]
pub struct StressOptions {
    /// Text that the id of a case must contain.
    pub filter: String,
    /// Duration of the search among random scenes.
    pub search: Option<Duration>,
    /// Seed of the random scenes.
    pub seed: u32,
    /// Instruction levels of the CPU.
    pub levels: Vec<Isa>,
    /// The GPU that was named.
    pub adapter: Option<String>,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
    /// Directory for pictures and tables.
    pub out: Option<PathBuf>,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
}

/// Validates the flags of `weekender stress`.
pub(super) fn stress(raw: RawStress) -> Result<StressOptions, CliError> {
    let available = Isa::available();
    let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
    let levels = match raw.isa {
        Levels::Auto => best(true).into_iter().chain(best(false)).collect(),
        Levels::All => available.iter().rev().copied().collect(),
        Levels::Named(levels) => levels,
    };
    if let Some(isa) = levels.iter().copied().find(|isa| !available.contains(isa)) {
        return Err(BackendError::Cpu(CpuError::Isa { isa, available }).into());
    }
    let json = raw.json.map(JsonTarget::from);
    let pages = raw.out.iter().flat_map(|out| ["table.md", "index.html"].map(|name| out.join(name)));
    pages
        .fold(Paths::default(), |paths, page| paths.write("a file of --out,", Some(&page)))
        .write_json(json.as_ref())
        .check(&[])?;
    Ok(StressOptions {
        filter: raw.filter.unwrap_or_default(),
        search: raw.search.map(Duration::from_secs_f64),
        seed: raw.seed,
        levels,
        adapter: raw.adapter,
        json,
        out: raw.out,
        progress: raw.progress,
    })
}
