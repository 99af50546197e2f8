//! Kills and other signals.

use super::common::{
    ENDLESS, PICTURE, PROGRAM, batch, film, names, rounds, signal, succeeds, text, until, wait, weekender,
};
use crate::common::program::{PATIENCE, restore_signals};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;

/// Pseudo-random numbers, from a seed that is printed.
struct Dice(u64);

impl Dice {
    fn new() -> Dice {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
        println!("dice {now:?}");
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
fn continues_to_the_same_bits(at: &Path, part: &str) {
    let whole = film(&at.join(part));
    let samples = whole.samples().end() + 3;
    let range = format!("0..{samples}");
    let common = ["--sample-range", &range, "--out"];
    succeeds(&mut batch(at, "off", &[&["--resume", part], &common[..], &["resumed.exr"]].concat()));
    succeeds(&mut batch(at, "off", &[&common[..], &["whole.exr"]].concat()));
    assert!(film(&at.join("resumed.exr")) == film(&at.join("whole.exr")), "{part}: {}", whole.samples());
}

#[test]
fn signals_at_any_moment_leave_a_resumable_film() {
    let mut dice = Dice::new();
    let mut films = 0;
    for round in 0..rounds(6) {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let name = ["KILL", "INT", "TERM"][round as usize % 3];
        let mut child = batch(at, "on", &ENDLESS).spawn().unwrap();
        // It prints its first line once it handles signals.
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut String::new()).unwrap();
        sleep(Duration::from_millis(dice.roll(400)));
        signal(&child, name);
        drop(stderr);
        let status = wait(&mut child);
        if name == "KILL" {
            assert_eq!(status.signal(), Some(9));
        } else {
            assert_eq!(status.code(), Some(if name == "TERM" { 143 } else { 130 }), "{name}: {status}");
            // Before the first sample, there is nothing to save.
            assert!(names(at).is_empty() || names(at) == ["g.exr", "g.png"], "{name}: {:?}", names(at));
        }
        if at.join("g.exr").exists() {
            films += 1;
            continues_to_the_same_bits(at, "g.exr");
            let again = ["--samples", "1", "--checkpoint", "g.exr", "--continue", "--out", "g.png"];
            succeeds(&mut batch(at, "off", &again));
            assert!(names(at).iter().all(|name| !name.ends_with(".part")), "the next run clears up");
        }
    }
    assert!(films > 0);
}

/// Grid Engine, Slurm, LSF and limits on processor time announce the end with these.
#[test]
fn every_signal_that_asks_for_an_end_keeps_the_film() {
    for (name, code) in [("USR1", 138), ("PWR", 158)] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let mut child = batch(at, "off", &ENDLESS).spawn().unwrap();
        until("the film is not written", || at.join("g.exr").exists());
        let before = film(&at.join("g.exr")).sample_count();
        signal(&child, name);
        assert_eq!(wait(&mut child).code(), Some(code), "SIG{name}");
        assert_eq!(names(at), ["g.exr", "g.png"], "SIG{name}");
        assert!(film(&at.join("g.exr")).sample_count() >= before);
    }
    let at = TempDir::new().unwrap();
    let at = at.path();
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -S -t 1; exec \"$0\" \"$@\"", PROGRAM]).args(PICTURE).arg("off");
    let limited =
        command.args(["--samples", "4294967296", "--out", "g.exr"]).current_dir(at).output().unwrap();
    assert_eq!(limited.status.code(), Some(152), "{limited:?}");
    assert!(text(&limited.stderr).contains("ulimit -t") && film(&at.join("g.exr")).sample_count() > 0);
}

