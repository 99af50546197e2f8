//! Excerpts: pieces of the sources, found by the beginning of an item or between two comments.

use super::faults::{Fault, line_of};
use super::library::Library;
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// Where the excerpts are declared.
pub const FILE: &str = "docs/companion/excerpts.toml";

/// Most lines of an excerpt: a screen.
pub const LINE_LIMIT: usize = 40;

/// A piece of a source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// Path in the checkout.
    pub file: String,
    /// The first line in the file, counted from 1.
    pub first: usize,
    /// The last line in the file.
    pub last: usize,
    /// The lines without the indentation that all of them share.
    pub text: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Declared {
    file: String,
    item: Option<String>,
    region: Option<String>,
    #[serde(default)]
    docs: bool,
}

/// Reads the declarations and cuts all excerpts out of their files.
pub fn read_all(library: &Library, faults: &mut Vec<Fault>) -> BTreeMap<String, Excerpt> {
    let text = library.read(FILE).unwrap_or_else(|message| {
        faults.push(Fault::new(FILE, 0, message));
        "".into()
    });
    let declared: BTreeMap<String, Spanned<Declared>> = toml::from_str(&text).unwrap_or_else(|error| {
        let line = error.span().map_or(0, |span| line_of(&text, span.start));
        faults.push(Fault::new(FILE, line, error.message()));
        BTreeMap::new()
    });
    let mut found = BTreeMap::new();
    for (name, declared) in declared {
        let line = line_of(&text, declared.span().start);
        match cut(library, declared.as_ref()) {
            Ok(excerpt) => _ = found.insert(name, excerpt),
            Err(message) => faults.push(Fault::new(FILE, line, format!("{name}: {message}"))),
        }
    }
    found
}

fn cut(library: &Library, declared: &Declared) -> Result<Excerpt, String> {
    let Declared { file, item, region, docs } = declared;
    let text = library.read(file).map_err(|message| format!("{file} {message}"))?;
    let lines: Vec<&str> = text.lines().collect();
    let (first, last) = match (item, region) {
        (Some(item), None) => find_item(&lines, item, *docs),
        (None, Some(region)) => find_region(&lines, region),
        _ => Err("give either item or region".to_owned()),
    }
    .map_err(|message| format!("{file}: {message}"))?;
    let kept: Vec<&str> = lines[first..=last].iter().copied().filter(|line| anchor(line).is_none()).collect();
    if kept.len() > LINE_LIMIT {
        let count = kept.len();
        return Err(format!(
            "{file}: lines {} to {} are {count}, more than {LINE_LIMIT}; choose a shorter item or region",
            first + 1,
            last + 1
        ));
    }
    Ok(Excerpt { file: file.clone(), first: first + 1, last: last + 1, text: without_indentation(&kept) })
}

/// `ANCHOR` or `ANCHOR_END` with the name of the region, if the line is such a comment.
fn anchor(line: &str) -> Option<(&str, &str)> {
    let (word, name) = line.trim().strip_prefix("//")?.trim().split_once(':')?;
    matches!(word, "ANCHOR" | "ANCHOR_END").then_some((word, name.trim()))
}

/// First and last line between the two comments of a region.
fn find_region(lines: &[&str], name: &str) -> Result<(usize, usize), String> {
    let places = |word: &str| -> Vec<usize> {
        let is_it = |line: &str| anchor(line) == Some((word, name));
        lines.iter().enumerate().filter(|(_, line)| is_it(line)).map(|(place, _)| place).collect()
    };
    match (places("ANCHOR").as_slice(), places("ANCHOR_END").as_slice()) {
        ([begin], [end]) if begin + 1 < *end => Ok((begin + 1, end - 1)),
        ([], []) => Err(format!("there is no comment // ANCHOR: {name}")),
        _ => Err(format!(
            "the region {name} needs one // ANCHOR: {name} and, below it, one // ANCHOR_END: {name}"
        )),
    }
}

