//! A range of samples that is killed again and again.

use super::common::{film, names, rounds, signal, succeeds, wait, weekender};
use super::signals::Dice;
use std::io::{BufRead, BufReader};
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;

/// The files of a power cut look like those of `kill -9`: both leave the last film that was renamed into place.
#[test]
fn range_killed_at_random_ends_with_the_bits_of_one_run() {
    let mut dice = Dice::new();
    let at = TempDir::new().unwrap();
    let at = at.path();
    let picture = ["--size", "48x27", "--device", "cpu", "--threads", "2"];
    // More than can be rendered in all rounds: what there is after the last kill is compared.
    let path = at.join("p.exr");
    let part = ["--batch", "--sample-range", "1073741824..2147483648", "--checkpoint", "p.exr", "--continue"];
    let part = [&part[..], &["--every", "0.1s", "--progress", "on"], &picture].concat();
    let mut last = 0;
    for round in 0..rounds(6) {
        let mut child = weekender(at, &part).spawn().unwrap();
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        stderr.read_line(&mut String::new()).unwrap();
        sleep(Duration::from_millis(dice.roll(500)));
        // Every fourth run is asked to end instead of killed.
        let asked = round % 4 == 3;
        signal(&child, if asked { "TERM" } else { "KILL" });
        drop(stderr);
        let status = wait(&mut child);
        assert_eq!(status.code(), asked.then_some(143), "round {round}: {status}");
        if path.exists() {
            let held = film(&path).samples().clone();
            assert_eq!(held.first_gap(1 << 30..held.end(), u64::MAX), None, "round {round}");
            assert!(held.count() >= last, "round {round}: {} samples, {last} before", held.count());
            last = held.count();
        }
    }
    assert!(last > 0, "no film was written in {} rounds", rounds(6));
    let killed = film(&path);
    let range = format!("{}..{}", 1_u64 << 30, killed.samples().end());
    let whole = ["--batch", "--sample-range", &range, "--progress", "off", "--out", "whole.exr"];
    succeeds(&mut weekender(at, &[&whole[..], &picture].concat()));
    assert!(film(&at.join("whole.exr")) == killed, "{range}");
    let left = names(at);
    assert!(left.iter().filter(|name| name.ends_with(".part")).count() <= 1, "{left:?}");
}
