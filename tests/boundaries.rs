//! Who knows whom: each room may use only the rooms listed for it. The layers are in ARCHITECTURE.md.

#![allow(clippy::expect_used, reason = "a test that cannot read the sources has failed")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A room and the rooms that it may use. Lower layers first.
const ROOMS: &[(&str, &[&str])] = &[
    ("memory", &[]),
    ("input", &["memory"]),
    ("scene", &[]),
    ("stages", &["scene"]),
    ("film", &["memory", "input", "stages"]),
    ("render", &["memory", "scene", "stages", "film"]),
    ("record", &[]),
    ("heat", &[]),
    ("recipe", &["memory", "input", "scene", "stages", "film", "render"]),
    ("output", &["memory", "input", "stages", "film"]),
    ("chart", &["film"]),
    ("sampling", &["render"]),
    ("kernel", &["scene", "stages", "film", "render", "sampling"]),
    ("tables", &["scene", "stages", "film", "render", "kernel"]),
    ("render_cpu", &["stages", "film", "render", "record", "sampling", "kernel", "tables"]),
    ("render_gpu", &["stages", "film", "render", "record", "sampling", "kernel", "tables"]),
    ("layers", &["scene", "render", "record", "render_cpu"]),
    ("backends", &["film", "render", "render_cpu", "render_gpu"]),
    ("progressive", &["stages", "film", "heat", "render", "backends"]),
    ("describe", &["scene", "stages", "film", "render", "recipe", "progressive"]),
    ("control", &["scene", "render"]),
    ("console", &[]),
    ("failure", &["console"]),
    ("interrupt", &["console", "failure"]),
    ("statistics", &[]),
    (
        "cli",
        &[
            "memory",
            "scene",
            "stages",
            "film",
            "render",
            "recipe",
            "output",
            "render_cpu",
            "render_gpu",
            "backends",
            "progressive",
            "chart",
            "failure",
        ],
    ),
    ("terminal", &["film", "cli", "console", "failure"]),
    (
        "batch",
        &[
            "scene",
            "stages",
            "film",
            "render",
            "recipe",
            "output",
            "render_cpu",
            "render_gpu",
            "backends",
            "progressive",
            "cli",
            "console",
            "describe",
            "failure",
            "interrupt",
            "terminal",
        ],
    ),
    (
        "bench",
        &[
            "scene",
            "film",
            "recipe",
            "render",
            "tables",
            "render_cpu",
            "render_gpu",
            "backends",
            "chart",
            "cli",
            "control",
            "failure",
            "interrupt",
            "terminal",
            "statistics",
        ],
    ),
    (
        "report",
        &[
            "input",
            "stages",
            "film",
            "render",
            "recipe",
            "output",
            "backends",
            "progressive",
            "statistics",
            "chart",
            "cli",
            "console",
            "control",
            "failure",
            "interrupt",
            "terminal",
        ],
    ),
    (
        "compare",
        &[
            "memory",
            "film",
            "heat",
            "render",
            "recipe",
            "output",
            "backends",
            "statistics",
            "cli",
            "failure",
            "terminal",
        ],
    ),
    (
        "diff",
        &[
            "scene",
            "stages",
            "film",
            "render",
            "record",
            "render_cpu",
            "render_gpu",
            "backends",
            "cli",
            "console",
            "failure",
            "terminal",
        ],
    ),
    (
        "stress",
        &[
            "scene",
            "stages",
            "film",
            "render",
            "recipe",
            "output",
            "sampling",
            "render_cpu",
            "backends",
            "cli",
            "failure",
            "interrupt",
            "terminal",
        ],
    ),
];

/// Crates that only some rooms may use.
const CRATES: &[(&str, &[&str])] = &[
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("egui_plot", &["app"]),
    ("rfd", &["app"]),
    ("wgpu", &["render_gpu"]),
    ("rayon", &["tables", "render_cpu", "render_gpu", "layers"]),
    ("fearless_simd", &["render_cpu"]),
    ("obvhs", &["tables"]),
    ("libm", &["statistics"]),
    ("image", &["output", "compare"]),
    ("indicatif", &["terminal", "report"]),
    ("plotters", &["chart"]),
    ("clap", &["cli", "failure"]),
    ("ctrlc", &["interrupt"]),
    ("signal_hook", &["interrupt"]),
];

fn source_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(at: &Path, into: &mut Vec<PathBuf>) {
    if at.is_dir() {
        for entry in fs::read_dir(at).expect("readable") {
            rust_files(&entry.expect("readable").path(), into);
        }
    } else if at.extension().is_some_and(|ending| ending == "rs") {
        into.push(at.to_owned());
    }
}

/// The room that a file belongs to: the first part of its path below `src`.
fn room_of(file: &Path) -> String {
    let below = file.strip_prefix(source_root()).expect("below src");
    let first = below.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

/// The code of a file without comments and without its tests, which may use any room.
fn code_of(file: &Path) -> String {
    let text = fs::read_to_string(file).expect("UTF-8");
    let before_tests = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    before_tests.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

fn names_after<'a>(code: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    code.match_indices(prefix).map(move |(at, _)| {
        let rest = &code[at + prefix.len()..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    })
}

fn files() -> Vec<PathBuf> {
    let mut files = Vec::new();
    rust_files(&source_root(), &mut files);
    assert!(files.len() > 30, "the sources were not found");
    files
}

#[test]
fn rooms_use_only_the_rooms_below_them() {
    let mut faults = BTreeSet::new();
    for file in files() {
        let room = room_of(&file);
        let Some((_, allowed)) = ROOMS.iter().find(|(name, _)| *name == room) else { continue };
        for used in names_after(&code_of(&file), "crate::") {
            let is_room = ROOMS.iter().any(|(name, _)| *name == used) || used == "app";
            if is_room && used != room && !allowed.contains(&used) {
                faults.insert(format!("{room} uses {used} in {}", file.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn crates_stay_in_their_rooms() {
    let mut faults = BTreeSet::new();
    for file in files() {
        let (room, code) = (room_of(&file), code_of(&file));
        for (name, rooms) in CRATES {
            if code.contains(&format!("{name}::")) && !rooms.contains(&room.as_str()) {
                faults.insert(format!("{room} uses {name} in {}", file.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