/// First and last line of the item that begins with these words.
fn find_item(lines: &[&str], item: &str, docs: bool) -> Result<(usize, usize), String> {
    let begins = |line: &str| {
        let rest = without_qualifiers(line.trim_start());
        let after = [rest, line.trim_start()].into_iter().find_map(|rest| rest.strip_prefix(item));
        after.is_some_and(|after| !after.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    };
    let places: Vec<usize> =
        lines.iter().enumerate().filter(|(_, line)| begins(line)).map(|(place, _)| place).collect();
    let [begin] = places.as_slice() else {
        let places: Vec<String> = places.iter().map(|place| (place + 1).to_string()).collect();
        return Err(match places.as_slice() {
            [] => format!("no line begins with {item:?}"),
            places => format!("{item:?} begins lines {}; give more of the line", places.join(" and ")),
        });
    };
    let end = end_of_item(lines, *begin).ok_or_else(|| format!("the item {item:?} has no end"))?;
    let is_doc = |line: &str| {
        let line = line.trim_start();
        line.starts_with("///") || line.starts_with("#[") || line.starts_with("// ")
    };
    let above = lines[..*begin].iter().rev().take_while(|line| docs && is_doc(line)).count();
    Ok((begin - above, end))
}

/// The line without visibility and attributes before the item's keyword.
fn without_qualifiers(line: &str) -> &str {
    let mut rest = line;
    loop {
        let shorter = if rest.starts_with("pub(") || rest.starts_with('@') {
            // `pub(super)`, `@must_use`, `@workgroup_size(64)`
            let end = match rest.find([' ', '(']) {
                Some(place) if rest[place..].starts_with('(') => rest.find(')').map(|place| place + 1),
                place => place,
            };
            end.map(|end| &rest[end..])
        } else {
            ["pub ", "const fn", "unsafe ", "async ", "static inline ", "static "].iter().find_map(|word| {
                let after = rest.strip_prefix(word)?;
                Some(if *word == "const fn" { &rest["const ".len()..] } else { after })
            })
        };
        match shorter {
            Some(shorter) => rest = shorter.trim_start(),
            None => return rest,
        }
    }
}

/// The line with the brace or semicolon that ends the item.
fn end_of_item(lines: &[&str], begin: usize) -> Option<usize> {
    // The braces of a value do not end it; its semicolon does.
    let line = lines[begin].trim_start();
    let is_value = line.contains('=') && {
        let words = ["const ", "static ", "type ", "let ", "override ", "var", "alias "];
        words
            .iter()
            .any(|word| without_qualifiers(line).starts_with(word) || line.contains(&format!(" {word}")))
            || line.starts_with("static ")
    };
    let mut depth = 0_usize;
    let mut comment = 0_usize;
    for (place, line) in lines.iter().enumerate().skip(begin) {
        let mut rest = *line;
        while let Some(c) = rest.chars().next() {
            let mut length = c.len_utf8();
            if rest.starts_with("/*") {
                comment += 1;
                length = 2;
            } else if comment > 0 {
                if rest.starts_with("*/") {
                    comment -= 1;
                    length = 2;
                }
            } else if rest.starts_with("//") {
                break;
            } else {
                match c {
                    '"' => length = quoted(rest),
                    '\'' => length = character(rest),
                    '(' | '[' | '{' => depth += 1,
                    ')' | ']' => depth = depth.saturating_sub(1),
                    '}' => {
                        depth = depth.saturating_sub(1);
                        if depth == 0 && !is_value {
                            return Some(place);
                        }
                    }
                    ';' if depth == 0 => return Some(place),
                    _ => {}
                }
            }
            rest = &rest[length..];
        }
    }
    None
}

/// Length of a string literal on this line, quotes included.
fn quoted(text: &str) -> usize {
    let mut is_escaped = false;
    for (place, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '"' => return place + 1,
            _ => {}
        }
    }
    text.len()
}

/// Length of a character literal, or of the quote that begins a lifetime.
fn character(text: &str) -> usize {
    let inside = text[1..].chars().next().map_or(0, char::len_utf8);
    match text[1..].strip_prefix('\\') {
        Some(escape) => {
            escape.char_indices().skip(1).find(|(_, c)| *c == '\'').map_or(1, |(place, _)| place + 3)
        }
        None if text[1 + inside..].starts_with('\'') => inside + 2,
        None => 1,
    }
}

fn without_indentation(lines: &[&str]) -> String {
    let indentation = |line: &&&str| line.len() - line.trim_start().len();
    let filled = lines.iter().filter(|line| !line.trim().is_empty());
    let common = filled.map(|line| indentation(&line)).min().unwrap_or(0);
    let cut = lines.iter().map(|line| line.get(common..).unwrap_or("").trim_end());
    cut.fold(String::new(), |text, line| text + line + "\n")
}

#[cfg(test)]
mod tests;
