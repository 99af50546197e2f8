//! Why a plan cannot be used.

use super::MANIFEST;
use crate::files::{InputError, ShownPath, WriteError};
use crate::film::SOFTWARE;
use crate::film::checkpoint::SAMPLE_VERSION;
use crate::recipe::file;
use crate::render::JobError;
use std::path::PathBuf;

/// Why a plan cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The manifest or its scene cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The scene file cannot be read.
    #[error(transparent)]
    Scene(#[from] file::FileError),
    /// The scene cannot be rendered.
    #[error(transparent)]
    Job(#[from] JobError),
    /// The manifest is not one.
    #[error("{} is not a plan, or is damaged: {what}; check that it is the right file; if so, move it away and make the plan again with `weekender plan`", path.shown())]
    Damaged {
        /// The manifest.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The directory has no manifest.
    #[error("{} is a directory without a {MANIFEST}; a plan's directory or a file is needed", path.shown())]
    NoManifest {
        /// The directory.
        path: PathBuf,
    },
    /// The scene file is not the one that was planned.
    #[error(
        "{} was changed since {} was made; undo the change or make the same plan again, or plan the changed scene into another directory",
        scene.shown(), path.shown()
    )]
    SceneChanged {
        /// The scene file.
        scene: PathBuf,
        /// The manifest.
        path: PathBuf,
    },
    /// The plan is for another version of the program.
    #[error(
        "{} is a plan for samples of version {version}, made by {program}, but this program ({}) traces version {SAMPLE_VERSION}; use {program} on every machine, or plan into another directory with this one",
        path.shown(), SOFTWARE
    )]
    SampleVersion {
        /// The manifest.
        path: PathBuf,
        /// The version of the samples.
        version: u32,
        /// The program that made the plan.
        program: String,
    },
    /// The directory holds another plan.
    #[error(
        "{} holds the plan of another picture, or of other parts; plan into another directory, or delete it",
        path.shown()
    )]
    Taken {
        /// The manifest that is there.
        path: PathBuf,
    },
    /// A file that is not of the plan has the name of one that would be written.
    #[error(
        "{} is in the way: the plan would replace it; move it away, or plan into another directory",
        path.shown()
    )]
    InTheWay {
        /// The file that is there.
        path: PathBuf,
    },
    /// There is no such part.
    #[error("there is no part {index} in {}: it has the parts 0 to {}", path.shown(), count - 1)]
    NoPart {
        /// The manifest.
        path: PathBuf,
        /// The number that was given.
        index: u64,
        /// The number of parts.
        count: usize,
    },
}
