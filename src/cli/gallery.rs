//! The flags of `weekender gallery` and their validation.

use super::backend::choose;
use super::error::CliError;
use super::raw::{ProgressChoice, RawDevice};
use super::values::whole;
use crate::backends::BackendChoice;
use crate::render_cpu::CpuOptions;
use crate::render_gpu::GpuOptions;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct RawGallery {
    /// The directory for the pictures and their page, index.html
    #[arg(long, value_name = "DIRECTORY")]
    pub out: PathBuf,
    /// Small pictures with some noise, within a minute; finished full ones are kept
    #[arg(long)]
    pub quick: bool,
    /// Render only these figures or stages
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub only: Vec<String>,

    /// What renders; auto: the fastest available; cpu,gpu: both at once
    #[arg(long, value_enum, default_value = "auto", help_heading = "Device")]
    pub device: RawDevice,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Device")]
    pub adapter: Option<String>,
    /// CPU threads, 1 to 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1024_u64, 8),
          allow_hyphen_values = true, help_heading = "Device")]
    pub threads: Option<u64>,

    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// Options of `weekender gallery`.
#[derive(Clone, Debug)]
pub struct GalleryOptions {
    /// The directory for the pictures and their page.
    pub out: PathBuf,
    /// Whether the pictures are small and have few samples.
    pub quick: bool,
    /// Ids of figures or stages, not checked yet; empty for all.
    pub only: Vec<String>,
    /// The backend.
    pub backend: BackendChoice,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
}

/// Validates the flags of `weekender gallery`.
pub(super) fn gallery(raw: RawGallery) -> Result<GalleryOptions, CliError> {
    let threads = raw.threads.and_then(|threads| usize::try_from(threads).ok());
    let cpu = CpuOptions { threads, ..CpuOptions::default() };
    let gpu = GpuOptions::of_adapter(raw.adapter.as_deref());
    let gpu_flag = raw.adapter.as_ref().map(|_| "--adapter");
    Ok(GalleryOptions {
        backend: choose(raw.device, cpu, gpu, [None, gpu_flag])?,
        out: raw.out,
        quick: raw.quick,
        only: raw.only,
        progress: raw.progress,
    })
}
