//! Excerpts of the sources, found by the words that they begin and end with, so that the sources need no marks.

use super::chapter::Chapter;
use super::library::Library;
use std::ops::RangeInclusive;

/// Maximum lines of an excerpt: a screen.
const LINE_LIMIT: usize = 40;

/// Separates the first words of an excerpt from those of its last item.
const UP_TO: &str = " ... ";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// Path in the checkout.
    pub file: String,
    /// First line in the file, counted from 1.
    pub first: usize,
    /// Last line in the file.
    pub last: usize,
    /// The lines without their common indentation.
    pub text: String,
}

impl Excerpt {
    /// The file's extension.
    pub fn language(&self) -> &str {
        self.file.rsplit('.').next().unwrap_or_default()
    }
}

/// Cuts `FILE: ITEM`, which is an item, statement or block, or `FILE: FIRST ... LAST`, which ends with the item `LAST`.
/// All three are the first words of a line.
pub fn cut(library: &Library, wanted: &str) -> Result<Excerpt, String> {
    let (file, words) =
        wanted.split_once(": ").ok_or("name a file, a colon and the first words of an item")?;
    let text = library.read(file).map_err(|fault| fault.to_string())?;
    let lines: Vec<&str> = text.lines().collect();
    let range = find(&lines, words).map_err(|message| format!("{file}: {message}"))?;
    let (first, last) = (range.start() + 1, range.end() + 1);
    let count = last + 1 - first;
    if count > LINE_LIMIT {
        return Err(format!(
            "{file}: lines {first} to {last} are {count}, more than {LINE_LIMIT}; choose fewer"
        ));
    }
    Ok(Excerpt { file: file.to_owned(), first, last, text: without_indentation(&lines[range]) })
}

fn find(lines: &[&str], words: &str) -> Result<RangeInclusive<usize>, String> {
    let (first, last) = words.split_once(UP_TO).unwrap_or((words, words));
    let places: Vec<usize> = (0..lines.len()).filter(|place| begins(lines[*place], first)).collect();
    let found = places.first().ok_or_else(|| format!("no line begins with {first:?}"))?;
    if first == last && places.len() > 1 {
        let lines: Vec<String> = places.iter().map(|place| (place + 1).to_string()).collect();
        return Err(format!("{first:?} begins lines {}; give more of the line", lines.join(" and ")));
    }
    let last = (*found..lines.len()).find(|place| begins(lines[*place], last));
    let last = last.ok_or_else(|| format!("no line after line {} begins with {last:?}", found + 1))?;
    let begin = places.iter().rfind(|place| **place < last).unwrap_or(found);
    // A line of data has no end of its own.
    Ok(*begin..=end_of_item(lines, last).unwrap_or(last))
}

/// Whether a line begins with these words, possibly after visibility and attributes.
fn begins(line: &str, words: &str) -> bool {
    let is_qualifier = |word: &str| {
        word.starts_with("pub")
            || word.starts_with('@')
            || ["const", "unsafe", "async", "static", "inline"].contains(&word)
    };
    line.split_once(words).is_some_and(|(before, after)| {
        let is_longer_word = after.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        !is_longer_word && before.split_whitespace().all(is_qualifier)
    })
}

/// The last line of an item in formatted code: the first with the item's indentation that ends with a brace or a
/// semicolon.
fn end_of_item(lines: &[&str], begin: usize) -> Option<usize> {
    let indentation = indentation(lines[begin]);
    (begin..lines.len()).find(|place| {
        let line = lines[*place];
        self::indentation(line) == indentation && line.ends_with(['}', ';'])
    })
}

fn indentation(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

fn without_indentation(lines: &[&str]) -> String {
    let filled = lines.iter().filter(|line| !line.trim().is_empty());
    let common = filled.map(|line| indentation(line)).min().unwrap_or(0);
    let cut = lines.iter().map(|line| line.get(common..).unwrap_or("").trim_end());
    cut.fold(String::new(), |text, line| text + line + "\n")
}

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
            found.extend(cut(&library, line));
        }
    }
    // The window has switches for these languages.
    found.retain(|excerpt| ["c", "rs", "wgsl"].contains(&excerpt.language()));
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

    const SOURCE: &[&str] = &[
        "",
        "/// Adds.",
        "#[inline]",
        "pub(crate) fn add<'a>(",
        "    a: [u32; 2],",
        ") -> u32 {",
        "    if b == 0 { a[0] } else { a[1] }",
        "}",
        "",
        "pub const TABLE: [Row; 1] = [",
        "    Row { x: 1 },",
        "];",
        "",
        "const fn addition() {}",
        "",
        "    //",
        "    let x = 1;",
        "",
        "",
        "        let y = 2;",
        "    //",
        "    //",
        "@compute @workgroup_size(64) fn trace(at: u32) {",
        "    return;",
        "}",
        "struct Pair(u32, u32);",
        "static inline double half(double x)",
        "{",
        "    return x / 2;",
        "}",
    ];

    #[test]
    fn items_are_found_whole() {
        let found = |words: &str| find(SOURCE, words).map(|range| (range.start() + 1, range.end() + 1));
        assert_eq!(found("fn add"), Ok((4, 8)));
        assert_eq!(found("/// Adds. ... fn add"), Ok((2, 8)));
        assert_eq!(found("const TABLE"), Ok((10, 12)));
        assert_eq!(found("const fn addition"), Ok((14, 14)));
        assert_eq!(found("let x ... let y"), Ok((17, 20)));
        assert_eq!(found("fn trace"), Ok((23, 25)));
        assert_eq!(found("struct Pair"), Ok((26, 26)));
        assert_eq!(found("double half"), Ok((27, 30)));
        assert!(found("fn subtract").unwrap_err().contains("no line begins with"));
        assert!(found("let").unwrap_err().contains("begins lines 17 and 20;"));
        assert!(found("fn trace ... fn add").unwrap_err().contains("no line after line 23"));
        assert_eq!(found("let ... let y"), Ok((17, 20)));
        assert_eq!(without_indentation(&SOURCE[16..20]), "let x = 1;\n\n\n    let y = 2;\n");
    }

    #[test]
    fn items_longer_than_a_screen_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        let cut = |lines_inside: usize| {
            let text = format!("fn a() {{\n{}}}\n", "    x();\n".repeat(lines_inside));
            std::fs::write(directory.path().join("a.rs"), text).unwrap();
            cut(&library, "a.rs: fn a")
        };
        assert!(cut(39).unwrap_err().contains("lines 1 to 41 are 41, more than 40"));
        let excerpt = cut(38).unwrap();
        assert_eq!((excerpt.first, excerpt.last, excerpt.text.lines().count()), (1, 40, 40));
    }

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
