//! Standard output and standard error that are closed or full.

use super::common::{ENDLESS, batch, film, names, signal, succeeds, text, until, wait, weekender};
use std::fs;
use std::process::Stdio;
use tempfile::TempDir;

#[test]
fn informational_output_never_ends_a_run() {
    for is_full in [true, false] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let mut command = batch(at, "on", &ENDLESS);
        command.stderr(closed(is_full));
        if !is_full {
            command.stdout(closed(is_full));
        }
        let mut child = command.spawn().unwrap();
        until("the film is not written", || at.join("g.exr").exists());
        signal(&child, "INT");
        let status = wait(&mut child);
        assert_eq!(status.code(), Some(130), "{is_full}: {status}");
        assert_eq!(names(at), ["g.exr", "g.png"]);
        assert!(film(&at.join("g.exr")).sample_count() > 0);
        let status = weekender(at, &["--batch", "--scene", "nowhere"]).stderr(closed(is_full)).status();
        assert_eq!(status.unwrap().code(), Some(2));
    }
}

/// A full device, or a pipe whose reader has gone away.
fn closed(is_full: bool) -> Stdio {
    if is_full {
        return fs::OpenOptions::new().write(true).open("/dev/full").unwrap().into();
    }
    std::io::pipe().unwrap().1.into()
}

#[test]
fn unreadable_results_are_a_reported_failure() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    succeeds(&mut batch(at, "off", &["--samples", "2", "--out", "a.exr"]));
    let commands: [(&[&str], i32); 6] = [
        (&["--list"], 1),
        (&["--help"], 1),
        (&["merge", "a.exr", "--out", "b.png"], 1),
        (&["compare", "a.exr", "a.exr"], 2),
        (&["--scene", "book", "--save-scene", "s.toml"], 1),
        (&["--batch", "--size", "8x8", "--samples", "2", "--device", "cpu", "--out", "c.png"], 1),
    ];
    for (arguments, code) in commands {
        for is_full in [true, false] {
            let output = weekender(at, arguments).stdout(closed(is_full)).output().unwrap();
            assert_eq!(output.status.code(), Some(code), "{arguments:?}: {output:?}");
            assert!(text(&output.stderr).contains("cannot write to standard output"), "{arguments:?}");
        }
    }
    for name in ["b.png", "s.toml", "c.png"] {
        assert!(at.join(name).exists(), "{name} is written all the same");
    }
}