#[test]
fn commands_that_go_on_obey_the_signals_of_schedulers() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    succeeds(&mut batch(at, "off", &["--samples", "2", "--out", "own.png"]));
    let frames = ["--batch", "--turntable=100000", "--size", "48x27", "--samples", "4", "--out", "frames"];
    let ways: [(&[&str], &str); 3] = [
        (&frames, "frames/frame-0000.png"),
        (&["check", "--watch", "own.png", "--json", "found.json"], "found.json"),
        (&["bench", "--scene", "three-spheres", "--runs", "99", "--log", "b.log"], "b.log"),
    ];
    for (arguments, sign) in ways {
        let mut child = weekender(at, arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        until("it does not begin", || at.join(sign).exists());
        sleep(Duration::from_millis(500));
        signal(&child, "USR1");
        assert_eq!(wait(&mut child).code(), Some(138), "{arguments:?}");
    }
}

#[test]
fn signals_wait_for_file_writes_and_are_answered() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // A pipe accepts a picture as slowly as its reader wants.
    succeeds(Command::new("mkfifo").arg(at.join("slow.png")).arg(at.join("pipe.exr")));
    let flags = ["--samples", "1", "--checkpoint", "g.exr", "--out", "slow.png"];
    let mut child = batch(at, "on", &flags).spawn().unwrap();
    let stderr = BufReader::new(child.stderr.take().unwrap());
    let (sender, lines) = std::sync::mpsc::channel();
    let listener = std::thread::spawn(move || {
        for line in stderr.lines().map_while(Result::ok) {
            sender.send(line).unwrap();
        }
    });
    let hear = |part: &str| while !lines.recv_timeout(PATIENCE).unwrap().contains(part) {};
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
fn repeated_signal_counts_once() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let mut child = batch(at, "off", &ENDLESS).spawn().unwrap();
    until("the film is not written", || at.join("g.exr").exists());
    let both = format!("kill -s INT {0} && kill -s TERM {0}", child.id());
    succeeds(Command::new("sh").args(["-c", &both]));
    assert_eq!(wait(&mut child).code(), Some(130));
    assert_eq!(names(at), ["g.exr", "g.png"]);
}

#[test]
fn a_second_signal_ends_the_program_at_once() {
    // One pass takes far longer than this test.
    let picture = ["--batch", "--device", "reference", "--threads", "1", "--size", "2400x1600"];
    let flags = ["--samples", "1000", "--out", "g.png", "--checkpoint", "g.exr", "--progress", "on"];
    for milliseconds in [800, 3000, 10_000, 30_000] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let mut child = weekender(at, &[&picture[..], &flags].concat()).spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut String::new()).unwrap();
        sleep(Duration::from_millis(milliseconds));
        signal(&child, "INT");
        // Longer than the time within which two signals count as one.
        sleep(Duration::from_millis(700));
        signal(&child, "INT");
        let status = wait(&mut child);
        let mut message = String::new();
        stderr.read_to_string(&mut message).unwrap();
        assert_eq!(status.code(), Some(130), "{message}");
        // The first signal may come before the first pass, which starts late on a busy machine.
        if message.contains("ended at once") {
            // The next run removes the lock.
            assert!(names(at).iter().all(|name| name.ends_with(".lock")), "{:?} is written", names(at));
            return;
        }
    }
    panic!("no pass was under way when the first signal came");
}

/// What nohup does for SIGHUP, and a shell without job control for SIGINT.
#[test]
fn initially_ignored_signals_stay_ignored() {
    for (ignored, heard, code) in [("HUP", "TERM", 143), ("INT", "HUP", 129)] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        restore_signals();
        let mut command = Command::new("sh");
        command.args(["-c", "trap '' \"$0\" && exec \"$@\"", ignored, PROGRAM]);
        command.args(PICTURE).arg("off").args(ENDLESS).current_dir(at);
        let mut child =
            command.stdin(Stdio::null()).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
        let path = at.join("g.exr");
        until("the film is not written", || path.exists());
        signal(&child, ignored);
        // Twice, because the film is also written at the end.
        for _ in 0..2 {
            let before = film(&path).sample_count();
            until("the film does not grow", || film(&path).sample_count() > before);
            assert_eq!(child.try_wait().unwrap(), None, "SIG{ignored} has ended it");
        }
        signal(&child, heard);
        assert_eq!(wait(&mut child).code(), Some(code), "SIG{ignored} was ignored, SIG{heard} was not");
    }
}
