//! What the window adds to the description of what it saves by itself.

use crate::app::model::{Document, Origin, Source};
use crate::job::recipe::file;
use crate::progressive::Stop;
use crate::stages::Stage;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Where a picture comes from, and what the user has chosen besides its recipe.
#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Note {
    stage: Option<String>,
    file: Option<String>,
    /// Samples, seconds, error.
    stop: (Option<u64>, Option<f64>, Option<f64>),
    has_own_size: bool,
    is_from_file: bool,
}

impl Note {
    pub fn of(document: &Document) -> Self {
        let file = match &document.origin.source {
            Source::File(path) => path.to_str().map(str::to_owned),
            _ => None,
        };
        let Stop { samples, seconds, noise, .. } = document.stop;
        Note {
            stage: document.stage().map(|stage| stage.id.to_owned()),
            file,
            stop: (samples, seconds, noise),
            has_own_size: document.has_own_size,
            is_from_file: document.is_from_file,
        }
    }

    /// Whether a stage or a file has the origin's recipe.
    pub fn has_origin(&self) -> bool {
        self.stage.is_some() || self.file.is_some()
    }

    pub fn has_same_origin(&self, other: &Note) -> bool {
        (&self.stage, &self.file) == (&other.stage, &other.file)
    }

    pub fn origin(&self) -> Option<Origin> {
        match (&self.stage, &self.file) {
            (Some(id), _) => Stage::find(id).ok().map(Origin::of_stage),
            (None, Some(path)) => {
                let path = PathBuf::from(path);
                file::load(&path).ok().map(|recipe| Origin::new(recipe, Source::File(path)))
            }
            (None, None) => None,
        }
    }

    /// Gives the document what the user had chosen.
    pub fn restore(&self, document: &mut Document) {
        (document.has_own_size, document.is_from_file) = (self.has_own_size, self.is_from_file);
        let (samples, seconds, noise) = self.stop;
        document.stop = Stop { samples, seconds, noise, ..Stop::default() };
    }
}
