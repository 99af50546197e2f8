//! `weekender companion` as a program: the page, its links and HTML, and its messages about faulty texts.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod browser;
mod faults;
#[path = "../gpu_common/mod.rs"]
mod gpu_common;
mod html;
#[path = "../html_common/mod.rs"]
mod html_common;
#[path = "../program_common/mod.rs"]
mod program_common;

use html::Html;
use html_common::assert_valid;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Most bytes of the page and its quick stills.
const SIZE_LIMIT: u64 = 6_000_000;

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
    html: String,
}

static PAGE: LazyLock<Built> = LazyLock::new(|| {
    let directory = TempDir::new().unwrap();
    let output = companion(directory.path(), &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let html = std::fs::read_to_string(directory.path().join("index.html")).unwrap();
    Built { html, directory }
});

fn checkout() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn page_is_valid_small_and_rendered_once() {
    let directory = PAGE.directory.path();
    assert_valid(&directory.join("index.html"));
    let size = |folder| -> u64 {
        let files = std::fs::read_dir(directory.join(folder)).unwrap();
        files.map(|file| file.unwrap().metadata().unwrap().len()).sum()
    };
    let bytes = size("figures") + size("figures/more");
    assert!(PAGE.html.len() as u64 + bytes < SIZE_LIMIT, "{} + {bytes} bytes", PAGE.html.len());
    let again = companion(directory, &[]);
    assert!(text(&again.stdout).starts_with("0 pictures rendered"), "{}", text(&again.stdout));
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
                let is_file = PAGE.directory.path().join(target).is_file();
                assert!(is_web || is_file || target == "data:,", "{target}");
            }
        }
    }
    for name in ["aria-labelledby", "aria-describedby", "for"] {
        for id in html.values(name).into_iter().flat_map(str::split_whitespace) {
            assert!(unique.contains(id), "{name}={id}");
        }
    }
    assert!(!html.values("data-set").is_empty());
    for source in html.values("src") {
        assert!(PAGE.directory.path().join(source).is_file(), "{source}");
    }
    let alts = html.values("alt");
    assert!(alts.len() == html.values("src").len() && alts.iter().all(|alt| alt.len() > 20), "{alts:?}");
}

#[test]
fn page_is_complete_and_self_contained() {
    let ids = Html::new(&PAGE.html).ids();
    for id in ["content", "contents", "figure-normals", "normals", "glossary", "term-lane", "live-data"] {
        assert!(ids.contains(&id), "{id}");
    }
    let count = |part: &str| PAGE.html.matches(part).count();
    assert!(count("<figure class=\"code") > 60 && count("<math") > 30 && count("data-stage=") > 25);
    let body = PAGE.html.split("<main").nth(1).unwrap().split("<script").next().unwrap();
    // None of the texts' own notation remains.
    for part in ["{{", "}}", "[@", "](glossary:", "](book:", "](page:"] {
        assert!(!body.contains(part), "{part}");
    }
    for part in ["src=\"http", "url(http", "url(//", "@import", "<link rel=\"stylesheet\"", "<iframe"] {
        assert!(!PAGE.html.contains(part), "{part}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_page_and_tells_how_to_resume() {
    let directory = TempDir::new().unwrap();
    let mut command =
        program_common::weekender(directory.path(), &["companion", "--out", ".", "--progress", "on"]);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    // The first line of progress means that a figure is being rendered.
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    let signalled = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    said.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
    assert!(line.contains("pictures missing; run the same command again to go on"), "{line}");
    assert!(directory.path().join("index.html").exists());
}

/// The small pictures come first and have no progress of their own; a quick still is done in one pass.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_quick_pictures() {
    let directory = TempDir::new().unwrap();
    assert!(companion(directory.path(), &[]).status.success());
    let figures = directory.path().join("figures");
    for (removed, first) in [(figures.join("more"), "more"), (figures.clone(), "sky.png")] {
        std::fs::remove_dir_all(removed).unwrap();
        let arguments = ["companion", "--quick", "--out", ".", "--progress", "off"];
        let mut command = program_common::weekender(directory.path(), &arguments);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let (start, first) = (std::time::Instant::now(), figures.join(first));
        while !first.is_file() && first.read_dir().map_or(0, Iterator::count) == 0 {
            assert!(start.elapsed().as_secs() < 120, "no picture was written");
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        let signalled = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
        assert!(signalled.success());
        let output = child.wait_with_output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(130), "{message}");
        assert!(message.contains("pictures missing; run the same command again"), "{message}");
    }
    assert!(!figures.join("book.png").exists());
}
