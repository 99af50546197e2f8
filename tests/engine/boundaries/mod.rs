//! Dependencies between rooms: each room may use only the rooms and crates listed for it. Lower layers come first, and
//! an unused permission is an error. ARCHITECTURE.md describes the layers. Within rooms, no files import each other in
//! a circle.

mod circles;
mod rooms;

use circles::{Module, circles};
use rooms::{CRATES, ROOMS};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The code of each file, without comments and tests, which may use anything.
fn sources() -> BTreeMap<Module, String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = BTreeMap::new();
    let mut places: Vec<PathBuf> = vec![root.clone()];
    while let Some(place) = places.pop() {
        if place.is_dir() {
            places
                .extend(fs::read_dir(place).expect("readable").map(|entry| entry.expect("readable").path()));
        } else if place.extension().is_some_and(|ending| ending == "rs") && !place.ends_with("tests.rs") {
            let path = place.strip_prefix(&root).expect("below src").with_extension("");
            let names = path.iter().map(|name| name.to_string_lossy().into_owned());
            let module = names.filter(|name| !["lib", "mod"].contains(&name.as_str())).collect();
            let text = fs::read_to_string(&place).expect("UTF-8");
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            sources.insert(module, lines.flat_map(|line| [line, "\n"]).collect());
        }
    }
    assert!(!sources.is_empty(), "the sources were not found");
    sources
}

/// The code of each room.
fn rooms() -> BTreeMap<String, String> {
    let mut rooms: BTreeMap<String, String> = BTreeMap::new();
    for (module, code) in sources() {
        if let Some(room) = module.first().filter(|room| *room != "main") {
            *rooms.entry(room.clone()).or_default() += &code;
        }
    }
    rooms
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let found = circles(&sources());
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn circles_are_found_through_re_exports_and_paths() {
    let circle = |files: &[(&str, &str)]| {
        let module =
            |path: &str| path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
        let sources = files.iter().map(|(path, code)| (module(path), (*code).to_owned())).collect();
        circles(&sources).into_iter().flatten().collect::<Vec<_>>()
    };
    let tree = |back: &'static str| {
        let root = ("", "pub mod a;\npub mod b;\n");
        let b = ("b", "mod part;\npub use part::{Part as Piece,\n    Other};\n");
        circle(&[root, ("a", "use crate::b::{Piece, Other};\npub struct Own;\n"), b, ("b::part", back)])
    };
    for back in
        ["use crate::a::Own;\n", "fn f() -> crate::a::Own {}\n", "use crate::{a};\nfn f() -> a::Own {}\n"]
    {
        assert_eq!(tree(back), ["a", "b::part"], "{back}");
    }
    for harmless in ["", "use std::a::Own;\n", "pub struct Own;\n"] {
        assert!(tree(harmless).is_empty(), "{harmless}");
    }
    let parent = ("b", "mod part;\nuse part::Part;\npub struct Own(Part);\n");
    assert!(
        circle(&[parent, ("b::part", "pub struct Part(super::Own);\n")]).is_empty(),
        "a module and its part"
    );
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let rooms = rooms();
    let mut faults = Vec::new();
    let mut lower: Vec<&str> = Vec::new();
    for row in ROOMS.lines() {
        let (name, listed) = row.split_once(':').expect("a room and what it uses");
        let listed: BTreeSet<&str> = listed.split_whitespace().collect();
        let code = rooms.get(name).map_or("", String::as_str);
        let uses = code.split("crate::").skip(1).map(|path| {
            let end = path.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            &path[..end.unwrap_or(path.len())]
        });
        let used: BTreeSet<&str> = uses.filter(|used| *used != name && rooms.contains_key(*used)).collect();
        if used != listed {
            let row: Vec<&str> = used.iter().copied().collect();
            faults.push(format!("the sources say {name}: {}", row.join(" ")));
        }
        let higher: Vec<&&str> = used.iter().filter(|used| !lower.contains(used)).collect();
        if !higher.is_empty() {
            faults.push(format!("{name} uses {higher:?}, which must stand before it"));
        }
        lower.push(name);
    }
    let missing: Vec<&String> = rooms.keys().filter(|room| !lower.contains(&room.as_str())).collect();
    assert!(faults.is_empty() && missing.is_empty(), "not listed: {missing:?}; {faults:#?}");
}

#[test]
fn crates_stay_in_their_rooms() {
    for (name, listed) in CRATES {
        let path = format!("{name}::");
        let users: BTreeSet<String> =
            rooms().into_iter().filter(|(_, code)| code.contains(&path)).map(|(room, _)| room).collect();
        let listed: BTreeSet<String> = listed.iter().map(|room| (*room).to_owned()).collect();
        assert_eq!(users, listed, "{name}");
    }
}
