//! The excerpts for a section of the book, for programs that show them beside a stage.

use super::chapter::Chapter;
use super::excerpt::{self, Excerpt};
use super::library::Library;

/// The excerpts that the page shows after section `after`, up to and including section `section` of the same chapter of
/// the book. If `after` is the previous section with a picture, this is the code that `section` adds. Both are numbers
/// such as "9.1"; an `after` in another chapter excludes nothing.
pub fn excerpts_between(after: Option<&str>, section: &str) -> Vec<Excerpt> {
    // A test reads these texts, so they have no faults.
    let library = Library::Embedded;
    let chapters = Chapter::read_all(&library).unwrap_or_default();
    let chapter_of = |section: &str| section.split('.').next().map(str::to_owned);
    let Some(chapter) = chapters.iter().find(|chapter| chapter.facts.book == chapter_of(section)) else {
        return Vec::new();
    };
    // Only later sections of the same chapter are new.
    let after = after.filter(|after| chapter_of(after) == chapter_of(section));
    let (mut is_new, mut is_code) = (after.is_none(), false);
    let mut found = Vec::new();
    for line in chapter.body.lines() {
        if let Some(heading) = line.strip_prefix("## ") {
            let number = split_heading(heading).map_or("", |(number, _)| number);
            if is_later(number, section) {
                break;
            }
            is_new = is_new || after.is_some_and(|after| is_later(number, after));
        } else if line.starts_with("{{code") || line == "}}" {
            is_code = line != "}}";
        } else if is_code && is_new {
            found.extend(excerpt::cut(&library, line));
        }
    }
    // The window has switches for these languages.
    found.retain(|excerpt| [".c", ".rs", ".wgsl"].iter().any(|ending| excerpt.file.ends_with(ending)));
    found
}

/// Whether a section comes after another of the same chapter.
fn is_later(section: &str, other: &str) -> bool {
    let part = |section: &str| section.split('.').nth(1).and_then(|part| part.parse::<u8>().ok());
    is_section(section) && part(section) > part(other)
}

/// Splits a heading that starts with a section number, such as "6.1 Shading with Surface Normals".
pub fn split_heading(heading: &str) -> Option<(&str, &str)> {
    let (number, title) = heading.split_once(' ')?;
    is_section(number).then_some((number, title.trim()))
}

/// Whether this is a section number, such as "9.3".
fn is_section(number: &str) -> bool {
    number.contains('.') && number.split('.').all(|part| part.parse::<u8>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn section_has_new_excerpts() {
        let first_lines = |after: Option<&str>, section: &str| -> Vec<String> {
            let first = |excerpt: Excerpt| excerpt.text.lines().next().unwrap_or_default().to_owned();
            excerpts_between(after, section).into_iter().map(first).collect()
        };
        let glass = first_lines(Some("11.3"), "11.4");
        let has = |words: &str| glass.iter().filter(|line| line.contains(words)).count();
        assert_eq!((has("fn reflectance"), has("double reflectance")), (2, 1), "{glass:?}");
        // The code of 5.1 is new in the picture of 5.2, the chapter's first.
        assert!(first_lines(Some("4.2"), "5.2").iter().any(|line| line.contains("fn book_root")));
        assert_eq!(first_lines(Some("10.5"), "10.6"), Vec::<String>::new());
        assert_eq!(first_lines(None, "99.1"), Vec::<String>::new());
    }

    #[test]
    fn section_number_splits_from_heading() {
        assert_eq!(split_heading("6.1 Shading with Normals"), Some(("6.1", "Shading with Normals")));
        for heading in ["1. Paths", "6 Normals", "What a lane is", "6.x Normals", "6.1"] {
            assert_eq!(split_heading(heading), None, "{heading}");
        }
    }
}
