//! Import circles: files that use each other, found in their `use` declarations and paths.

use std::collections::{BTreeMap, BTreeSet};

/// The path of a module from the root of the crate. A file is a module.
pub type Module = Vec<String>;

/// A name that a `use` declaration brings in, and its path.
struct Import {
    name: String,
    path: Vec<String>,
    is_public: bool,
}

/// The `use` declarations of a file, and the rest of its code.
fn split(code: &str) -> (Vec<Import>, String) {
    let (mut imports, mut rest, mut lines) = (Vec::new(), String::new(), code.lines());
    while let Some(line) = lines.next() {
        let trimmed = line.trim_start();
        let (visibility, declared) = trimmed.split_once("use ").unwrap_or((trimmed, ""));
        if declared.is_empty() || !(visibility.is_empty() || visibility.starts_with("pub")) {
            rest.extend([line, "\n"]);
            continue;
        }
        let mut tree = declared.to_owned();
        while !tree.contains(';') {
            tree += lines.next().unwrap_or(";").trim();
        }
        let tree = tree.split(';').next().unwrap_or_default();
        imports.extend(leaves(tree).into_iter().map(|leaf| import(&leaf, !visibility.is_empty())));
    }
    (imports, rest)
}

/// The paths of a tree: `a::{b, c::d}` has `a::b` and `a::c::d`.
fn leaves(tree: &str) -> Vec<String> {
    let Some((prefix, group)) = tree.split_once('{') else { return vec![tree.trim().to_owned()] };
    let (mut found, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        if depth == 0 && matches!(c, ',' | '}') {
            let inside = leaves(&group[start..at]).into_iter().filter(|leaf| !leaf.is_empty());
            found.extend(inside.map(|leaf| format!("{}{leaf}", prefix.trim())));
            start = at + 1;
        }
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
    }
    found
}

fn import(leaf: &str, is_public: bool) -> Import {
    let (path, alias) = leaf.split_once(" as ").map_or((leaf, None), |(path, alias)| (path, Some(alias)));
    let path: Vec<String> = path.trim_end_matches("::self").split("::").map(str::to_owned).collect();
    let name = alias.or(path.last().map(String::as_str)).unwrap_or_default().trim().to_owned();
    Import { name, path, is_public }
}

/// The parts of a code that can be names and paths.
fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_' && c != ':')
}

struct Crate<'a>(BTreeMap<&'a Module, (Vec<Import>, String)>);

impl Crate<'_> {
    /// The file that defines what a path in the file `from` leads to; `None` if it is another crate's.
    fn resolve(&self, from: &Module, path: &[String]) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let child = |of: &Module, name: &String| {
            let child = [of.as_slice(), std::slice::from_ref(name)].concat();
            self.0.contains_key(&child).then_some(child)
        };
        let mut at = match first.as_str() {
            "crate" => Module::new(),
            "self" => from.clone(),
            "super" => from.split_last()?.1.to_vec(),
            _ => child(from, first)?,
        };
        while let Some((name, after)) = rest.split_first() {
            if name == "super" {
                at.pop();
            } else if let Some(module) = child(&at, name) {
                at = module;
            } else {
                // A module may re-export what another defines.
                let imports = &self.0.get(&at)?.0;
                let passed = imports.iter().find(|import| import.name == *name);
                let path = passed.map(|import| [import.path.as_slice(), after].concat());
                return path.and_then(|path| self.resolve(&at, &path)).or(Some(at));
            }
            rest = after;
        }
        Some(at)
    }

    /// The files that a file uses, except for the modules that it is part of. A re-export alone does not count.
    fn used_by(&self, file: &Module) -> BTreeSet<Module> {
        let (imports, rest) = &self.0[file];
        let names: BTreeSet<&str> = words(rest).flat_map(|word| word.split("::")).collect();
        let imported = imports.iter().filter(|import| !import.is_public || names.contains(&*import.name));
        let inline = words(rest).filter(|word| word.contains("::")).map(|word| {
            let path: Vec<String> = word.split("::").map(str::to_owned).collect();
            let known = imports.iter().find(|import| import.name == path[0]);
            known.map_or(path.clone(), |known| [&known.path, &path[1..]].concat())
        });
        let paths = imported.map(|import| import.path.clone()).chain(inline);
        paths.filter_map(|path| self.resolve(file, &path)).filter(|used| !file.starts_with(used)).collect()
    }
}

/// The files of each circle.
pub fn circles(sources: &BTreeMap<Module, String>) -> BTreeSet<BTreeSet<String>> {
    let files = Crate(sources.iter().map(|(module, code)| (module, split(code))).collect());
    let uses: BTreeMap<&Module, BTreeSet<Module>> =
        sources.keys().map(|file| (file, files.used_by(file))).collect();
    let reached = |file: &Module| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![file]);
        while let Some(file) = open.pop() {
            open.extend(uses[file].iter().filter(|used| reached.insert((*used).clone())));
        }
        reached
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> =
        sources.keys().map(|file| (file, reached(file))).collect();
    let around = |file: &&Module| -> BTreeSet<String> {
        let back = reached[*file].iter().filter(|other| reached[*other].contains(*file));
        back.map(|other| other.join("::")).collect()
    };
    sources.keys().map(|file| around(&file)).filter(|circle| !circle.is_empty()).collect()
}
