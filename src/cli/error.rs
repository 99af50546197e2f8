//! Why flags cannot be carried out.

use crate::memory::MemoryError;
use crate::output::OutputError;
use crate::recipe::{SceneNameError, file};
use crate::render::JobError;
use crate::saved::OpenError;
use crate::stages::UnknownStage;
use std::path::{Path, PathBuf};

/// Flags that cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// No such scene.
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    /// No such stage.
    #[error(transparent)]
    StageName(#[from] UnknownStage),
    /// A scene file that cannot be read.
    #[error(transparent)]
    SceneFile(#[from] file::FileError),
    /// A value that no picture can be made with.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A picture or a scene that does not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// A film that cannot go on.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The file's name or what it says of itself.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// No such device here.
    #[error(transparent)]
    Backend(#[from] crate::backends::BackendError),
    /// A chart's name.
    #[error(transparent)]
    Chart(#[from] crate::chart::ChartError),
    /// Two flags that do not go together.
    #[error("{flag} cannot be used with {other}: {reason}")]
    Together {
        /// A flag.
        flag: &'static str,
        /// Another, with its value if that matters.
        other: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A flag that needs another.
    #[error("{flag} needs {other}: {reason}")]
    Needs {
        /// A flag.
        flag: &'static str,
        /// What is missing.
        other: &'static str,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// A pixel beside the picture.
    #[error("--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last is {},{}", width - 1, height - 1)]
    Pixel {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// No such backend.
    #[error("there is no backend {name:?}; choose among {choices}")]
    BackendName {
        /// What was asked for.
        name: String,
        /// What there is.
        choices: String,
    },
    /// Two outputs in one file.
    #[error("{first} and {second} are one file, {}; give them different names", both(path, other))]
    SameFile {
        /// A flag.
        first: &'static str,
        /// Another.
        second: &'static str,
        /// The first's file.
        path: PathBuf,
        /// The same file as the other names it.
        other: PathBuf,
    },
    /// An output in the place of an input.
    #[error("{output} {} would replace the file that {input} reads; give it another name", path.display())]
    Overwrites {
        /// The output's flag.
        output: &'static str,
        /// Its file.
        path: PathBuf,
        /// The input's flag.
        input: &'static str,
    },
    /// A file whose name says that it is something else.
    #[error("{flag} is {}, but the name of {what} must end in {ending}", path.display())]
    Ending {
        /// The flag.
        flag: &'static str,
        /// The file.
        path: PathBuf,
        /// What the file is.
        what: &'static str,
        /// What its name must end in, with the dot.
        ending: &'static str,
    },
    /// Two scenes of one name, which the report could not tell apart.
    #[error("--scenes has two of the name {name}; leave one out, or give its file another name")]
    SameScene {
        /// Their name.
        name: String,
    },
}

fn both(path: &Path, other: &Path) -> String {
    if path == other {
        path.display().to_string()
    } else {
        format!("{} and {}", path.display(), other.display())
    }
}
