//! What can be wrong with a scene file, with the line where it is.

use crate::files::InputError;
use crate::memory::MemoryError;
use crate::recipe::{SamplesError, SceneNameError};
use crate::render::JobError;
use std::ops::Range;
use thiserror::Error;
use toml::de::{DeTable, DeValue};

/// A scene file that cannot be used. The message names the file, the line and what to do.
#[derive(Debug, Error)]
pub enum FileError {
    /// The system would not hand it over, or it is no scene file.
    #[error(transparent)]
    Input(#[from] InputError),
    /// There is no memory to read it.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// Not UTF-8.
    #[error(
        "{name}:{line}: this is no text in UTF-8, as a scene file must be; save it as such, or give a .toml file"
    )]
    NotText {
        /// The file.
        name: String,
        /// Line of the first byte that is no text, from 1.
        line: usize,
    },
    /// No TOML, or keys that are unknown, missing or of another type.
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
    /// Well written, but no picture can be made of it.
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
    /// A value out of its range.
    #[error(transparent)]
    Job(#[from] JobError),
    /// Samples per pixel.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// A built-in scene that there is not.
    #[error(transparent)]
    SceneName(#[from] SceneNameError),
    /// A part of a scene beside the name of a built-in one.
    #[error("{part} cannot stand beside scene, which has its own; remove one of them")]
    BesideScene {
        /// The part.
        part: &'static str,
    },
    /// A built-in scene that was another when the file was made.
    #[error(
        "the built-in scene {name:?} of this version is another than the one that this was made with; use that version, or remove scene_mark to take this one's"
    )]
    OtherScene {
        /// Its name.
        name: String,
    },
    /// A whole number out of its range.
    #[error("{what} is {value}, but must be within {lowest} and {highest}; {remedy}")]
    Whole {
        /// Where it stands.
        what: &'static str,
        /// The value.
        value: i64,
        /// The least it may be.
        lowest: u64,
        /// The most it may be.
        highest: u64,
        /// What to do.
        remedy: &'static str,
    },
    /// A kind of material that there is not.
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
        /// What is missing.
        key: &'static str,
        /// A line that would do.
        example: &'static str,
    },
    /// A material has a key that means nothing to its kind.
    #[error("{what}.{key} means nothing to {kind}, which has only {keys}; remove it or change the kind")]
    ForeignKey {
        /// The material.
        what: String,
        /// Its kind.
        kind: &'static str,
        /// The key.
        key: &'static str,
        /// What the kind has.
        keys: &'static str,
    },
}

/// Line and column, both from 1, of a byte. Columns count characters.
pub(super) fn line_and_column(text: &str, byte: usize) -> (usize, usize) {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
}

/// One step from a table or array to something in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

/// Where in the text a value stands, or else the innermost of what surrounds it.
///
/// The text is parsed once more for this, so that reading without errors need not keep places.
pub(super) fn find_place(text: &str, path: &[Step]) -> Range<usize> {
    let Ok(document) = DeTable::parse(text) else { return 0..0 };
    let mut place = 0..0;
    let Some((Step::Key(first), rest)) = path.split_first() else { return place };
    let Some((key, value)) = document.get_ref().get_key_value(first.as_str()) else { return place };
    place = narrower(key.span(), value.span());
    let mut value = value.get_ref();
    for step in rest {
        match (step, value) {
            (Step::Key(name), DeValue::Table(table)) => {
                let Some((key, inner)) = table.get_key_value(name.as_str()) else { return place };
                place = narrower(key.span(), inner.span());
                value = inner.get_ref();
            }
            (Step::Index(index), DeValue::Array(array)) => {
                let Some(inner) = array.get(*index) else { return place };
                place = inner.span();
                value = inner.get_ref();
            }
            _ => return place,
        }
    }
    place
}

/// The key's place: a reader looks for the key. But the parts of a table written as `[a.b]` have no key of
/// their own on that line.
fn narrower(key: Range<usize>, value: Range<usize>) -> Range<usize> {
    if key.is_empty() { value } else { key }
}
