//! Fault drills: kills, full disks, resource limits, closed pipes, and other runs that use the same film. All rendered
//! samples must be there afterwards, to the bit.
//!
//! Each test runs a few rounds. For a long series, set WEEKENDER_FAULT_ROUNDS to the number of rounds:
//! `WEEKENDER_FAULT_ROUNDS=150 cargo test --release --test fault_injection -- --nocapture`.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use weekender::film::{Film, checkpoint};

const PATIENCE: Duration = Duration::from_secs(120);
const PROGRAM: &str = env!("CARGO_BIN_EXE_weekender");

/// A small picture with enough samples to interrupt.
const PICTURE: [&str; 8] = ["--batch", "--size", "48x27", "--threads", "2", "--device", "cpu", "--progress"];

/// A render that never ends by itself and keeps its film.
const ENDLESS: [&str; 8] =
    ["--samples", "4294967296", "--checkpoint", "g.exr", "--every", "0.1s", "--out", "g.png"];

fn rounds(usual: u32) -> u32 {
    std::env::var("WEEKENDER_FAULT_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(usual)
}

fn weekender(at: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .current_dir(at)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn batch(at: &Path, progress: &str, arguments: &[&str]) -> Command {
    weekender(at, &[&PICTURE[..], &[progress], arguments].concat())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn succeeds(command: &mut Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", text(&output.stderr));
}

fn signal(child: &Child, name: &str) {
    let killed = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
}

fn wait(child: &mut Child) -> ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("it does not end");
        }
        sleep(Duration::from_millis(5));
    }
}

/// Waits until `is_so` returns true.
fn until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < PATIENCE, "{what}");
        sleep(Duration::from_millis(5));
    }
}

fn film(path: &Path) -> Film {
    checkpoint::load(path).unwrap().film
}

/// Files in a directory, except unfinished ones that a kill leaves behind.
fn names(at: &Path) -> Vec<String> {
    let entries = fs::read_dir(at).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Pseudo-random numbers; each test prints its seed.
struct Dice(u64);

impl Dice {
    fn new() -> Dice {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
        Dice(now.as_nanos() as u64 | 1)
    }

    /// A number below `limit`.
    fn roll(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % limit
    }
}

/// Checks that `part`, left by a killed run, can be continued to the film of an uninterrupted run.
fn goes_on_to_the_same_bits(at: &Path, part: &str) {
    let whole = film(&at.join(part));
    let samples = whole.samples().end() + 3;
    let range = format!("0..{samples}");
    let common = ["--sample-range", &range, "--out"];
    succeeds(&mut batch(at, "off", &[&["--resume", part], &common[..], &["resumed.exr"]].concat()));
    succeeds(&mut batch(at, "off", &[&common[..], &["whole.exr"]].concat()));
    assert!(film(&at.join("resumed.exr")) == film(&at.join("whole.exr")), "{part}: {}", whole.samples());
}

#[test]
fn signals_at_any_moment_leave_a_film_that_goes_on() {
    let mut dice = Dice::new();
    println!("dice {}", dice.0);
    let (mut films, mut unfinished) = (0, 0);
    for round in 0..rounds(6) {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let name = ["KILL", "INT", "TERM"][round as usize % 3];
        let mut child = batch(at, "on", &ENDLESS).spawn().unwrap();
        // It prints its first line after it has started to listen.
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut String::new()).unwrap();
        sleep(Duration::from_millis(dice.roll(400)));
        signal(&child, name);
        drop(stderr);
        let status = wait(&mut child);
        if name == "KILL" {
            assert_eq!(status.signal(), Some(9));
        } else {
            assert_eq!(status.code(), Some(130), "{name}: {status}");
            // Before the first sample, there is nothing to save.
            assert!(names(at).is_empty() || names(at) == ["g.exr", "g.png"], "{name}: {:?}", names(at));
        }
        unfinished += names(at).iter().filter(|name| name.ends_with(".part")).count();
        if at.join("g.exr").exists() {
            films += 1;
            goes_on_to_the_same_bits(at, "g.exr");
            let left: Vec<String> = names(at).into_iter().filter(|name| name.ends_with(".part")).collect();
            assert!(left.is_empty(), "the next run clears up: {left:?}");
        }
    }
    assert!(films > 0);
    println!("{} rounds: {films} films, {unfinished} unfinished files cleared up", rounds(6));
}

