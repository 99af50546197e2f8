//! The page's texts and the sources that it quotes, read from the checkout, so that edits show without a new build.

use anyhow::{Context, Error};
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use thiserror::Error;
use toml::Spanned;
use weekender::excerpt::{Excerpt, cut};
use weekender::system::files;

/// Reads files by their paths in a checkout.
#[derive(Clone, Debug)]
pub struct Library(PathBuf);

pub const FOLDER: &str = "docs/companion";

/// Largest file read, bytes.
const FILE_LIMIT: u64 = 1 << 22;

/// An entry of a TOML file with one table per entry.
#[derive(Clone, Debug)]
pub struct Entry<T> {
    pub key: String,
    /// Line in the file, counted from 1.
    pub line: usize,
    pub value: T,
}

impl Library {
    /// The checkout that this program was built in.
    pub fn of_checkout() -> Self {
        Library(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
    }

    pub fn read(&self, path: &str) -> Result<String, Fault> {
        files::read(&self.0.join(path), "a text of the page", FILE_LIMIT)
            .map_err(|error| error.to_string())
            .and_then(|bytes| String::from_utf8(bytes).map_err(|_| "is not UTF-8".to_owned()))
            .map_err(|message| Fault::new(path, 0, message))
    }

    pub fn has(&self, path: &str) -> bool {
        self.0.join(path).exists()
    }

    pub fn toml<T: DeserializeOwned>(&self, path: &str) -> Result<T, Fault> {
        parsed(path, &self.read(path)?, 0)
    }

    /// The tables of a TOML file, in file order.
    pub fn entries<T: DeserializeOwned>(&self, path: &str) -> Result<Vec<Entry<T>>, Fault> {
        let tables: BTreeMap<String, Spanned<T>> = self.toml(path)?;
        let text = self.read(path)?;
        let entry = |(key, value): (String, Spanned<T>)| {
            let line = line_of(&text, value.span().start);
            Entry { key, line, value: value.into_inner() }
        };
        let mut entries: Vec<Entry<T>> = tables.into_iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.line);
        Ok(entries)
    }

    /// Paths of the chapters, ascending.
    pub fn chapters(&self) -> Result<Vec<String>, Fault> {
        let files = fs::read_dir(self.0.join(FOLDER)).map_err(|error| Fault::new(FOLDER, 0, error))?;
        let names = files.filter_map(|file| file.ok()?.file_name().into_string().ok());
        let mut chapters: Vec<String> =
            names.filter(|name| name.ends_with(".md")).map(|name| format!("{FOLDER}/{name}")).collect();
        chapters.sort();
        Ok(chapters)
    }

    /// Cuts `FILE: ITEM`, which is an item, statement or block, or `FILE: FIRST ... LAST`, which ends with the item
    /// `LAST`.
    pub fn excerpt(&self, wanted: &str) -> anyhow::Result<Excerpt> {
        let (file, words) =
            wanted.split_once(": ").context("name a file, a colon and the first words of an item")?;
        cut(file, &self.read(file).map_err(|fault| Error::msg(fault.to_string()))?, words).map_err(Error::msg)
    }
}

/// Reads TOML that stands after `lines_before` lines of a file.
pub fn parsed<T: DeserializeOwned>(file: &str, text: &str, lines_before: usize) -> Result<T, Fault> {
    toml::from_str(text).map_err(|error| {
        let line = error.span().map_or(0, |span| line_of(text, span.start));
        Fault::new(file, lines_before + line, error.message())
    })
}

/// An error in the texts, with file and line.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}{}: {message}", if *.line == 0 { String::new() } else { format!(":{}", .line) })]
pub struct Fault {
    /// Path in the checkout.
    pub file: String,
    /// Counted from 1; 0 if the fault concerns the whole file.
    pub line: usize,
    /// The mistake and its remedy.
    pub message: String,
}

impl Fault {
    pub fn new(file: &str, line: usize, message: impl fmt::Display) -> Self {
        Fault { file: file.to_owned(), line, message: message.to_string() }
    }
}

/// The line of a byte position, counted from 1.
pub fn line_of(text: &str, position: usize) -> usize {
    1 + text.bytes().take(position).filter(|byte| *byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_have_lines_and_errors_name_files() {
        let directory = tempfile::tempdir().unwrap();
        let library = Library(directory.path().to_owned());
        fs::write(directory.path().join("a.toml"), "# A\n[z]\nx = 1\n\n[b]\nx = 2\n").unwrap();
        let entries: Vec<Entry<BTreeMap<String, u32>>> = library.entries("a.toml").unwrap();
        let found: Vec<_> = entries.iter().map(|entry| (entry.key.as_str(), entry.line)).collect();
        assert_eq!(found, [("z", 2), ("b", 5)]);
        fs::write(directory.path().join("a.toml"), "# A\n[z]\nx = 1\n").unwrap();
        let fault = library.entries::<BTreeMap<String, bool>>("a.toml").unwrap_err();
        assert_eq!((fault.file.as_str(), fault.line), ("a.toml", 3));
        fs::write(directory.path().join("b.md"), b"a\xff").unwrap();
        assert_eq!(library.read("b.md").unwrap_err().to_string(), "b.md: is not UTF-8");
        assert!(library.read("c.md").unwrap_err().to_string().starts_with("c.md: "));
    }
}
