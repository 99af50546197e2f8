//! The book's sections: headings and web addresses.

use crate::stages;
use serde::Deserialize;
use std::collections::BTreeMap;

pub const FILE: &str = "docs/companion/book.toml";

/// The book's headings by number, such as "6" and "6.1".
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Book {
    headings: BTreeMap<String, String>,
}

impl Book {
    pub fn heading(&self, number: &str) -> Option<&str> {
        self.headings.get(number).map(String::as_str)
    }

    pub fn url(&self, number: &str) -> Option<String> {
        let chapter = number.split('.').next().unwrap_or(number);
        let title = self.heading(number)?;
        let section = (chapter != number).then_some(title);
        Some(stages::book_url(self.heading(chapter)?, section))
    }
}

/// Splits a heading that starts with a section number, such as "6.1 Shading with Surface Normals".
pub fn split_heading(heading: &str) -> Option<(&str, &str)> {
    let (number, title) = heading.split_once(' ')?;
    is_section(number).then_some((number, title.trim()))
}

/// Whether this is a section number, such as "9.3".
pub fn is_section(number: &str) -> bool {
    number.contains('.') && number.split('.').all(|part| part.parse::<u8>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::companion::library::Library;
    use crate::stages::Stage;

    #[test]
    fn headings_match_stages() {
        let book: Book = Library::Embedded.toml(FILE).unwrap();
        for stage in Stage::ALL {
            assert_eq!(book.heading(stage.section), Some(stage.section_title), "{}", stage.id);
            assert_eq!(book.heading(stage.chapter()), Some(stage.chapter_title), "{}", stage.id);
            assert_eq!(book.url(stage.section), Some(stage.url()), "{}", stage.id);
        }
        assert!(book.url("6").unwrap().ends_with("#surfacenormalsandmultipleobjects"));
    }

    #[test]
    fn section_number_splits_from_heading() {
        assert_eq!(split_heading("6.1 Shading with Normals"), Some(("6.1", "Shading with Normals")));
        for heading in ["1. Paths", "6 Normals", "What a lane is", "6.x Normals", "6.1"] {
            assert_eq!(split_heading(heading), None, "{heading}");
        }
    }
}
