//! Excerpts of the sources for the window and the companion, found by the words that they begin and end with, so that the
//! sources need no marks.

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

/// Cuts an item, statement or block that begins with `words` out of the text of a file; `FIRST ... LAST` ends with the
/// item `LAST`. All are the first words of a line.
///
/// # Errors
/// If there is no such item, or if it is longer than a screen.
pub fn cut(file: &str, text: &str, words: &str) -> Result<Excerpt, String> {
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
        let cut = |lines_inside: usize| {
            cut("a.rs", &format!("fn a() {{\n{}}}\n", "    x();\n".repeat(lines_inside)), "fn a")
        };
        assert!(cut(39).unwrap_err().contains("lines 1 to 41 are 41, more than 40"));
        let excerpt = cut(38).unwrap();
        assert_eq!((excerpt.first, excerpt.last, excerpt.text.lines().count()), (1, 40, 40));
    }
}
