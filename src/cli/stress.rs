//! The flags of `weekender stress`.

use super::error::CliError;
use super::paths::Paths;
use super::raw::ProgressChoice;
use super::values::{JsonTarget, Levels, parse_levels};
use crate::render_cpu::Isa;
use clap::Args;
use std::path::PathBuf;

/// Options of `weekender stress`.
#[derive(Debug, Args)]
pub struct StressOptions {
    /// Run only cases whose id contains this, such as copies or moved/1e5
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true, help_heading = "Cases")]
    pub filter: String,

    /// Instruction levels, separated by commas; auto: the best that fuses multiply and add and the best that does not,
    /// all: all that this processor has
    #[arg(long, value_name = "LEVEL,...", value_parser = parse_levels, default_value = "auto",
          help_heading = "Backends")]
    isa: Levels,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter [default: the
    /// best one, if there is one]
    #[arg(long, value_name = "SUBSTRING", help_heading = "Backends")]
    pub adapter: Option<String>,

    /// Write all figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", help_heading = "Files")]
    json: Option<PathBuf>,
    /// Write pictures and the table as Markdown to this directory
    #[arg(long, value_name = "DIRECTORY", help_heading = "Files")]
    pub out: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

impl StressOptions {
    /// Returns an error if the files conflict.
    pub(super) fn check(self) -> Result<Self, CliError> {
        self.levels()?;
        let table = self.out.as_ref().map(|out| out.join("table.md"));
        Paths::default()
            .write("a file of --out,", table.as_deref())
            .write_json(self.json().as_ref())
            .check(&[])?;
        Ok(self)
    }

    /// Instruction levels of the CPU.
    ///
    /// # Errors
    /// If the processor lacks one.
    pub fn levels(&self) -> Result<Vec<Isa>, CliError> {
        self.isa.available(|available| {
            let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
            best(true).into_iter().chain(best(false)).collect()
        })
    }

    pub fn json(&self) -> Option<JsonTarget> {
        self.json.clone().map(JsonTarget::from)
    }
}
