//! Errors on the command line.

use crate::files::ShownPath;
use crate::memory::MemoryError;
use crate::output::OutputError;
use crate::recipe::{SceneNameError, file};
use crate::render::JobError;
use crate::saved::OpenError;
use crate::stages::UnknownStage;
use std::path::{Path, PathBuf};

/// Why the flags cannot be carried out.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// There is no such scene.
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    /// There is no such stage.
    #[error(transparent)]
    StageName(#[from] UnknownStage),
    /// The scene file cannot be read.
    #[error(transparent)]
    SceneFile(#[from] file::FileError),
    /// The job is not valid.
    #[error(transparent)]
    Job(#[from] JobError),
    /// A picture or scene does not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The film cannot be resumed.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// The name of a picture has no known extension, or the picture cannot be read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The backend is not available.
    #[error(transparent)]
    Backend(#[from] crate::backends::BackendError),
    /// The name of a chart has no known extension.
    #[error(transparent)]
    Chart(#[from] crate::chart::ChartError),
    /// Two flags exclude each other.
    #[error("{flag} cannot be used with {other}: {reason}")]
    Together {
        /// The flag.
        flag: &'static str,
        /// The other flag, with its value if that matters.
        other: &'static str,
        /// The reason, and what to do.
        reason: &'static str,
    },
    /// A flag requires another.
    #[error("{flag} needs {other}: {reason}")]
    Needs {
        /// The flag.
        flag: &'static str,
        /// The missing flag.
        other: &'static str,
        /// The reason, and what to do.
        reason: &'static str,
    },
    /// The pixel is outside the picture.
    #[error("--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last one is {},{}", width - 1, height - 1)]
    Pixel {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// Width of the picture in pixels.
        width: u32,
        /// Height of the picture in pixels.
        height: u32,
    },
    /// There is no such backend.
    #[error("there is no backend {name:?}; choose among {choices}")]
    BackendName {
        /// The name as given.
        name: String,
        /// The names to choose from.
        choices: String,
    },
    /// Two outputs would be written to the same file.
    #[error("{first} and {second} are the same file, {}; give them different names", both(path, other))]
    SameFile {
        /// The first flag.
        first: &'static str,
        /// The second flag.
        second: &'static str,
        /// The file as the first flag names it.
        path: PathBuf,
        /// The same file as the second flag names it.
        other: PathBuf,
    },
    /// An output would replace an input.
    #[error("{output} {} would replace {}; give it another name", path.shown(), input_words(input))]
    Overwrites {
        /// The flag of the output.
        output: &'static str,
        /// The file.
        path: PathBuf,
        /// The flag of the input, or what it is, in words.
        input: &'static str,
    },
    /// The name of a file does not fit its kind.
    #[error("{flag} is {}, but the name of {what} must end in {ending}", path.shown())]
    Ending {
        /// The flag.
        flag: &'static str,
        /// The file.
        path: PathBuf,
        /// The kind of file.
        what: &'static str,
        /// The required extension, with the dot.
        ending: &'static str,
    },
    /// The camera of a frame is not valid.
    #[error("frame {frame}: {reason}")]
    Frame {
        /// The frame.
        frame: u32,
        /// What is wrong with its camera.
        reason: Box<JobError>,
    },
    /// An animation cannot be written there.
    #[error("--out is {}, {reason}", path.shown())]
    FramesOut {
        /// The path.
        path: PathBuf,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// There are more parts than samples or frames.
    #[error("--parts is {parts}, but there are {count} {what} to divide; each part needs one at least")]
    TooManyParts {
        /// The number of parts.
        parts: u64,
        /// The number of samples per pixel or of frames.
        count: u64,
        /// Which of the two.
        what: &'static str,
    },
    /// The directory's name cannot be part of a command.
    #[error("--out is {}, which cannot stand in a command: its name must be UTF-8 without control characters", path.shown())]
    PlanDirectory {
        /// The directory.
        path: PathBuf,
    },
    /// Slurm would take the directory's name for a pattern.
    #[error("--out is {}, but Slurm takes % and \\ in the path of a log for signs of its own, and no part would run; choose a directory whose whole path has neither", path.shown())]
    SlurmDirectory {
        /// The directory.
        path: PathBuf,
    },
    /// Words of the command line are not UTF-8, and at least one of them must be.
    #[error(
        "the command line has words that are not UTF-8, as the name of a scene, a choice or a number must be: {words}; rename the file, or make a link to it with another name"
    )]
    NotUtf8 {
        /// The words, with escaped bytes.
        words: String,
    },
    /// The variable that names the part has another value.
    #[error("{name} is {value:?}, but must be the number of a part; set it, or give --part NUMBER")]
    PartVariable {
        /// The variable of the environment.
        name: &'static str,
        /// Its value.
        value: String,
    },
    /// Two scenes have the same name, so the report could not tell them apart.
    #[error("--scenes has two scenes called {name}; leave one out or rename its file")]
    SameScene {
        /// The name.
        name: String,
    },
}

fn input_words(input: &str) -> String {
    if input.starts_with("--") { format!("the file that {input} reads") } else { input.to_owned() }
}

fn both(path: &Path, other: &Path) -> String {
    if path == other { path.shown() } else { format!("{} and {}", path.shown(), other.shown()) }
}
