//! Standard output and standard error that are closed or full.

use super::common::{ENDLESS, batch, film, names, signal, succeeds, text, until, wait, weekender};
use std::fs::{self};
use tempfile::TempDir;

#[test]
fn what_is_only_said_never_ends_a_run() {
    for (round, both) in [(0, false), (1, false), (2, true)] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let mut command = batch(at, "on", &ENDLESS);
        let gone = || {
            // A pipe whose reader has gone away.
            let (reader, writer) = std::io::pipe().unwrap();
            drop(reader);
            writer
        };
        let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        if round == 1 {
            command.stderr(full())
        } else {
            command.stderr(gone())
        };
        if both {
            command.stdout(gone());
        }
        let mut child = command.spawn().unwrap();
        until("the film is not written", || at.join("g.exr").exists());
        signal(&child, "INT");
        let status = wait(&mut child);
        assert_eq!(status.code(), Some(130), "round {round}: {status}");
        assert_eq!(names(at), ["g.exr", "g.png"]);
        assert!(film(&at.join("g.exr")).sample_count() > 0);
    }
    // Other runs that print messages: a lost device, a report, a comparison, bad input.
    let at = TempDir::new().unwrap();
    let at = at.path();
    let quiet = |arguments: &[&str]| {
        let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let status = weekender(at, arguments).stderr(full()).status().unwrap();
        status.code()
    };
    assert_eq!(quiet(&["--batch", "--scene", "nowhere"]), Some(2));
    assert_eq!(quiet(&["--no-such-flag"]), Some(2));
    let small = ["--batch", "--size", "8x8", "--samples", "2", "--device", "cpu", "--progress", "on"];
    assert_eq!(quiet(&[&small[..], &["--json", "-"]].concat()), Some(0));
    let report = [
        "report",
        "--out",
        "r",
        "--scenes",
        "three-spheres",
        "--backends",
        "cpu",
        "--samplers",
        "sobol",
        "--size",
        "16x9",
        "--seeds",
        "1",
        "--max-samples",
        "4",
        "--time-limit",
        "1",
        "--progress",
        "on",
    ];
    assert_eq!(quiet(&report), Some(0));
}

#[test]
fn results_that_nobody_can_read_are_a_failure_with_a_word() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    succeeds(&mut batch(at, "off", &["--samples", "2", "--out", "a.exr"]));
    let commands: [(&[&str], i32); 7] = [
        (&["--list"], 1),
        (&["--help"], 1),
        (&["merge", "a.exr", "--out", "b.png"], 1),
        (&["compare", "a.exr", "a.exr"], 2),
        (&["diff", "--pixel", "1,1", "--sides", "cpu,reference"], 2),
        (&["--scene", "book", "--save-scene", "s.toml"], 1),
        (&["--batch", "--size", "8x8", "--samples", "2", "--device", "cpu", "--out", "c.png"], 1),
    ];
    for (arguments, code) in commands {
        for is_full in [true, false] {
            let mut command = weekender(at, arguments);
            if is_full {
                command.stdout(fs::OpenOptions::new().write(true).open("/dev/full").unwrap());
            } else {
                let (reader, writer) = std::io::pipe().unwrap();
                drop(reader);
                command.stdout(writer);
            }
            let output = command.output().unwrap();
            assert_eq!(output.status.code(), Some(code), "{arguments:?}: {output:?}");
            assert!(text(&output.stderr).contains("cannot write to standard output"), "{arguments:?}");
        }
    }
    for name in ["b.png", "s.toml", "c.png"] {
        assert!(at.join(name).exists(), "{name} is written all the same");
    }
}
