//! The source files and the paths that they use.

use std::fs;
use std::path::{Path, PathBuf};

fn source_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(at: &Path, into: &mut Vec<PathBuf>) {
    if at.is_dir() {
        for entry in fs::read_dir(at).expect("readable") {
            rust_files(&entry.expect("readable").path(), into);
        }
    } else if at.extension().is_some_and(|ending| ending == "rs") && !at.ends_with("tests.rs") {
        // Tests may use anything.
        into.push(at.to_owned());
    }
}

/// A source file.
pub struct SourceFile {
    /// Path below `src`, without the extension.
    pub name: String,
    /// The names of its module path.
    pub module: Vec<String>,
    /// The code without comments and tests; tests may use anything.
    pub code: String,
    /// The paths that the code uses, from the crate's root, except those of `pub use`.
    pub used: Vec<Vec<String>>,
    /// Paths that are exported with `pub use`.
    pub handed_on: Vec<Vec<String>>,
}

impl SourceFile {
    fn read(file: &Path) -> SourceFile {
        let name = file.strip_prefix(source_root()).expect("below src").with_extension("");
        let mut module: Vec<String> =
            name.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        if module.last().is_some_and(|last| last == "mod") {
            module.pop();
        }
        let text = fs::read_to_string(file).expect("UTF-8");
        let before_tests = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let lines = before_tests.lines().filter(|line| !line.trim_start().starts_with("//"));
        let code = lines.collect::<Vec<_>>().join("\n");
        let children: Vec<&str> =
            code.lines().filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod ")).collect();
        let is_child = |name: &str| children.iter().any(|child| child.trim_end_matches(';') == name);
        let (mut used, mut handed_on) = (Vec::new(), Vec::new());
        let mut rest = code.as_str();
        while let Some(at) = rest.find(|c: char| c.is_ascii_alphabetic() || c == '_') {
            let before = &rest[..at];
            rest = &rest[at..];
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            let is_start = !before.ends_with("::");
            let is_import = before.ends_with("use ");
            let is_path = after.starts_with("::") && (word == "crate" || word == "super" || word == "self");
            if is_start && (is_path || (after.starts_with("::") && is_child(word))) {
                let mut found = Vec::new();
                rest = paths(rest, &mut Vec::new(), &mut found);
                let is_public = is_import && before.contains("pub");
                let from_root = found.into_iter().filter_map(|path| absolute(&module, &path, &is_child));
                if is_public { &mut handed_on } else { &mut used }.extend(from_root);
            } else {
                rest = after;
            }
        }
        let name = name.to_string_lossy().replace('\\', "/");
        SourceFile { name, module, code, used, handed_on }
    }

    /// The room that the file belongs to: the first part of its path.
    pub fn room(&self) -> &str {
        self.name.split('/').next().unwrap_or_default()
    }

    /// The file or folder of the window that the file belongs to.
    pub fn window_part(&self) -> &str {
        self.name.split('/').nth(1).unwrap_or_default()
    }
}

/// Parses a path with groups, as in `a::{b, c::d}`. Returns the text after it.
fn paths<'a>(mut text: &'a str, before: &mut Vec<String>, found: &mut Vec<Vec<String>>) -> &'a str {
    let depth = before.len();
    loop {
        text = text.trim_start();
        if let Some(group) = text.strip_prefix('{') {
            text = group;
            while !text.trim_start().starts_with('}') && !text.is_empty() {
                text = paths(text, before, found).trim_start();
                text = text.strip_prefix(',').unwrap_or(text);
            }
            text = text.trim_start().strip_prefix('}').unwrap_or_default();
            break;
        }
        let end = text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(text.len());
        if end == 0 {
            // A star, or something that is not a path.
            found.push(before.clone());
            text = text.strip_prefix('*').unwrap_or_else(|| text.get(1..).unwrap_or_default());
            break;
        }
        before.push(text[..end].to_owned());
        text = &text[end..];
        if let Some(rest) = text.strip_prefix("::") {
            text = rest;
            continue;
        }
        found.push(before.clone());
        if let Some(renamed) = text.strip_prefix(" as ") {
            let end = renamed.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(renamed.len());
            text = &renamed[end..];
        }
        break;
    }
    before.truncate(depth);
    text
}

/// The path from the crate's root, as `module` writes it.
fn absolute(module: &[String], path: &[String], is_child: &dyn Fn(&str) -> bool) -> Option<Vec<String>> {
    let mut at = module.to_vec();
    let mut rest = path;
    match rest.first().map(String::as_str) {
        Some("crate") => {
            at.clear();
            rest = &rest[1..];
        }
        Some("self") => rest = &rest[1..],
        Some("super") => {}
        Some(child) if is_child(child) => {}
        _ => return None,
    }
    while rest.first().is_some_and(|first| first == "super") {
        at.pop();
        rest = &rest[1..];
    }
    at.extend_from_slice(rest);
    at.retain(|part| part != "self");
    Some(at)
}

/// All source files.
pub fn sources() -> Vec<SourceFile> {
    let mut files = Vec::new();
    rust_files(&source_root(), &mut files);
    assert!(files.len() > 30, "the sources were not found");
    files.sort();
    files.iter().map(|file| SourceFile::read(file)).collect()
}

/// The file that a path leads to, through folders that export names of their files.
pub fn file_of<'a>(sources: &'a [SourceFile], path: &[String]) -> Option<&'a SourceFile> {
    let module = sources.iter().filter(|source| path.starts_with(&source.module));
    let module = module.max_by_key(|source| source.module.len())?;
    let item = path.get(module.module.len());
    let handed_on = item.and_then(|item| module.handed_on.iter().find(|path| path.last() == Some(item)));
    match handed_on {
        Some(from) if from != path => file_of(sources, from),
        _ => Some(module),
    }
}
