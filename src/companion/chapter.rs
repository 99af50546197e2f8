//! Chapters of the page: files of Markdown with a few facts before the text.

use super::faults::{Fault, line_of};
use super::library::{FOLDER, Library};
use serde::Deserialize;

/// A chapter, not yet rendered.
#[derive(Clone, Debug, Default)]
pub struct Chapter {
    /// Path in the checkout.
    pub file: String,
    /// The number in the file's name.
    pub number: u8,
    /// The name in the file's name: the chapter's anchor.
    pub id: String,
    /// The heading.
    pub title: String,
    /// A short title for the navigation.
    pub short: String,
    /// Number of the book's chapter.
    pub book: Option<String>,
    /// The Markdown.
    pub body: String,
    /// Number of lines before the Markdown.
    pub lines_before: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Front {
    title: String,
    short: Option<String>,
    book: Option<String>,
    /// The book's heading; it must be the one of `book.toml`.
    book_title: Option<String>,
}

/// The number of the book's last chapter that the page goes through.
const LAST_OF_BOOK: u8 = 14;

/// The line above and below the facts.
const FENCE: &str = "+++";

impl Chapter {
    /// Reads all chapters in the order of their numbers.
    pub fn read_all(library: &Library, faults: &mut Vec<Fault>) -> Vec<Chapter> {
        let paths = library.chapters().unwrap_or_else(|error| {
            faults.push(Fault::new(FOLDER, 0, error));
            Vec::new()
        });
        let mut chapters: Vec<Chapter> = Vec::new();
        for path in paths {
            let read = library.read(&path).map_err(|message| Fault::new(&path, 0, message));
            match read.and_then(|text| Chapter::parse(&path, &text)) {
                Err(fault) => faults.push(fault),
                Ok(chapter) => {
                    let is_same = |other: &&Chapter| other.id == chapter.id || other.number == chapter.number;
                    if let Some(other) = chapters.iter().find(is_same) {
                        let message = format!("has the number or the name of {}; choose another", other.file);
                        faults.push(Fault::new(&path, 0, message));
                    }
                    chapters.push(chapter);
                }
            }
        }
        chapters
    }

    /// The number to show; `None` where it could be taken for that of another chapter of the book.
    pub fn shown_number(&self) -> Option<u8> {
        let is_of_book = self.book.as_deref() == Some(self.number.to_string().as_str());
        (is_of_book || self.number > LAST_OF_BOOK).then_some(self.number)
    }

    /// Splits a file into its facts and its Markdown.
    fn parse(file: &str, text: &str) -> Result<Chapter, Fault> {
        let fault = |line: usize, message: &str| Err(Fault::new(file, line, message));
        let Some(rest) = text.strip_prefix(FENCE).and_then(|rest| rest.strip_prefix('\n')) else {
            return fault(1, "begin the file with a line +++, the title as TOML, and another line +++");
        };
        let Some((facts, body)) = rest.split_once("\n+++\n") else {
            return fault(1, "close the facts about the chapter with a line +++");
        };
        let front: Front = match toml::from_str(facts) {
            Ok(front) => front,
            Err(error) => {
                let line = 1 + error.span().map_or(1, |span| line_of(facts, span.start));
                return fault(line, error.message());
            }
        };
        if front.book.is_some() != front.book_title.is_some() {
            return fault(1, "give both book and book_title, or neither");
        }
        let name = file.rsplit('/').next().unwrap_or(file).trim_end_matches(".md");
        let (number, id) = name.split_once('-').unwrap_or(("0", name));
        Ok(Chapter {
            file: file.to_owned(),
            number: number.parse().unwrap_or_default(),
            id: id.to_owned(),
            short: front.short.unwrap_or_else(|| front.title.clone()),
            title: front.title,
            book: front.book,
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
        let text = "+++\ntitle = \"Normals\"\nbook = \"6\"\nbook_title = \"Surface Normals\"\n+++\n\nText\n";
        let chapter = Chapter::parse(FILE, text).unwrap();
        let Chapter { number, id, title, short, book, body, lines_before, .. } = chapter;
        assert_eq!(
            (number, id.as_str(), title.as_str(), short.as_str()),
            (6, "normals", "Normals", "Normals")
        );
        assert_eq!((book.as_deref(), body.as_str(), lines_before), (Some("6"), "\nText\n", 5));
    }

    #[test]
    fn numbers_are_those_of_the_book_or_above_them() {
        let shown = |number: u8, book: Option<&str>| {
            Chapter { number, book: book.map(str::to_owned), ..Chapter::default() }.shown_number()
        };
        assert_eq!([shown(6, Some("6")), shown(20, None)], [Some(6), Some(20)]);
        assert_eq!([shown(0, Some("1")), shown(1, None)], [None, None]);
        assert_eq!([shown(14, None), shown(14, Some("14")), shown(15, None)], [None, Some(14), Some(15)]);
    }

    #[test]
    fn wrong_facts_are_named_with_their_line() {
        for (text, line, word) in [
            ("Text", 1, "+++"),
            ("+++\ntitle = \"A\"\n", 1, "close"),
            ("+++\ntitle = \"A\"\ncolour = 1\n+++\n", 3, "colour"),
            ("+++\ntitle = \"A\"\nbook = \"6\"\n+++\n", 1, "book_title"),
        ] {
            let fault = Chapter::parse(FILE, text).unwrap_err();
            assert_eq!(fault.line, line, "{text}: {fault}");
            assert!(fault.message.contains(word), "{text}: {fault}");
        }
    }

    #[test]
    fn two_chapters_with_one_number_or_name_are_a_fault_of_the_second() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path().join(FOLDER);
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["05-sphere.md", "05-other.md", "06-sphere.md", "07-normals.md"] {
            std::fs::write(folder.join(name), "+++\ntitle = \"A\"\n+++\n").unwrap();
        }
        let mut faults = Vec::new();
        let chapters = Chapter::read_all(&Library::Checkout(directory.path().to_owned()), &mut faults);
        assert_eq!(chapters.len(), 4);
        let fault = |name: &str, other: &str| {
            let message = format!("has the number or the name of {FOLDER}/{other}; choose another");
            Fault::new(&format!("{FOLDER}/{name}"), 0, message)
        };
        assert_eq!(faults, [fault("05-sphere.md", "05-other.md"), fault("06-sphere.md", "05-sphere.md")]);
    }
}
