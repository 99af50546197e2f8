//! References that the texts have made so far.

use crate::picture::Picture;
use std::collections::{BTreeMap, BTreeSet};

/// The references that the texts have made so far.
#[derive(Debug, Default)]
pub struct Uses {
    /// Keys of linked terms, each with the short title of the first chapter that links it.
    pub terms: BTreeMap<String, String>,
    /// The page's own pictures.
    pub pictures: Vec<Picture>,
    /// How many figures have a number so far.
    pub numbered_figures: usize,
    /// Anchors of headings and figures, which must be unique.
    pub anchors: BTreeSet<String>,
    /// Linked anchors, each with file and line.
    pub targets: Vec<(String, String, usize)>,
}
