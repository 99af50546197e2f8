//! Full disks, limits on files and memory, and other runs.

use super::common::{
    ENDLESS, PICTURE, PROGRAM, batch, film, names, signal, succeeds, text, until, wait, weekender,
};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Renders in `at` with resource limits of the shell and `elsewhere` as the place for other files. Returns the message
/// of the render, which must fail.
fn fails(at: &Path, limits: &str, flags: &[&str]) -> String {
    fs::create_dir(at.join("elsewhere")).unwrap();
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("{limits}; exec \"$0\" \"$@\"")).arg(PROGRAM).args(PICTURE).args(flags);
    for name in ["TMPDIR", "XDG_STATE_HOME", "HOME"] {
        command.env(name, at.join("elsewhere"));
    }
    let output = command.current_dir(at).stdin(Stdio::null()).output().unwrap();
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    message
}

#[test]
fn file_size_limit_is_an_error_and_the_loss_is_reported() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let flags = ["off", "--samples", "2", "--checkpoint", "g.exr", "--out", "g.png"];
    let message = fails(at, "ulimit -f 1", &flags);
    for part in ["g.exr", "g.png", "ulimit -f", "the samples are lost (2 per pixel", "elsewhere"] {
        assert!(message.contains(part), "{message} should say {part}");
    }
    assert_eq!(names(at), ["elsewhere"]);
}

#[test]
fn a_full_disk_keeps_the_samples_elsewhere() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::create_dir(at.join("here")).unwrap();
    for name in ["g.exr", "g.png"] {
        symlink("/dev/full", at.join("here").join(name)).unwrap();
    }
    let flags = ["off", "--samples", "2", "--checkpoint", "here/g.exr", "--out", "here/g.png"];
    let message = fails(at, "true", &flags);
    let kept: Vec<String> =
        names(&at.join("here")).into_iter().filter(|name| name.starts_with("weekender-")).collect();
    let [kept] = kept.as_slice() else { panic!("{message}") };
    assert!([kept, "g.exr", "g.png"].iter().all(|part| message.contains(part)), "{message}");
    assert_eq!(film(&at.join("here").join(kept)).sample_count(), 2);
}

/// A stack that is larger than any address space makes every start of a thread fail, as a limit on processes does.
#[test]
fn films_are_read_and_written_where_no_thread_starts() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    for (range, name) in [("0..4", "a.exr"), ("4..8", "b.exr"), ("0..8", "whole.exr")] {
        succeeds(&mut batch(at, "off", &["--sample-range", range, "--out", name]));
    }
    for arguments in
        [&["merge", "a.exr", "b.exr", "--out", "sum.exr"][..], &["compare", "sum.exr", "whole.exr"]]
    {
        succeeds(weekender(at, arguments).env("RUST_MIN_STACK", (1_u64 << 50).to_string()));
    }
    assert!(film(&at.join("sum.exr")) == film(&at.join("whole.exr")));
}

#[test]
fn second_run_on_a_film_is_refused_until_the_first_ends() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let second = |flags: &[&str]| {
        let output = batch(at, "off", &[flags, &["--samples", "2"]].concat()).output().unwrap();
        (output.status.code(), text(&output.stderr))
    };
    let mut first = batch(at, "off", &ENDLESS).spawn().unwrap();
    until("the film is not written", || at.join("g.exr").exists());
    for flags in [&["--checkpoint", "./g.exr", "--continue", "--out", "b.png"][..], &["--out", "g.exr"]] {
        let (code, message) = second(flags);
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains("g.exr is locked") && message.contains("name another file"), "{message}");
    }
    assert_eq!(weekender(at, &["merge", "g.exr", "--out", "h.exr"]).status().unwrap().code(), Some(0));
    signal(&first, "KILL");
    wait(&mut first);
    let (code, message) = second(&["--checkpoint", "g.exr", "--continue", "--out", "b.png"]);
    assert_eq!(code, Some(0), "{message}");
    assert_eq!(names(at), ["b.png", "g.exr", "h.exr"]);
}

/// A rename that is not on the disk can be undone by a power cut, after the program has announced the file.
#[test]
fn the_directory_is_synced_after_each_rename() {
    let at = TempDir::new().unwrap();
    let at = fs::canonicalize(at.path()).unwrap();
    let mut strace = Command::new("strace");
    strace.args([
        "-f",
        "-y",
        "-e",
        "trace=fsync,rename,renameat,renameat2,linkat,link,mkdir",
        "-o",
        "trace",
        PROGRAM,
    ]);
    strace.args(PICTURE).args(["off", "--samples", "2", "--checkpoint", "g.exr", "--out", "g.png"]);
    match strace.current_dir(&at).output() {
        Ok(output) => assert!(output.status.success(), "{}", text(&output.stderr)),
        Err(error) => return eprintln!("strace was not run ({error}): nothing was tested"),
    }
    let trace = fs::read_to_string(at.join("trace")).unwrap();
    let synced = format!("<{}>)", at.display());
    let mut is_due = false;
    for line in trace.lines().filter(|line| !line.contains("unfinished") && !line.contains("ENOENT")) {
        if line.contains("rename") || line.contains("link") {
            assert!(!is_due, "{trace}");
            is_due = true;
        } else if line.contains("fsync") && line.contains(&synced) {
            is_due = false;
        }
    }
    assert!(!is_due && trace.contains("fsync") && trace.contains("g.exr"), "{trace}");
}
