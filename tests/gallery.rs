//! `weekender gallery`: which stills are rendered again, the state after an interruption or a full disk, and the page.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;
mod html_common;
mod program_common;

use std::collections::HashSet;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;
use weekender::page::gallery::Figure;
use weekender::stages::Stage;

fn command(at: &Path, arguments: &[&str]) -> Command {
    let mut command = program_common::weekender(at, &["gallery", "--device", "cpu", "--threads", "2"]);
    command.args(arguments);
    command
}

fn run(at: &Path, arguments: &[&str]) -> Output {
    command(at, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a gallery that must succeed, and returns the rendered stages.
fn rendered(at: &Path, arguments: &[&str]) -> Vec<String> {
    let output = run(at, &[&["--out", "g"], arguments].concat());
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
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

    // A damaged byte and a deleted file; a newer file alone is no change.
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
    let only = ["--out", "g", "--only", "sky,book"];
    let mut child = command(at, &only).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with("sky"));
    let signalled = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(signalled.success());
    let output = child.wait_with_output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{message}");
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
        env!("CARGO_BIN_EXE_weekender")
    );
    let output = Command::new("sh").current_dir(at).args(["-c", &limited]).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{message}");
    for part in ["sky.png", "1 picture", "ulimit -f"] {
        assert!(message.contains(part), "{message} should say {part}");
    }
    let names: HashSet<String> = std::fs::read_dir(at.join("g"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(names, ["ppm-tiny.png".to_owned()].into());
    assert_eq!(rendered(at, &["--only", "ppm-tiny,sky"]), ["sky"]);
}

#[test]
fn bad_input_is_refused_with_a_remedy() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    std::fs::write(at.join("file"), "").unwrap();
    let cases: [(&[&str], &[&str]); 3] = [
        (&["--out", "file"], &["file", "choose another with --out"]),
        (&["--out", "g", "--only", "shadow-akne"], &["shadow-akne", "did you mean shadow-acne?"]),
        (&["--out", "g", "--device", "gpu", "--adapter", "no such thing"], &["no such thing"]),
    ];
    for (arguments, parts) in cases {
        let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
            .current_dir(at)
            .arg("gallery")
            .args(arguments)
            .output()
            .unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        for part in parts {
            assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
        }
    }
    assert_eq!(std::fs::read(at.join("file")).unwrap(), b"");
}

/// Every value of `attribute` on the page.
fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    let begin = format!(" {attribute}=\"");
    page.split(&begin).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn foreign_page_is_not_replaced() {
    let at = TempDir::new().unwrap();
    let page = at.path().join("index.html");
    std::fs::write(&page, "<title>Me</title>").unwrap();
    for invocation in ["gallery --quick", "companion --quick"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
        command.current_dir(at.path()).args(invocation.split(' ')).args(["--out", "."]);
        let output = command.output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("there is a page that Weekender did not write; move it away"), "{message}");
        assert_eq!(std::fs::read_to_string(&page).unwrap(), "<title>Me</title>");
    }
}

#[test]
fn page_is_complete_and_offline() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    rendered(at, &SMALL);
    let path = at.join("g/index.html");
    let page = std::fs::read_to_string(&path).unwrap();
    for source in values(&page, "src") {
        assert!(at.join("g").join(source).exists(), "{source}");
    }
    let ids = values(&page, "id");
    assert_eq!(ids.iter().collect::<HashSet<_>>().len(), ids.len());
    for link in values(&page, "href") {
        let is_kept = match link.strip_prefix('#') {
            Some(fragment) => ids.contains(&fragment),
            None if link.starts_with("https://raytracing.github.io/") => true,
            None => at.join("g").join(link).exists(),
        };
        assert!(is_kept, "{link} leads nowhere");
    }
    for figure in Figure::all() {
        assert!(ids.contains(&format!("figure-{}", figure.id).as_str()), "{}", figure.id);
    }
    assert_eq!(values(&page, "alt").len(), values(&page, "src").len());
    assert!(values(&page, "alt").iter().all(|alt| alt.len() > 20));
    assert!(!page.contains("<script") && !page.contains("@import") && !page.contains("url("));

    html_common::assert_valid(&path);
}
