//! Errors on the command line.

use crate::job::recipe::{SceneNameError, file};
use crate::job::render::JobError;

/// Why the flags cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    #[error(transparent)]
    StageName(#[from] crate::stages::UnknownStage),
    #[error(transparent)]
    SceneFile(#[from] file::FileError),
    #[error(transparent)]
    Job(#[from] JobError),
    #[error(transparent)]
    Memory(#[from] crate::system::memory::MemoryError),
    #[error(transparent)]
    Open(#[from] crate::job::saved::OpenError),
    #[error(transparent)]
    Output(#[from] crate::job::output::OutputError),
    #[error(transparent)]
    Backend(#[from] crate::backends::BackendError),
    #[error(transparent)]
    Chart(#[from] crate::numbers::chart::ChartError),
    /// Two flags exclude each other.
    #[error("{flag} cannot be used with {other}: {reason}")]
    Together { flag: &'static str, other: &'static str, reason: &'static str },
    /// A flag requires another.
    #[error("{flag} needs {other}: {reason}")]
    Needs { flag: &'static str, other: &'static str, reason: &'static str },
    /// The pixel is outside the picture.
    #[error("--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last one is {},{}", width - 1, height - 1)]
    Pixel { x: u32, y: u32, width: u32, height: u32 },
    /// There is no such backend.
    #[error("there is no backend {name:?}; choose among {choices}")]
    BackendName { name: String, choices: String },
    /// A file would be replaced or cannot be what it is named for, or another value is out of range: what is wrong, and
    /// what to do.
    #[error("{0}")]
    Refused(String),
    /// Two scenes have the same name, so the report could not tell them apart.
    #[error("--scenes has two scenes called {name}; leave one out or rename its file")]
    SameScene { name: String },
}
