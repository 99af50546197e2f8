//! Everything that the texts of the page can refer to, and what they did refer to.

use super::book::{self, Book};
use super::chapter::Chapter;
use super::excerpt::{self, Excerpt};
use super::fault::Fault;
use super::formula::Formulas;
use super::highlight::Highlighter;
use super::library::{Entry, Library};
use super::measured::Measured;
use super::reference::{GLOSSARY, REFERENCES, Reference, Term};
use crate::page::gallery::Figure;
use anyhow::Result;
use std::collections::{BTreeMap, BTreeSet};

/// What texts can refer to.
pub struct Site {
    /// Where diagrams are read from.
    pub library: Library,
    pub book: Book,
    pub chapters: Vec<Chapter>,
    /// All excerpts by name.
    pub excerpts: BTreeMap<String, Excerpt>,
    /// The glossary in alphabetical order.
    pub terms: Vec<Entry<Term>>,
    /// The references in the order of the file.
    pub references: Vec<Entry<Reference>>,
    /// What tables and charts are made of.
    pub measured: Measured,
    pub highlighter: Highlighter,
    pub formulas: Formulas,
}

/// What the texts have referred to so far.
#[derive(Debug, Default)]
pub struct Uses {
    /// Keys of linked terms, each with the short title of the first chapter that links it.
    pub terms: BTreeMap<String, String>,
    /// Names of shown excerpts.
    pub excerpts: BTreeSet<String>,
    /// Figures in the order of the page.
    pub figures: Vec<&'static Figure>,
    /// Anchors that exist.
    pub anchors: BTreeSet<String>,
    /// Anchors that are linked, each with file and line.
    pub targets: Vec<(String, String, usize)>,
}

impl Site {
    /// Reads everything from the library.
    ///
    /// # Errors
    /// The first [`Fault`] of the texts, or what is wrong with a part of the program itself.
    pub fn read(library: &Library) -> Result<Self> {
        let mut terms: Vec<Entry<Term>> = library.entries(GLOSSARY)?;
        terms.sort_by_key(|entry| entry.value.term.to_lowercase());
        Ok(Site {
            library: library.clone(),
            book: library.toml(book::FILE)?,
            chapters: Chapter::read_all(library)?,
            excerpts: excerpt::read_all(library)?,
            terms,
            references: library.entries(REFERENCES)?,
            measured: Measured::read(library)?,
            highlighter: Highlighter::new()?,
            formulas: Formulas::new()?,
        })
    }

    /// The number and the entry of a reference.
    pub fn reference(&self, key: &str) -> Option<(usize, &Entry<Reference>)> {
        (1..).zip(&self.references).find(|(_, entry)| entry.key == key)
    }

    /// Looks for what nothing refers to, and for links to nothing: faults that show only after all texts were read.
    pub fn check(&self, uses: &Uses) -> Result<(), Fault> {
        if let Some(Entry { key, line, .. }) =
            self.terms.iter().find(|entry| !uses.terms.contains_key(&entry.key))
        {
            let message =
                format!("no chapter links the term {key:?}; link it as [text](glossary:{key}), or remove it");
            return Err(Fault::new(GLOSSARY, *line, message));
        }
        if let Some(name) = self.excerpts.keys().find(|name| !uses.excerpts.contains(*name)) {
            let message =
                format!("no chapter shows the excerpt {name:?}; add {{{{excerpt {name}}}}}, or remove it");
            return Err(Fault::new(excerpt::FILE, 0, message));
        }
        match uses.targets.iter().find(|(anchor, ..)| !uses.anchors.contains(anchor)) {
            Some((anchor, file, line)) => {
                Err(Fault::new(file, *line, format!("nothing on the page has the anchor #{anchor}")))
            }
            None => Ok(()),
        }
    }
}
