//! `weekender companion` as a program: the page, its links and HTML, and its messages about faulty texts.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod browser;
mod check;
#[path = "../common/mod.rs"]
mod common;
mod faults;
#[path = "../html_common/mod.rs"]
mod html_common;

use crate::common::program::{outcome, signal, until, weekender};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;
use std::sync::LazyLock;
use tempfile::TempDir;

/// Maximum size of the page and its quick stills, bytes.
const SIZE_LIMIT: u64 = 6_000_000;

const QUICK: [&str; 6] = ["companion", "--quick", "--progress", "off", "--out", "out"];

/// Makes a page with quick stills in `out`. Exit code, standard output and messages.
fn companion(directory: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    outcome(&weekender(directory, &[&QUICK, arguments].concat()).output().unwrap())
}

/// A page with quick stills, made once for all tests.
static PAGE: LazyLock<TempDir> = LazyLock::new(|| {
    let directory = TempDir::new().unwrap();
    let (code, _, message) = companion(directory.path(), &[]);
    assert_eq!(code, Some(0), "{message}");
    directory
});

#[test]
fn page_is_whole_small_and_rendered_once() {
    let directory = PAGE.path().join("out");
    let page = html_common::assert_whole(&directory);
    let size = |folder| -> u64 {
        let files = std::fs::read_dir(directory.join(folder)).unwrap();
        files.map(|file| file.unwrap().metadata().unwrap().len()).sum()
    };
    let later = std::fs::metadata(directory.join("later.js")).unwrap().len();
    let bytes = size("figures") + size("figures/more") + later;
    assert!(page.len() as u64 + bytes < SIZE_LIMIT, "{} + {bytes} bytes", page.len());
    let (_, again, _) = companion(PAGE.path(), &[]);
    assert!(again.starts_with("0 pictures rendered"), "{again}");

    for id in ["content", "contents", "figure-normals", "normals", "glossary", "term-lane"] {
        assert!(page.contains(&format!(" id=\"{id}\"")), "{id}");
    }
    assert!(!html_common::values(&page, "data-set").is_empty());
    let count = |part: &str| page.matches(part).count();
    assert!(count("<figure class=\"code") > 60 && count("<math") > 30 && count("data-stage=") > 25);
    let body = page.split("<main").nth(1).unwrap().split("<script").next().unwrap();
    // None of the texts' own notation remains.
    for part in ["{{", "}}", "[@", "](glossary:", "](book:", "](page:"] {
        assert!(!body.contains(part), "{part}");
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_page_and_tells_how_to_resume() {
    let directory = TempDir::new().unwrap();
    let mut command = weekender(directory.path(), &["companion", "--out", ".", "--progress", "on"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    // The first line of progress means that a figure is being rendered.
    let mut line = String::new();
    said.read_line(&mut line).unwrap();
    signal(&child, "INT");
    said.read_to_string(&mut line).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{line}");
    assert!(line.contains("pictures missing; run the same command again to go on"), "{line}");
    assert!(directory.path().join("index.html").exists());
}

/// The small pictures come first and show no progress; a quick still takes a single pass.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_quick_pictures() {
    let directory = TempDir::new().unwrap();
    faults::copy(PAGE.path(), directory.path());
    let figures = directory.path().join("out/figures");
    for (removed, first) in [(figures.join("more"), "more"), (figures.clone(), "sky.png")] {
        std::fs::remove_dir_all(removed).unwrap();
        let mut command = weekender(directory.path(), &QUICK);
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let first = figures.join(first);
        let is_begun = || first.is_file() || first.read_dir().is_ok_and(|mut files| files.next().is_some());
        until("no picture was written", is_begun);
        signal(&child, "INT");
        let (code, _, message) = outcome(&child.wait_with_output().unwrap());
        assert_eq!(code, Some(130), "{message}");
        assert!(message.contains("pictures missing; run the same command again"), "{message}");
    }
    assert!(!figures.join("book.png").exists());
}
