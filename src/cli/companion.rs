//! The flags of `weekender companion` and their validation.

use super::backend::choose;
use super::error::CliError;
use super::paths::Paths;
use super::raw::{ProgressChoice, RawDevice};
use crate::backends::BackendChoice;
use crate::render_cpu::CpuOptions;
use crate::render_gpu::GpuOptions;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawCompanion {
    /// Write index.html and its figures to this directory
    #[arg(long, value_name = "DIRECTORY", help_heading = "Files")]
    pub out: PathBuf,
    /// Show the figures of this benchmark, made by weekender bench --json, instead of those of the release machine
    #[arg(long, value_name = "FILE.json", help_heading = "Files")]
    pub bench: Option<PathBuf>,
    /// Read texts and sources from this checkout instead of the copies in the program, to see a changed text at once
    #[arg(long, value_name = "DIRECTORY", help_heading = "Files")]
    pub source: Option<PathBuf>,

    /// Small figures with some noise, within a minute; finished full ones are kept
    #[arg(long, help_heading = "Figures")]
    pub quick: bool,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Options of `weekender companion`.
#[derive(Clone, Debug)]
pub struct CompanionOptions {
    /// Directory of the page.
    pub out: PathBuf,
    /// The JSON of a benchmark.
    pub bench: Option<PathBuf>,
    /// A checkout whose texts are used.
    pub source: Option<PathBuf>,
    /// Whether figures are small and have few samples.
    pub quick: bool,
    /// What renders the figures.
    pub backend: BackendChoice,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
}

/// Validates the flags of `weekender companion`.
pub(super) fn companion(raw: RawCompanion) -> Result<CompanionOptions, CliError> {
    Paths::default()
        .read("--bench", raw.bench.as_deref())
        .write("the page of --out,", Some(&raw.out.join("index.html")))
        .own("a figure of --out,", &raw.out.join("figures"), |name| {
            let folded = name.to_lowercase();
            (folded.ends_with(".png") || folded == "gallery.json").then(|| name.to_owned())
        })
        .check(&[])?;
    let RawCompanion { out, bench, source, quick, progress } = raw;
    let backend = choose(RawDevice::Auto, CpuOptions::default(), GpuOptions::of_adapter(None), [None, None])?;
    Ok(CompanionOptions { out, bench, source, quick, backend, progress })
}
