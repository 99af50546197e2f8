//! What can be wrong with a scene file, with the line where it is.

use super::place::Step;
use crate::files::InputError;
use crate::memory::MemoryError;
use crate::recipe::{SamplesError, SceneNameError};
use crate::render::JobError;
use thiserror::Error;

/// Why a scene file cannot be used. The message names the file and the line, and says what to do.
#[derive(Debug, Error)]
pub enum FileError {
    /// The file cannot be read, or it is too long for a scene file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// There is not enough memory to read the file.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The file is not UTF-8 text.
    #[error("{name}:{line}: this is not UTF-8 text, but a scene file must be; {remedy}")]
    NotText {
        /// The file.
        name: String,
        /// Line of the first byte that is not UTF-8, from 1.
        line: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// The file is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{name}:{line}:{column}: {message}")]
    Malformed {
        /// The file.
        name: String,
        /// From 1.
        line: usize,
        /// In characters, from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// The file is well-formed, but no picture can be made from it.
    #[error("{name}:{line}:{column}: {reason}")]
    Refused {
        /// The file.
        name: String,
        /// From 1.
        line: usize,
        /// In characters, from 1.
        column: usize,
        /// What is wrong.
        reason: Reason,
    },
}

/// Why a well-formed file was refused.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum Reason {
    /// A value is out of range.
    #[error(transparent)]
    Job(#[from] JobError),
    /// The number of samples per pixel is out of range.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// There is no built-in scene of this name.
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    /// The file names a built-in scene and also has a part of a scene.
    #[error("{part} cannot be combined with scene, which has its own; remove one of them")]
    BesideScene {
        /// The part.
        part: &'static str,
    },
    /// The built-in scene has changed since the file was made.
    #[error(
        "the built-in scene {name:?} has changed since this file was made; use the version that made it, or remove scene_mark to take the present scene"
    )]
    OtherScene {
        /// The scene's name.
        name: String,
    },
    /// A number is not whole or out of range.
    #[error(
        "{what} is {value}, but must be {}within {lowest} and {highest}; {remedy}",
        if *is_whole { "" } else { "a whole number " }
    )]
    Whole {
        /// The key.
        what: &'static str,
        /// The value, as it is written or with the same meaning.
        value: Box<str>,
        /// Whether the value is a whole number.
        is_whole: bool,
        /// The smallest allowed value.
        lowest: u64,
        /// The largest allowed value.
        highest: u64,
        /// What to do.
        remedy: &'static str,
    },
    /// The frame numbers of keyframes do not rise.
    #[error(
        "frame is {frame}, but the keyframe before it has {before}; list keyframes by rising frame number, each number once"
    )]
    FrameOrder {
        /// The keyframe's number.
        frame: u32,
        /// The number of the keyframe before it.
        before: u32,
    },
    /// There is no such kind of material.
    #[error("{what}.kind is {kind:?}, but must be \"lambertian\", \"metal\" or \"dielectric\"")]
    UnknownKind {
        /// The material.
        what: String,
        /// The value.
        kind: String,
    },
    /// A material lacks a key that its kind needs.
    #[error("{what} is {kind} and needs the key {key:?}, such as {example}")]
    MissingKey {
        /// The material.
        what: String,
        /// Its kind.
        kind: &'static str,
        /// The missing key.
        key: &'static str,
        /// A line that has the key.
        example: &'static str,
    },
    /// A material has a key that its kind does not have.
    #[error("{what}.{key} has no meaning for {kind}, which has only {keys}; remove it or change the kind")]
    ForeignKey {
        /// The material.
        what: String,
        /// Its kind.
        kind: &'static str,
        /// The key.
        key: &'static str,
        /// The keys that the kind has.
        keys: &'static str,
    },
}

/// Why a recipe was refused, and the path to the value in the file.
pub(super) struct Refusal {
    pub path: Vec<Step>,
    pub reason: Reason,
}

/// A refusal of the value at `path`.
pub(super) fn refuse(path: &[&str], reason: impl Into<Reason>) -> Refusal {
    Refusal { path: path.iter().map(|key| Step::Key((*key).to_owned())).collect(), reason: reason.into() }
}
