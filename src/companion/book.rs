//! The sections of the book: their headings and web addresses.

use super::faults::Fault;
use super::library::Library;
use crate::stages;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Where the headings are listed.
pub const FILE: &str = "docs/companion/book.toml";

/// The book's headings by number, such as "6" and "6.1".
#[derive(Debug, Default)]
pub struct Book {
    headings: BTreeMap<String, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    headings: BTreeMap<String, String>,
}

impl Book {
    /// Reads the list of headings.
    pub fn read(library: &Library, faults: &mut Vec<Fault>) -> Self {
        let parsed = library
            .read(FILE)
            .and_then(|text| toml::from_str::<File>(&text).map_err(|error| error.to_string()));
        match parsed {
            Ok(File { headings }) => Book { headings },
            Err(message) => {
                faults.push(Fault::new(FILE, 0, message));
                Book::default()
            }
        }
    }

    /// The heading of a chapter or section.
    pub fn heading(&self, number: &str) -> Option<&str> {
        self.headings.get(number).map(String::as_str)
    }

    /// The web address of a chapter or section.
    pub fn url(&self, number: &str) -> Option<String> {
        let chapter = number.split('.').next().unwrap_or(number);
        let title = self.heading(number)?;
        let section = (chapter != number).then_some(title);
        Some(stages::book_url(self.heading(chapter)?, section))
    }

    /// A text that begins with the number of a section, such as "6.1 Shading with Surface Normals".
    pub fn split(heading: &str) -> Option<(&str, &str)> {
        let (number, title) = heading.split_once(' ')?;
        is_section(number).then_some((number, title.trim()))
    }

    /// The section whose number is among the words of a link, such as "section 9.3".
    pub fn named(words: &str) -> Option<&str> {
        let around = ['[', '(', ')', ',', ';'];
        words.split_whitespace().map(|word| word.trim_matches(around)).find(|word| is_section(word))
    }
}

/// Whether this is a number such as "9.3".
fn is_section(number: &str) -> bool {
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    number.contains('.') && number.split('.').all(is_number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    #[test]
    fn headings_are_those_of_the_stages() {
        let mut faults = Vec::new();
        let book = Book::read(&Library::Embedded, &mut faults);
        assert_eq!(faults, []);
        for stage in Stage::ALL {
            assert_eq!(book.heading(stage.section), Some(stage.section_title), "{}", stage.id);
            assert_eq!(book.heading(stage.chapter()), Some(stage.chapter_title), "{}", stage.id);
            assert_eq!(book.url(stage.section), Some(stage.url()), "{}", stage.id);
        }
        let chapter = book.url("6").unwrap();
        assert!(chapter.ends_with("#surfacenormalsandmultipleobjects"), "{chapter}");
    }

    #[test]
    fn a_number_begins_a_heading_of_the_book() {
        assert_eq!(Book::split("6.1 Shading with Normals"), Some(("6.1", "Shading with Normals")));
        for heading in ["1. Paths", "6 Normals", "What a lane is", "6.x Normals", "6.1"] {
            assert_eq!(Book::split(heading), None, "{heading}");
        }
    }

    #[test]
    fn a_link_may_name_a_section() {
        for (words, section) in [
            ("[9.3", Some("9.3")),
            ("[section 10.1", Some("10.1")),
            ("[the first part of section 9.2, above", Some("9.2")),
            ("[chapter 9", None),
            ("[case 34", None),
            ("[cases 4 to 6", None),
            ("<https://a.org/1.5", None),
        ] {
            assert_eq!(Book::named(words), section, "{words}");
        }
    }
}
