//! `merge --watch`.

use super::common::{command, film, part_path, plan, render_part, text, whole};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(120);

fn watch(at: &Path) -> Child {
    let flags = ["merge", "--watch", "p", "--every", "0.1s", "--out", "so-far.exr"];
    command(at, &flags).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until the picture so far has as many samples.
fn until(at: &Path, samples: u64) {
    let (begin, path) = (Instant::now(), at.join("so-far.exr"));
    while !path.exists() || film(&path).sample_count() != samples {
        assert!(begin.elapsed() < PATIENCE, "{samples} samples do not come");
        sleep(Duration::from_millis(20));
    }
}

fn ended(child: Child) -> (Option<i32>, String) {
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    (status.code(), text(&stdout) + &text(&stderr))
}

#[test]
fn parts_are_merged_as_they_come_and_checkpoints_grow() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "32", "--parts", "4"]);
    let child = watch(at);
    render_part(at, "p", 2);
    until(at, 8);
    // A checkpoint that grows twice.
    for (range, samples) in [("0..3", 11), ("0..6", 14)] {
        whole(at, range, &[]);
        std::fs::rename(at.join("one-run.exr"), part_path(at, "p", 0)).unwrap();
        until(at, samples);
    }
    let mut sum = whole(at, "0..6", &[]);
    sum.merge(&film(&part_path(at, "p", 2))).unwrap();
    assert!(film(&at.join("so-far.exr")) == sum);
    for part in [0, 1, 3] {
        render_part(at, "p", part);
    }
    let (code, message) = ended(child);
    assert_eq!(code, Some(0), "{message}");
    assert!(message.contains("32 of 32 samples per pixel (0..32); 4 of 4 parts are whole"), "{message}");
    assert!(film(&at.join("so-far.exr")) == whole(at, "0..32", &[]));
}

#[test]
fn a_signal_ends_it_with_the_picture_so_far() {
    for (name, expected) in [("INT", 130), ("TERM", 143)] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        plan(at, "p", &["--samples", "8", "--parts", "2"]);
        render_part(at, "p", 1);
        let child = watch(at);
        until(at, 4);
        std::fs::write(part_path(at, "p", 0), "no film").unwrap();
        let killed = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
        assert!(killed.success());
        let (code, message) = ended(child);
        assert_eq!(code, Some(expected), "{message}");
        assert!(message.contains("the same command continues") && message.contains("--part 0"), "{message}");
        assert_eq!(film(&at.join("so-far.exr")).sample_count(), 4);
    }
}
