//! Everything that the page's texts can refer to.

use crate::back_matter::{GLOSSARY, REFERENCES, Reference, Term};
use crate::chapter::Chapter;
use crate::highlight::Highlighter;
use crate::letters::{self, Letters};
use crate::library::{Entry, Library};
use crate::measured::Measured;
use anyhow::{Result, anyhow};
use math_core::{LatexToMathML, MathCoreConfig};

/// The targets available to texts.
pub struct Site {
    /// Where diagrams are read from.
    pub library: Library,
    pub chapters: Vec<Chapter>,
    /// The letters of formulas.
    pub letters: Letters,
    /// In alphabetical order.
    pub terms: Vec<Entry<Term>>,
    /// In file order.
    pub references: Vec<Entry<Reference>>,
    /// The data of tables and charts.
    pub measured: Measured,
    pub highlighter: Highlighter,
    /// Makes MathML, so that readers need neither scripts nor the network.
    pub formulas: LatexToMathML,
}

impl Site {
    /// Reads everything from the library. Fails with the first fault of the texts, or with an error in an embedded
    /// part.
    pub fn read(library: &Library) -> Result<Self> {
        let mut terms: Vec<Entry<Term>> = library.entries(GLOSSARY)?;
        terms.sort_by_key(|entry| entry.value.term.to_lowercase());
        Ok(Site {
            library: library.clone(),
            chapters: Chapter::read_all(library)?,
            letters: library.toml(letters::FILE)?,
            terms,
            references: library.entries(REFERENCES)?,
            measured: Measured::read(library)?,
            highlighter: Highlighter::new()?,
            formulas: LatexToMathML::new(MathCoreConfig::default())
                .map_err(|error| anyhow!("cannot convert formulas: {error:?}"))?,
        })
    }
}
