//! Everything that the texts of the page can refer to, and what they did refer to.

use super::book::Book;
use super::chapter::Chapter;
use super::excerpt::{self, Excerpt};
use super::faults::Fault;
use super::formula::Formulas;
use super::highlight::Highlighter;
use super::library::Library;
use super::measured::Measured;
use super::reference::{self, Entry, GLOSSARY, REFERENCES, Reference, Term};
use crate::gallery::Figure;
use anyhow::Result;
use std::collections::{BTreeMap, BTreeSet};

/// What texts can refer to.
pub struct Site {
    /// Where diagrams are read from.
    pub library: Library,
    /// The book's headings.
    pub book: Book,
    /// All chapters.
    pub chapters: Vec<Chapter>,
    /// All excerpts by name.
    pub excerpts: BTreeMap<String, Excerpt>,
    /// The glossary in alphabetical order.
    pub terms: Vec<Entry<Term>>,
    /// The references in the order of the file.
    pub references: Vec<Entry<Reference>>,
    /// What tables and charts are made of.
    pub measured: Measured,
    /// Colours code.
    pub highlighter: Highlighter,
    /// Converts formulas.
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
    /// Names of shown diagrams.
    pub diagrams: BTreeSet<String>,
    /// Anchors that exist.
    pub anchors: BTreeSet<String>,
    /// Anchors that are linked, each with file and line.
    pub targets: Vec<(String, String, usize)>,
}

impl Site {
    /// Reads everything from the library.
    ///
    /// # Errors
    /// If a part of the program itself is wrong. Faults of the texts are added to `faults`.
    pub fn read(library: &Library, measured: Measured, faults: &mut Vec<Fault>) -> Result<Self> {
        let mut terms: Vec<Entry<Term>> = reference::read(library, GLOSSARY, faults);
        terms.sort_by_key(|entry| entry.value.term.to_lowercase());
        Ok(Site {
            library: library.clone(),
            book: Book::read(library, faults),
            chapters: Chapter::read_all(library, faults),
            excerpts: excerpt::read_all(library, faults),
            terms,
            references: reference::read(library, REFERENCES, faults),
            measured,
            highlighter: Highlighter::new()?,
            formulas: Formulas::new()?,
        })
    }

    /// The term with this key.
    pub fn term(&self, key: &str) -> Option<&Entry<Term>> {
        self.terms.iter().find(|entry| entry.key == key)
    }

    /// The number and the entry of a reference.
    pub fn reference(&self, key: &str) -> Option<(usize, &Entry<Reference>)> {
        let place = self.references.iter().position(|entry| entry.key == key)?;
        Some((place + 1, &self.references[place]))
    }

    /// Faults that show only after all texts were read: what nothing refers to, and links to nothing.
    pub fn check(&self, uses: &Uses, faults: &mut Vec<Fault>) {
        for entry in self.terms.iter().filter(|entry| !uses.terms.contains_key(&entry.key)) {
            let key = &entry.key;
            let message =
                format!("no chapter links the term {key:?}; link it as [text](glossary:{key}), or remove it");
            faults.push(Fault::new(GLOSSARY, entry.line, message));
        }
        for name in self.excerpts.keys().filter(|name| !uses.excerpts.contains(*name)) {
            let message =
                format!("no chapter shows the excerpt {name:?}; add {{{{excerpt {name}}}}}, or remove it");
            faults.push(Fault::new(excerpt::FILE, 0, message));
        }
        for (anchor, file, line) in uses.targets.iter().filter(|(anchor, ..)| !uses.anchors.contains(anchor))
        {
            faults.push(Fault::new(file, *line, format!("nothing on the page has the anchor #{anchor}")));
        }
    }
}

#[cfg(test)]
impl Site {
    /// Two chapters without text, two terms and two references, and the headings of the book.
    pub fn made_up() -> Site {
        let mut site = Site::read(&Library::Embedded, Measured::default(), &mut Vec::new()).unwrap();
        let chapter = |number: u8, id: &str, book: Option<&str>| Chapter {
            file: format!("{id}.md"),
            number,
            id: id.to_owned(),
            title: format!("All {id}"),
            short: format!("Some {id}"),
            book: book.map(str::to_owned),
            body: String::new(),
            lines_before: 4,
        };
        site.chapters = vec![chapter(6, "normals", Some("6")), chapter(1, "languages", None)];
        site.excerpts = BTreeMap::new();
        let term = |key: &str, line, area| {
            let value = Term { term: key.to_uppercase(), text: format!("A *{key}*."), area };
            Entry { key: key.to_owned(), line, value }
        };
        site.terms =
            vec![term("lane", 1, reference::Area::Parallelism), term("ray", 5, reference::Area::Rendering)];
        let reference = |key: &str, line, year: Option<u16>| {
            let (title, authors) = (format!("On {key}"), format!("{key} and others"));
            let url = year.map(|year| format!("https://{key}.org/{year}"));
            let value = Reference { title, authors, year, url, note: year.map(|_| "A *note*.".to_owned()) };
            Entry { key: key.to_owned(), line, value }
        };
        site.references = vec![reference("first", 1, None), reference("second", 5, Some(1980))];
        site
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::companion::library::FOLDER;

    #[test]
    fn terms_are_in_alphabetical_order_and_references_in_that_of_their_file() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(directory.path().join(FOLDER)).unwrap();
        let term =
            |key: &str, term: &str| format!("[{key}]\nterm = \"{term}\"\ntext = \"x\"\narea = \"numbers\"\n");
        let terms = [term("a", "ray"), term("b", "BVH"), term("c", "Lane")].concat();
        std::fs::write(directory.path().join(GLOSSARY), terms).unwrap();
        let works = "[z]\ntitle = \"Z\"\nauthors = \"A\"\n\n[b]\ntitle = \"B\"\nauthors = \"C\"\n";
        std::fs::write(directory.path().join(REFERENCES), works).unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        let site = Site::read(&library, Measured::default(), &mut Vec::new()).unwrap();
        let shown: Vec<&str> = site.terms.iter().map(|entry| entry.value.term.as_str()).collect();
        assert_eq!(shown, ["BVH", "Lane", "ray"]);
        let number =
            |key: &str| site.reference(key).map(|(number, entry)| (number, entry.value.title.as_str()));
        assert_eq!([number("z"), number("b"), number("c")], [Some((1, "Z")), Some((2, "B")), None]);
    }
}