#[test]
fn a_kill_costs_no_more_than_the_time_since_the_last_writing() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let mut child = batch(at, "off", &ENDLESS).spawn().unwrap();
    let path = at.join("g.exr");
    until("the film is not written", || path.exists());
    let first = film(&path).sample_count();
    until("the film does not grow", || film(&path).sample_count() > first);
    signal(&child, "KILL");
    wait(&mut child);
    assert!(!at.join("g.png").exists());
    goes_on_to_the_same_bits(at, "g.exr");
}

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

#[test]
fn signals_while_files_are_written_wait_for_them_and_are_answered() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // A pipe accepts a picture as slowly as its reader wants.
    succeeds(Command::new("mkfifo").arg(at.join("slow.png")).arg(at.join("pipe.exr")));
    let flags = ["--samples", "1", "--checkpoint", "g.exr", "--out", "slow.png"];
    let mut child = batch(at, "on", &flags).spawn().unwrap();
    let stderr = BufReader::new(child.stderr.take().unwrap());
    let (said, lines) = std::sync::mpsc::channel();
    let listener = std::thread::spawn(move || {
        for line in stderr.lines().map_while(Result::ok) {
            said.send(line).unwrap();
        }
    });
    let hear = |part: &str| {
        let begin = Instant::now();
        while begin.elapsed() < PATIENCE {
            if lines.recv_timeout(PATIENCE).unwrap().contains(part) {
                return;
            }
        }
        panic!("{part:?} is not said");
    };
    let film_in_pipe =
        batch(at, "off", &["--samples", "4294967296", "--out", "a.png", "--checkpoint", "pipe.exr"])
            .output()
            .unwrap();
    assert_eq!(film_in_pipe.status.code(), Some(2), "{film_in_pipe:?}");
    assert!(text(&film_in_pipe.stderr).contains("pipe.exr"), "{film_in_pipe:?}");
    hear("writing slow.png");
    for _ in 0..3 {
        signal(&child, "INT");
        hear("still writing");
        // Longer than the time within which two signals count as one.
        sleep(Duration::from_millis(600));
    }
    assert_eq!(child.try_wait().unwrap(), None);
    let mut picture = Vec::new();
    File::open(at.join("slow.png")).unwrap().read_to_end(&mut picture).unwrap();
    assert_eq!(wait(&mut child).code(), Some(130));
    listener.join().unwrap();
    assert!(picture.starts_with(b"\x89PNG") && picture.ends_with(b"IEND\xae\x42\x60\x82"));
    assert_eq!(film(&at.join("g.exr")).sample_count(), 1);
}

#[test]
fn a_signal_that_arrives_twice_is_one() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let mut child = batch(at, "off", &ENDLESS).spawn().unwrap();
    until("the film is not written", || at.join("g.exr").exists());
    signal(&child, "INT");
    signal(&child, "TERM");
    assert_eq!(wait(&mut child).code(), Some(130));
    assert_eq!(names(at), ["g.exr", "g.png"]);
}

#[test]
fn a_second_signal_ends_the_program_at_once() {
    // One pass takes far longer than this test.
    let picture = ["--batch", "--device", "reference", "--threads", "1", "--size", "2400x1600"];
    let flags = ["--samples", "1000", "--out", "g.png", "--checkpoint", "g.exr", "--progress", "on"];
    for milliseconds in [800, 3000, 10_000] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let mut child = weekender(at, &[&picture[..], &flags].concat()).spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut String::new()).unwrap();
        sleep(Duration::from_millis(milliseconds));
        signal(&child, "INT");
        sleep(Duration::from_millis(700));
        if child.try_wait().unwrap().is_some() && names(at).is_empty() {
            // The signal came before the first pass, which may start late on a busy machine.
            continue;
        }
        signal(&child, "INT");
        let status = wait(&mut child);
        let mut told = String::new();
        stderr.read_to_string(&mut told).unwrap();
        assert_eq!(status.code(), Some(130), "{told}");
        assert!(told.contains("ended at once"), "{told}");
        assert!(names(at).is_empty(), "nothing is written: {:?}", names(at));
        return;
    }
    panic!("no pass was under way when the first signal came");
}

