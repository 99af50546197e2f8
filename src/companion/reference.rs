//! The glossary and the list of references.

use super::faults::{Fault, line_of};
use super::library::Library;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use toml::Spanned;

/// Where the terms are explained.
pub const GLOSSARY: &str = "docs/companion/glossary.toml";

/// Where the references are listed.
pub const REFERENCES: &str = "docs/companion/references.toml";

/// A term of the glossary.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// The term as it is shown.
    pub term: String,
    /// What it means, in Markdown.
    pub text: String,
    /// The part of the glossary that it belongs to.
    pub area: Area,
}

/// A part of the glossary.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Area {
    /// Light, pictures and noise.
    Rendering,
    /// Lanes, threads and devices.
    Parallelism,
    /// How numbers are stored and rounded.
    Numbers,
}

/// A work that the text refers to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Its title.
    pub title: String,
    /// Who wrote it.
    pub authors: String,
    /// Year of publication.
    pub year: Option<u16>,
    /// Web address.
    pub url: Option<String>,
    /// Where it appeared, and what it is good for.
    pub note: Option<String>,
}

/// An entry with its line in its file.
#[derive(Clone, Debug)]
pub struct Entry<T> {
    /// Its key.
    pub key: String,
    /// Line in the file, counted from 1.
    pub line: usize,
    /// What is said there.
    pub value: T,
}

/// Reads a file with one table per entry, in the order of the file.
pub fn read<T: DeserializeOwned>(library: &Library, file: &str, faults: &mut Vec<Fault>) -> Vec<Entry<T>> {
    let text = library.read(file).unwrap_or_else(|message| {
        faults.push(Fault::new(file, 0, message));
        "".into()
    });
    let entries: BTreeMap<String, Spanned<T>> = toml::from_str(&text).unwrap_or_else(|error| {
        let line = error.span().map_or(0, |span| line_of(&text, span.start));
        faults.push(Fault::new(file, line, error.message()));
        BTreeMap::new()
    });
    let entry = |(key, value): (String, Spanned<T>)| {
        let line = line_of(&text, value.span().start);
        Entry { key, line, value: value.into_inner() }
    };
    let mut entries: Vec<Entry<T>> = entries.into_iter().map(entry).collect();
    entries.sort_by_key(|entry| entry.line);
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_that_cannot_be_read_is_a_fault_of_its_line() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(GLOSSARY);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            let mut faults = Vec::new();
            let entries: Vec<Entry<Term>> = read(&library, GLOSSARY, &mut faults);
            let terms: Vec<String> = entries.into_iter().map(|entry| entry.value.term).collect();
            (terms, faults.into_iter().map(|fault| (fault.file, fault.line)).collect::<Vec<_>>())
        };
        let good = "[z]\nterm = \"Z\"\ntext = \"z\"\narea = \"rendering\"\n";
        let second = "[a]\nterm = \"A\"\ntext = \"a\"\narea = \"cooking\"\n";
        assert_eq!(read(good), (vec!["Z".to_owned()], Vec::new()));
        assert_eq!(read(&format!("{good}{second}")), (Vec::new(), vec![(GLOSSARY.to_owned(), 8)]));
    }
}
