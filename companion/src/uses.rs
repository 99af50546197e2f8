//! References that the texts have made so far.

use crate::picture::Picture;
use std::collections::{BTreeMap, BTreeSet};

/// References that the texts have made so far.
#[derive(Debug, Default)]
pub struct Uses {
    /// Keys of linked terms, each with the short title of the first chapter that links it.
    pub terms: BTreeMap<String, String>,
    /// The page's own pictures.
    pub pictures: Vec<Picture>,
    /// How many figures have a number so far.
    pub numbered_figures: usize,
    /// Stages that are shown, each with an anchor at the first place.
    pub stages: BTreeSet<&'static str>,
    /// Code in the text of the section, with its lines.
    pub names: Vec<(String, usize)>,
    /// The words of the excerpts that are open in the section.
    pub words: BTreeSet<String>,
}

impl Uses {
    /// Adds a picture, once.
    pub fn add(&mut self, picture: Picture) {
        if self.pictures.iter().all(|other| other.file() != picture.file()) {
            self.pictures.push(picture);
        }
    }
}
