//! Dependencies between rooms: each room may use only the rooms listed for it, and within the window each file only
//! those listed for it. Lower layers come first, and an unused permission is an error. ARCHITECTURE.md describes the layers.

#![allow(clippy::expect_used, reason = "a test that cannot read the sources has failed")]

mod rooms;
mod sources;
mod window;

use rooms::{CRATES, ROOMS};
use sources::{SourceFile, file_of, sources};
use std::collections::BTreeSet;
use window::{TOP, WINDOW};

/// Compares actual uses with the permissions. Reports uses that are not allowed, unused permissions, and uses of
/// higher layers.
fn faults(allowed: &[(&str, &[&str])], uses: &BTreeSet<(String, String, String)>) -> BTreeSet<String> {
    let mut faults = BTreeSet::new();
    let may = |user: &str| allowed.iter().find(|(name, _)| *name == user).map(|(_, used)| *used);
    for (user, used, file) in uses {
        match may(user) {
            None => _ = faults.insert(format!("{user} is not listed")),
            Some(list) if !list.contains(&used.as_str()) => {
                faults.insert(format!("{user} uses {used} in {file}"));
            }
            Some(_) => {}
        }
    }
    for (place, (user, list)) in allowed.iter().enumerate() {
        for used in *list {
            if !uses.iter().any(|(a, b, _)| a == user && b == used) {
                faults.insert(format!("{user} may use {used}, which it does not"));
            }
            if !allowed[..place].iter().any(|(lower, _)| lower == used) {
                faults.insert(format!("{user} uses {used}, which does not stand before it"));
            }
        }
    }
    faults
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let sources = sources();
    let mut uses = BTreeSet::new();
    for source in sources.iter().filter(|source| !matches!(source.room(), "lib" | "main")) {
        for path in source.used.iter().chain(&source.handed_on) {
            let is_room = |name: &String| sources.iter().any(|source| source.room() == name);
            if let Some(used) = path.first().filter(|name| is_room(name) && *name != source.room()) {
                uses.insert((source.room().to_owned(), used.clone(), source.name.clone()));
            }
        }
    }
    let faults = faults(ROOMS, &uses);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn files_of_the_window_use_only_those_below_them() {
    let sources = sources();
    let mut uses = BTreeSet::new();
    for source in sources.iter().filter(|source| source.room() == "app") {
        let part = source.window_part();
        for path in source.used.iter().chain(&source.handed_on).filter(|path| path[0] == "app") {
            let used = file_of(&sources, path).map_or("mod", SourceFile::window_part);
            if used != part {
                uses.insert((part.to_owned(), used.to_owned(), source.name.clone()));
            }
        }
    }
    let faults = faults(WINDOW, &uses);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn only_the_top_knows_the_whole_window_and_the_model_no_drawing() {
    for source in sources().iter().filter(|source| source.room() == "app") {
        let names = |word: &str| {
            // A floating panel of egui's is not the window.
            let code = source.code.replace("egui::Window", "");
            let mut words = code.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
            words.any(|found| found == word)
        };
        let is_top = TOP.contains(&source.window_part());
        assert!(is_top || !names("Window"), "{} knows the whole window", source.name);
        let is_model = source.window_part() == "model";
        assert!(!is_model || !(names("egui") || names("eframe")), "{} knows of drawing", source.name);
    }
}

#[test]
fn files_import_each_other_in_no_circle() {
    let sources = sources();
    let place = |source: &SourceFile| sources.iter().position(|other| other.name == source.name);
    let mut reached: Vec<BTreeSet<usize>> = Vec::new();
    for source in &sources {
        let used = source.used.iter().filter_map(|path| place(file_of(&sources, path)?));
        // A folder's main file and the other files in it may use each other, except in the window.
        let is_inside = |other: &SourceFile| {
            if source.room() == "app" {
                return false;
            }
            let folder =
                |a: &SourceFile, b: &SourceFile| a.name.ends_with("mod") && b.module.starts_with(&a.module);
            folder(source, other) || folder(other, source)
        };
        let others = used.filter(|used| sources[*used].name != source.name);
        reached.push(others.filter(|used| !is_inside(&sources[*used])).collect());
    }
    loop {
        let before = reached.clone();
        for set in &mut reached {
            let further: Vec<usize> = set.iter().flat_map(|next| before[*next].clone()).collect();
            set.extend(further);
        }
        if reached == before {
            break;
        }
    }
    let circles: BTreeSet<Vec<&str>> = (0..sources.len())
        .filter(|start| reached[*start].contains(start))
        .map(|start| {
            let back = reached[start].iter().filter(|other| reached[**other].contains(&start));
            back.map(|other| sources[*other].name.as_str()).collect()
        })
        .collect();
    assert!(circles.is_empty(), "{circles:?}");
}

#[test]
fn crates_stay_in_their_rooms() {
    let sources = sources();
    let mut faults = BTreeSet::new();
    for (name, rooms) in CRATES {
        let users: BTreeSet<&str> = sources
            .iter()
            .filter(|source| source.code.contains(&format!("{name}::")))
            .map(SourceFile::room)
            .collect();
        let listed: BTreeSet<&str> = rooms.iter().copied().collect();
        faults.extend(users.difference(&listed).map(|room| format!("{room} uses {name}")));
        faults.extend(
            listed.difference(&users).map(|room| format!("{room} may use {name}, which it does not")),
        );
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
