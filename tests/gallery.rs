//! `weekender gallery`: which stills are rendered again, the state after an interruption or a full disk, and the page.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

#[path = "common/mod.rs"]
mod common;
mod html_common;

use crate::common::program::{ends, names, outcome, weekender};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;
use weekender::pages::gallery::Figure;
use weekender::stages::Stage;

fn command(at: &Path, arguments: &[&str]) -> Command {
    weekender(at, &[&["gallery", "--device", "cpu", "--threads", "2", "--out", "g"], arguments].concat())
}

fn run(at: &Path, arguments: &[&str]) -> Output {
    command(at, arguments).output().unwrap()
}

/// Runs a gallery that must succeed, and returns the rendered stages.
fn rendered(at: &Path, arguments: &[&str]) -> Vec<String> {
    let (code, printed, message) = outcome(&run(at, arguments));
    assert_eq!(code, Some(0), "{arguments:?}: {message}");
    let first_word = |line: &str| line.split_whitespace().next().unwrap_or_default().to_owned();
    let stages: Vec<String> = printed.lines().map(first_word).filter(|id| Stage::find(id).is_ok()).collect();
    let (count, noun) = (stages.len(), if stages.len() == 1 { "picture" } else { "pictures" });
    assert!(printed.contains(&format!("{count} {noun} rendered")), "{printed}");
    stages
}

const SMALL: [&str; 3] = ["--quick", "--only", "sky,red-sphere,antialiasing"];

#[test]
fn renders_only_outdated_stills() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let all = ["sky", "red-sphere", "aliased", "antialiased"];
    assert_eq!(rendered(at, &SMALL), all);
    let file = |name: &str| at.join("g").join(name);
    let page = std::fs::read(file("index.html")).unwrap();
    assert!(rendered(at, &SMALL).is_empty());
    assert_eq!(std::fs::read(file("index.html")).unwrap(), page);

    // A damaged byte and a deleted file; a newer file alone does not count as changed.
    let mut bytes = std::fs::read(file("red-sphere.png")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(file("red-sphere.png"), bytes).unwrap();
    std::fs::remove_file(file("antialiased.png")).unwrap();
    let sky = std::fs::read(file("sky.png")).unwrap();
    std::fs::write(file("sky.png"), &sky).unwrap();
    assert_eq!(rendered(at, &SMALL), ["red-sphere", "antialiased"]);

    // A picture with other settings.
    std::fs::copy(file("red-sphere.png"), file("aliased.png")).unwrap();
    assert_eq!(rendered(at, &SMALL), ["aliased"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_finished_pictures() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let mut child =
        command(at, &["--only", "sky,book"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with("sky"));
    crate::common::program::signal(&child, "INT");
    let (code, _, message) = outcome(&child.wait_with_output().unwrap());
    assert_eq!(code, Some(130), "{message}");
    assert!(message.contains("1 picture missing") && message.contains("the same command again"), "{message}");
    let page = std::fs::read_to_string(at.join("g/index.html")).unwrap();
    assert!(page.contains("sky.png") && !page.contains("book.png"));
    assert!(!at.join("g/book.png").exists());
    assert!(rendered(at, &["--only", "sky"]).is_empty());
}

#[cfg(unix)]
#[test]
fn full_disk_keeps_finished_stills() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // Blocks of 512 bytes: the first picture and its description fit, the second does not.
    let limited = format!(
        "ulimit -f 8; exec '{}' gallery --device cpu --out g --only ppm-tiny,sky --progress off",
        crate::common::program::PROGRAM
    );
    let (code, _, message) =
        outcome(&Command::new("sh").current_dir(at).args(["-c", &limited]).output().unwrap());
    assert_eq!(code, Some(3), "{message}");
    for part in ["sky.png", "1 picture", "ulimit -f"] {
        assert!(message.contains(part), "{message} should say {part}");
    }
    assert_eq!(names(&at.join("g")), ["ppm-tiny.png"]);
    assert_eq!(rendered(at, &["--only", "ppm-tiny,sky"]), ["sky"]);
}

#[test]
fn a_still_that_could_not_be_printed_is_kept_and_counted() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full");
    let Ok(full) = full else { return };
    let at = TempDir::new().unwrap();
    let output = command(at.path(), &["--quick", "--only", "ppm-tiny"]).stdout(full).output().unwrap();
    let (code, _, message) = outcome(&output);
    assert!(code == Some(3) && message.contains("kept: 1 picture"), "{code:?}: {message}");
    assert_eq!(names(&at.path().join("g")), ["ppm-tiny.png"]);
}

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    std::fs::write(at.join("file"), "").unwrap();
    let cases: [(&[&str], &str); 3] = [
        (&["--out", "file"], "choose another with --out"),
        (&["--out", "g", "--only", "shadow-akne"], "did you mean shadow-acne?"),
        (&["--out", "g", "--device", "gpu", "--adapter", "no such thing"], "adapter"),
    ];
    for (arguments, part) in cases {
        let (_, message) = ends(at, 2, &[&["gallery"], arguments].concat());
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read(at.join("file")).unwrap(), b"");
}

#[test]
fn foreign_page_is_not_replaced() {
    let at = TempDir::new().unwrap();
    let page = at.path().join("index.html");
    std::fs::write(&page, "<title>Me</title>").unwrap();
    for command in ["gallery", "companion"] {
        let (_, message) = ends(at.path(), 2, &[command, "--quick", "--out", "."]);
        assert!(message.contains("there is a page that Weekender did not write; move it away"), "{message}");
        assert_eq!(std::fs::read_to_string(&page).unwrap(), "<title>Me</title>");
    }
}

#[test]
fn page_is_whole_and_has_no_script() {
    let at = TempDir::new().unwrap();
    rendered(at.path(), &SMALL);
    let page = html_common::assert_whole(&at.path().join("g"));
    let ids = html_common::values(&page, "id");
    for figure in Figure::all() {
        assert!(ids.contains(&format!("figure-{}", figure.id).as_str()), "{}", figure.id);
    }
    assert!(!page.contains("<script"));
}

#[test]
fn a_refused_request_leaves_nothing() {
    let at = TempDir::new().unwrap();
    for program in ["gallery", "companion"] {
        let output = weekender(at.path(), &[program, "--out", "g", "--adapter", "no such adapter"]).output();
        assert_eq!(output.unwrap().status.code(), Some(2), "{program}");
        assert!(!at.path().join("g").exists(), "{program}");
    }
}