#[test]
fn a_signal_ends_the_gallery_of_stages_with_the_present_one() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let flags = ["--stage", "all", "--samples", "4294967296", "--estimate-error", "off", "--out", "gallery"];
    let mut child = batch(at, "on", &[&flags[..], &["--json", "figures.json"]].concat()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    stderr.read_line(&mut String::new()).unwrap();
    sleep(Duration::from_millis(300));
    signal(&child, "INT");
    assert_eq!(wait(&mut child).code(), Some(130));
    let pictures = names(&at.join("gallery"));
    assert!(pictures.len() <= 1, "one stage at most: {pictures:?}");
    let figures: serde_json::Value =
        serde_json::from_slice(&fs::read(at.join("figures.json")).unwrap()).unwrap();
    assert_eq!(figures["stages"].as_array().map(Vec::len), Some(1), "{figures}");
    assert_eq!(figures["stages"][0]["ended_by"], "stopped");
}

/// Runs the program with resource limits of the shell.
fn limited(at: &Path, limits: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("{limits}; exec \"$0\" \"$@\"")).arg(PROGRAM).args(arguments);
    for name in ["TMPDIR", "XDG_STATE_HOME", "HOME"] {
        command.env(name, at.join("elsewhere"));
    }
    command.current_dir(at).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    wait(&mut child);
    child.wait_with_output().unwrap()
}

#[test]
fn a_limit_on_the_size_of_files_is_an_error_and_the_loss_is_told() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::create_dir(at.join("elsewhere")).unwrap();
    let flags =
        [&PICTURE[..], &["off", "--samples", "2", "--checkpoint", "g.exr", "--out", "g.png"]].concat();
    let output = limited(at, "ulimit -f 1", &flags);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    for part in ["g.exr", "g.png", "ulimit -f", "the samples are lost (2 per pixel", "elsewhere"] {
        assert!(told.contains(part), "{told} should say {part}");
    }
    assert_eq!(names(at), ["elsewhere"]);
}

#[test]
fn a_full_disk_keeps_the_samples_elsewhere() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::create_dir(at.join("elsewhere")).unwrap();
    fs::create_dir(at.join("here")).unwrap();
    for name in ["g.exr", "g.png"] {
        symlink("/dev/full", at.join("here").join(name)).unwrap();
    }
    let flags =
        [&PICTURE[..], &["off", "--samples", "2", "--checkpoint", "here/g.exr", "--out", "here/g.png"]]
            .concat();
    let output = limited(at, "true", &flags);
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    let kept: Vec<String> =
        names(&at.join("here")).into_iter().filter(|name| name.starts_with("weekender-")).collect();
    let [kept] = kept.as_slice() else { panic!("{told}") };
    assert!(told.contains(kept) && told.contains("g.exr") && told.contains("g.png"), "{told}");
    assert_eq!(film(&at.join("here").join(kept)).sample_count(), 2);
}

#[test]
fn little_memory_is_an_error() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let large = ["--scene", "three-spheres", "--size", "4000x3000"];
    let many = ["--scene", "field:3000000", "--size", "40x30"];
    for (kilobytes, picture) in [(200_000, large), (400_000, large), (800_000, large), (600_000, many)] {
        let flags =
            [&["--batch", "--samples", "2", "--device", "cpu", "--out", "g.png"], &picture[..]].concat();
        let output = limited(at, &format!("ulimit -v {kilobytes}"), &flags);
        let code = output.status.code();
        assert!(matches!(code, Some(0..=3)), "{kilobytes} kB: {}: {}", output.status, text(&output.stderr));
    }
}

#[test]
fn two_runs_on_one_film_lose_nothing() {
    for _ in 0..rounds(2) {
        let at = TempDir::new().unwrap();
        let at = at.path();
        succeeds(&mut batch(at, "off", &["--samples", "8", "--checkpoint", "g.exr", "--out", "g.png"]));
        let go_on = |range: &str, out: &str| {
            let flags =
                ["--resume", "g.exr", "--checkpoint", "g.exr", "--every", "0.1s", "--sample-range", range];
            batch(at, "off", &[&flags[..], &["--out", out]].concat()).spawn().unwrap()
        };
        let mut runs = [go_on("8..3000", "a.png"), go_on("3000..6000", "b.png")];
        for run in &mut runs {
            let mut told = String::new();
            run.stderr.take().unwrap().read_to_string(&mut told).unwrap();
            assert!(wait(run).success(), "{told}");
        }
        succeeds(&mut batch(at, "off", &["--samples", "6000", "--out", "whole.exr"]));
        assert!(
            film(&at.join("g.exr")) == film(&at.join("whole.exr")),
            "{}",
            film(&at.join("g.exr")).samples()
        );
        assert_eq!(names(at), ["a.png", "b.png", "g.exr", "g.png", "whole.exr"]);
    }
}
