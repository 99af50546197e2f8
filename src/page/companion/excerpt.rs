//! Excerpts of the sources, found by the start of an item or between two comments.

use super::fault::Fault;
use super::library::{Entry, Library};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

pub const FILE: &str = "docs/companion/excerpts.toml";

/// Maximum lines of an excerpt: a screen.
const LINE_LIMIT: usize = 40;

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

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Declared {
    file: String,
    item: Option<String>,
    region: Option<String>,
    /// Whether to include the comments above the item.
    #[serde(default)]
    docs: bool,
}

/// Reads the declarations and extracts all excerpts from their files.
pub fn read_all(library: &Library) -> Result<BTreeMap<String, Excerpt>, Fault> {
    let excerpt = |Entry { key, line, value }: Entry<Declared>| match cut(library, value) {
        Ok(excerpt) => Ok((key, excerpt)),
        Err(message) => Err(Fault::new(FILE, line, format!("{key}: {message}"))),
    };
    library.entries(FILE)?.into_iter().map(excerpt).collect()
}

fn cut(library: &Library, declared: Declared) -> Result<Excerpt, String> {
    let Declared { file, item, region, docs } = declared;
    let text = library.read(&file).map_err(|fault| fault.to_string())?;
    let lines: Vec<&str> = text.lines().collect();
    let found = match (item, region) {
        (Some(item), None) => find_item(&lines, &item, docs),
        (None, Some(region)) => find_region(&lines, &region),
        _ => Err("give either item or region".to_owned()),
    };
    let range = found.map_err(|message| format!("{file}: {message}"))?;
    let (first, last) = (range.start() + 1, range.end() + 1);
    let kept: Vec<&str> = lines[range].iter().copied().filter(|line| anchor(line).is_none()).collect();
    if kept.len() > LINE_LIMIT {
        return Err(format!(
            "{file}: lines {first} to {last} are {}, more than {LINE_LIMIT}; choose a shorter item or region",
            kept.len(),
        ));
    }
    Ok(Excerpt { file, first, last, text: without_indentation(&kept) })
}

/// `ANCHOR` or `ANCHOR_END` with the region's name, if the line is such a comment.
fn anchor(line: &str) -> Option<(&str, &str)> {
    let (word, name) = line.trim().strip_prefix("//")?.trim().split_once(':')?;
    matches!(word, "ANCHOR" | "ANCHOR_END").then_some((word, name.trim()))
}

/// The lines between a region's two comments.
fn find_region(lines: &[&str], name: &str) -> Result<RangeInclusive<usize>, String> {
    let place = |word: &str| lines.iter().position(|line| anchor(line) == Some((word, name)));
    match (place("ANCHOR"), place("ANCHOR_END")) {
        (Some(begin), Some(end)) if begin + 1 < end => Ok(begin + 1..=end - 1),
        _ => Err(format!("there is no comment // ANCHOR: {name} with a // ANCHOR_END: {name} below it")),
    }
}

/// The lines of the item that starts with these words, possibly after its visibility and attributes.
fn find_item(lines: &[&str], item: &str, docs: bool) -> Result<RangeInclusive<usize>, String> {
    let is_qualifier = |word: &str| {
        word.starts_with("pub")
            || word.starts_with('@')
            || ["const", "unsafe", "async", "static", "inline"].contains(&word)
    };
    let begins = |line: &str| {
        line.split_once(item).is_some_and(|(before, after)| {
            let is_longer_word = after.starts_with(|c: char| c.is_alphanumeric() || c == '_');
            !is_longer_word && before.split_whitespace().all(is_qualifier)
        })
    };
    let places: Vec<usize> = (0..lines.len()).filter(|place| begins(lines[*place])).collect();
    let [begin] = places.as_slice() else {
        let lines: Vec<String> = places.iter().map(|place| (place + 1).to_string()).collect();
        return Err(match lines.as_slice() {
            [] => format!("no line begins with {item:?}"),
            lines => format!("{item:?} begins lines {}; give more of the line", lines.join(" and ")),
        });
    };
    let end = end_of_item(lines, *begin).ok_or_else(|| format!("the item {item:?} has no end"))?;
    let is_doc = |line: &str| {
        let line = line.trim_start();
        line.starts_with("///") || line.starts_with("#[") || line.starts_with("// ")
    };
    let above = lines[..*begin].iter().rev().take_while(|line| docs && is_doc(line)).count();
    Ok(begin - above..=end)
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
        "    // ANCHOR: middle",
        "    let x = 1;",
        "    // ANCHOR: inner",
        "",
        "        let y = 2;",
        "    // ANCHOR_END: inner",
        "    // ANCHOR_END: middle",
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
        let found = |item: &str, docs| {
            find_item(SOURCE, item, docs).map(|range| (range.start() + 1, range.end() + 1))
        };
        assert_eq!(found("fn add", false), Ok((4, 8)));
        assert_eq!(found("fn add", true), Ok((2, 8)));
        assert_eq!(found("const TABLE", false), Ok((10, 12)));
        assert_eq!(found("const fn addition", false), Ok((14, 14)));
        assert_eq!(found("fn trace", false), Ok((23, 25)));
        assert_eq!(found("struct Pair", false), Ok((26, 26)));
        assert_eq!(found("double half", false), Ok((27, 30)));
        assert!(found("fn subtract", false).unwrap_err().contains("no line begins with"));
        assert!(found("let", false).unwrap_err().contains("begins lines 17 and 20;"));
    }

    #[test]
    fn regions_lie_between_two_comments() {
        let range = find_region(SOURCE, "middle").unwrap();
        assert_eq!((range.start() + 1, range.end() + 1), (17, 21));
        let kept: Vec<&str> = SOURCE[range].iter().copied().filter(|line| anchor(line).is_none()).collect();
        assert_eq!(without_indentation(&kept), "let x = 1;\n\n    let y = 2;\n");
        for source in
            [&["// ANCHOR: b", "x", "// ANCHOR_END: b"][..], &["// ANCHOR_END: a", "x", "// ANCHOR: a"]]
        {
            assert!(find_region(source, "a").unwrap_err().starts_with("there is no comment // ANCHOR: a"));
        }
    }

    #[test]
    fn items_longer_than_a_screen_are_refused() {
        let directory = tempfile::tempdir().unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        let cut = |lines_inside: usize| {
            let text = format!("fn a() {{\n{}}}\n", "    x();\n".repeat(lines_inside));
            std::fs::write(directory.path().join("a.rs"), text).unwrap();
            let (file, item) = ("a.rs".to_owned(), Some("fn a".to_owned()));
            super::cut(&library, Declared { file, item, region: None, docs: false })
        };
        assert!(cut(39).unwrap_err().contains("lines 1 to 41 are 41, more than 40"));
        let excerpt = cut(38).unwrap();
        assert_eq!((excerpt.first, excerpt.last, excerpt.text.lines().count()), (1, 40, 40));
    }
}
