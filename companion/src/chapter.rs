//! The page's chapters: Markdown files that start with a few facts.

use crate::library::{Fault, Library, line_of, parsed};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A chapter, not yet rendered.
#[derive(Clone, Debug)]
pub struct Chapter {
    /// Path in the checkout.
    pub file: String,
    /// The number in the file's name.
    pub number: u8,
    /// The name in the file's name, which is the chapter's anchor.
    pub id: String,
    pub facts: Facts,
    /// The Markdown.
    pub body: String,
    /// Number of lines before the Markdown.
    pub lines_before: usize,
}

/// The facts before a chapter's text.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    pub title: String,
    /// Short title for the navigation.
    short: Option<String>,
    /// Number of the book's chapter.
    pub book: Option<String>,
    /// Symbols of formulas and names in code, with the number of their colour.
    #[serde(default)]
    pub colours: BTreeMap<String, u8>,
    /// Names in the text that are not in the code beside it.
    #[serde(default)]
    pub elsewhere: Vec<String>,
}

/// Number in the file's name of the first chapter that is not the book's.
const FIRST_BEYOND_BOOK: u8 = 20;

impl Chapter {
    /// Reads all chapters, by number.
    pub fn read_all(library: &Library) -> Result<Vec<Chapter>, Fault> {
        library.chapters()?.iter().map(|path| Chapter::parse(path, &library.read(path)?)).collect()
    }

    pub fn short(&self) -> &str {
        self.facts.short.as_deref().unwrap_or(&self.facts.title)
    }

    /// The number to show: the book's or, beyond the book, a letter.
    pub fn shown_number(&self) -> Option<String> {
        match self.number {
            2..=14 => Some(self.number.to_string()),
            FIRST_BEYOND_BOOK.. => Some(char::from(b'A' + self.number - FIRST_BEYOND_BOOK).to_string()),
            _ => None,
        }
    }

    /// Splits a file into facts and Markdown.
    fn parse(file: &str, text: &str) -> Result<Chapter, Fault> {
        let parts = text.strip_prefix("+++\n").and_then(|rest| rest.split_once("\n+++\n"));
        let Some((facts, body)) = parts else {
            let message = "begin the file with a line +++, the title as TOML, and another line +++";
            return Err(Fault::new(file, 1, message));
        };
        let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".md");
        let (number, id) = name.split_once('-').unwrap_or(("0", name));
        Ok(Chapter {
            file: file.to_owned(),
            number: number.parse().unwrap_or_default(),
            id: id.to_owned(),
            facts: parsed(file, facts, 1)?,
            body: body.to_owned(),
            lines_before: 2 + line_of(facts, facts.len()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "docs/companion/06-normals.md";

    #[test]
    fn a_chapter_has_facts_and_text() {
        let text = "+++\ntitle = \"Normals\"\nbook = \"6\"\n+++\n\nText\n";
        let chapter = Chapter::parse(FILE, text).unwrap();
        assert_eq!((chapter.number, chapter.id.as_str(), chapter.short()), (6, "normals", "Normals"));
        assert_eq!((chapter.body.as_str(), chapter.lines_before), ("\nText\n", 4));
        assert_eq!(chapter.shown_number().as_deref(), Some("6"));
        let shown = |number| Chapter { number, ..chapter.clone() }.shown_number();
        assert_eq!([shown(21), shown(0), shown(17)], [Some("B".to_owned()), None, None]);
    }

    #[test]
    fn wrong_facts_name_line() {
        for (text, line, word) in [("Text", 1, "+++"), ("+++\ntitle = \"A\"\ncolour = 1\n+++\n", 3, "colour")]
        {
            let fault = Chapter::parse(FILE, text).unwrap_err();
            assert!(fault.line == line && fault.message.contains(word), "{text}: {fault}");
        }
    }
}
