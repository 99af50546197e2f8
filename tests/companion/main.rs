//! `weekender companion` as a program: the page, its links, its HTML, and what it says about faulty texts.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod faults;
#[path = "../gpu_common/mod.rs"]
mod gpu_common;
mod html;
#[path = "../html_common/mod.rs"]
mod html_common;
mod valid;

use html::Html;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Most bytes of the page and its quick stills.
const SIZE_LIMIT: u64 = 5_000_000;

fn companion(out: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.arg("companion").arg("--out").arg(out).args(["--quick", "--progress", "off"]).args(arguments);
    command.stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A page with quick stills, made once for all tests.
struct Built {
    directory: TempDir,
    said: String,
    html: String,
}

static PAGE: LazyLock<Built> = LazyLock::new(|| {
    let directory = TempDir::new().unwrap();
    let output = companion(directory.path(), &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let html = std::fs::read_to_string(directory.path().join("index.html")).unwrap();
    Built { said: text(&output.stdout), html, directory }
});

fn checkout() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_page_and_its_stills_are_small() {
    let directory = PAGE.directory.path();
    let stills: Vec<PathBuf> =
        std::fs::read_dir(directory.join("figures")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let bytes: u64 = stills.iter().map(|still| still.metadata().unwrap().len()).sum();
    let page = PAGE.html.len() as u64;
    eprintln!("index.html has {} KiB, {} quick stills have {} KiB", page >> 10, stills.len(), bytes >> 10);
    assert!(page + bytes < SIZE_LIMIT, "{page} + {bytes} bytes");
    assert!(PAGE.said.contains("index.html"), "{}", PAGE.said);
}

#[test]
fn only_what_changed_is_rendered_again() {
    let directory = PAGE.directory.path();
    let again = companion(directory, &[]);
    assert!(text(&again.stdout).starts_with("0 figures rendered"), "{}", text(&again.stdout));
}

#[test]
fn references_are_in_the_order_of_their_file() {
    let file = std::fs::read_to_string(checkout().join("docs/companion/references.toml")).unwrap();
    let keys = file.lines().filter_map(|line| line.strip_prefix('[')?.strip_suffix(']'));
    let html = Html::new(&PAGE.html);
    let ids: Vec<&str> = html.ids().into_iter().filter_map(|id| id.strip_prefix("ref-")).collect();
    assert_eq!(keys.collect::<Vec<_>>(), ids);
}

#[test]
fn every_link_leads_somewhere() {
    let html = Html::new(&PAGE.html);
    let ids = html.ids();
    let unique: std::collections::BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(unique.len(), ids.len(), "an id occurs twice");
    for target in html.values("href") {
        match target.strip_prefix('#') {
            Some(id) => assert!(unique.contains(id), "nothing has the id {id}"),
            None => {
                let is_web = target.starts_with("https://") && !target.contains([' ', '<', '"']);
                assert!(is_web || target == "data:,", "{target}");
            }
        }
    }
    for name in ["aria-labelledby", "aria-describedby", "for"] {
        for id in html.values(name).into_iter().flat_map(str::split_whitespace) {
            assert!(unique.contains(id), "{name}={id}");
        }
    }
    for source in html.values("src") {
        assert!(PAGE.directory.path().join(source).is_file(), "{source}");
    }
    let alts = html.values("alt");
    assert!(alts.len() == html.values("src").len() && alts.iter().all(|alt| alt.len() > 20), "{alts:?}");
}

#[test]
fn nothing_is_loaded_from_elsewhere() {
    for part in ["src=\"http", "url(http", "url(//", "@import", "<link rel=\"stylesheet\"", "<iframe"] {
        assert!(!PAGE.html.contains(part), "{part}");
    }
}

#[test]
fn the_page_has_its_parts() {
    let html = Html::new(&PAGE.html);
    let ids = html.ids();
    for id in [
        "content",
        "contents",
        "figure-normals",
        "figure-book",
        "normals",
        "glossary",
        "term-lane",
        "live-data",
    ] {
        assert!(ids.contains(&id), "{id}");
    }
    let count = |part: &str| PAGE.html.matches(part).count();
    assert!(count("<figure class=\"code\"") > 30, "excerpts");
    assert!(count("<math") > 30, "formulas");
    assert!(count("data-stage=") > 25, "stages");
    // Nothing of the texts' own notation is left.
    for part in ["{{", "}}", "[@", "](glossary:", "](book:", "](page:"] {
        let body = PAGE.html.split("<main").nth(1).unwrap().split("<script").next().unwrap();
        let at = body.find(part).map(|place| &body[place.saturating_sub(80)..(place + 80).min(body.len())]);
        assert_eq!(at, None, "{part}");
    }
}

#[test]
fn a_benchmark_can_be_shown_instead_of_the_kept_one() {
    let directory = TempDir::new().unwrap();
    let kept = checkout().join("docs/companion/measured/speed.json");
    let own =
        std::fs::read_to_string(kept).unwrap().replace("\"processor\": \"", "\"processor\": \"Reader's ");
    let file = directory.path().join("own.json");
    std::fs::write(&file, own).unwrap();
    // The stills of the other page are used again.
    let output = companion(PAGE.directory.path(), &["--bench", file.to_str().unwrap()]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let html = std::fs::read_to_string(PAGE.directory.path().join("index.html")).unwrap();
    assert!(html.contains("Reader's "), "the processor's name");

    std::fs::write(&file, "{}").unwrap();
    let refused = companion(&directory.path().join("out"), &["--bench", file.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("weekender bench --json"), "{}", text(&refused.stderr));
    assert!(!directory.path().join("out").exists());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_the_page_and_says_how_to_go_on() {
    let directory = TempDir::new().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.arg("companion").arg("--out").arg(directory.path()).args(["--progress", "on"]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    // The first line of progress: a figure is being rendered.
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let signalled = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    said.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
    assert!(line.contains("figures missing; run the same command again to go on"), "{line}");
    assert!(directory.path().join("index.html").exists());
}
