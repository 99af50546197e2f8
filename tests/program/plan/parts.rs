//! Parts rendered one by one.

use super::common::{command, damage, ends, film, json, part_path, plan, render_part, succeeds, whole};
use crate::common::program::{signal, text, until};
use std::process::Command;
use tempfile::TempDir;

#[test]
fn the_parts_of_a_plan_add_up_to_one_run_to_the_bit() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // 100 samples in 3 parts: blocks of 2, because larger ones would make a part too long.
    for (flags, range) in [
        (&["--scene", "book", "--samples", "100", "--parts", "3"][..], "0..100"),
        (&["--stage", "shadow-acne", "--sample-range", "7..50", "--parts", "2"], "7..50"),
        (&["--samples", "16", "--parts", "4", "--estimate-error", "off", "--seed", "3"], "0..16"),
    ] {
        let directory = format!("plan of {range}");
        let lines = plan(at, &directory, flags);
        for (part, line) in lines.lines().enumerate().collect::<Vec<_>>().into_iter().rev() {
            assert!(line.contains(&format!("--part {part} --device=cpu --threads=2")), "{line}");
            render_part(at, &directory, part as u32);
        }
        let message = succeeds(at, &["merge", &directory, "--out", "merged.exr", "--out", "merged.png"]);
        let (start, end) = range.split_once("..").unwrap();
        let count = end.parse::<u64>().unwrap() - start.parse::<u64>().unwrap();
        let words = format!("{count} of {count} samples per pixel ({range})");
        assert!(message.contains(&words) && message.contains("merged.png"), "{message}");
        let kept: Vec<&str> = flags
            .chunks(2)
            .filter(|pair| !["--parts", "--samples", "--sample-range"].contains(&pair[0]))
            .flatten()
            .copied()
            .collect();
        assert!(film(&at.join("merged.exr")) == whole(at, range, &kept), "{flags:?}");
        assert!(at.join("merged.png").exists());
        assert!(succeeds(at, &["merge", &directory, "--check"]).contains("parts are complete"));
    }
}

#[test]
fn commands_quote_directories_for_the_shell() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let directory = "it's a \"plan\" for $HOME & Köln; *";
    let lines = plan(at, directory, &["--samples", "4", "--parts", "2"]);
    assert_eq!(lines.lines().count(), 2);
    let shell = |line: &str| {
        let output = Command::new("sh").args(["-e", "-c", line]).current_dir(at).output().unwrap();
        assert!(output.status.success(), "{line}{}", text(&output.stderr));
    };
    shell(&lines);
    succeeds(at, &["merge", directory, "--out", "merged.exr"]);
    assert!(film(&at.join("merged.exr")) == whole(at, "0..4", &[]));
    std::fs::remove_file(part_path(at, directory, 1)).unwrap();
    // The command for what is missing is quoted for a shell, too.
    let (message, _) = ends(at, 1, &["merge", directory, "--check"]);
    shell(message.lines().last().unwrap());
    succeeds(at, &["merge", directory, "--check"]);
}

#[test]
fn part_continues_from_its_checkpoint_unless_whole() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "64", "--parts", "2"]);
    let path = part_path(at, "p", 1);
    // As a killed run leaves it.
    whole(at, "32..39", &[]);
    std::fs::rename(at.join("one-run.exr"), &path).unwrap();
    let part = ["render-part", "p/plan.json", "--part", "1", "--device", "cpu", "--json", "-"];
    let found = json(at, &part);
    assert_eq!((&found["added_samples_per_pixel"], &found["samples_per_pixel"]), (&25.into(), &32.into()));
    assert!(film(&path) == whole(at, "32..64", &[]));

    let modified = || std::fs::metadata(&path).unwrap().modified().unwrap();
    let before = modified();
    assert!(render_part(at, "p", 1).contains("part 1 is complete: samples 32..64 in"));
    // A scheduler that repeats a command reads the same JSON again.
    let again = json(at, &part);
    assert_eq!((&again["added_samples_per_pixel"], &again["samples_per_pixel"]), (&0.into(), &32.into()));
    assert_eq!((&again["ended_by"], &again["files"][0]), (&"samples".into(), &"p/part-1.exr".into()));
    assert!(again["rmse_estimate"].is_number() && again["paths"] == 0, "{again}");
    assert_eq!(modified(), before);
    // The remedy lists only the unfinished part.
    let (message, _) = ends(at, 1, &["merge", "p", "--check"]);
    assert!(message.contains("part 0: part-0.exr is missing") && message.contains("--array=0 "), "{message}");
    assert!(message.contains("--part 0") && !message.contains("--part 1"), "{message}");
}

#[test]
fn damaged_part_is_moved_aside_and_rendered_again() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "4", "--parts", "2"]);
    let path = part_path(at, "p", 0);
    render_part(at, "p", 0);
    let good = film(&path);
    let aside = at.join("p/part-0.exr.damaged");
    for is_cut in [false, true] {
        if is_cut {
            std::fs::write(&path, "").unwrap()
        } else {
            damage(&path)
        }
        let (_, message) =
            ends(at, 0, &["render-part", "p", "--part", "0", "--device", "cpu", "--threads", "2"]);
        assert!(message.contains("part-0.exr.damaged") && message.contains("rendered again"), "{message}");
        assert!(aside.exists() && film(&path) == good);
    }
}

#[test]
fn the_environment_of_a_task_chooses_its_part() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "4", "--parts", "4"]);
    let task = |name: &str, value: &str| {
        let mut command = command(at, &["render-part", "p", "--device", "cpu"]);
        command.env(name, value).output().unwrap().status.code()
    };
    assert_eq!(task("SLURM_ARRAY_TASK_ID", "2"), Some(0));
    assert_eq!(task("JOB_COMPLETION_INDEX", "1"), Some(0));
    assert_eq!(task("JOB_COMPLETION_INDEX", "4"), Some(2));
    let there = [0, 1, 2, 3].map(|part| part_path(at, "p", part).exists());
    assert_eq!(there, [false, true, true, false]);
}

/// As when a scheduler starts a task again on another machine while the first one still runs.
#[cfg(unix)]
#[test]
fn second_run_of_a_part_is_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "4294967296", "--parts", "2"]);
    let part = ["render-part", "p", "--part", "0", "--device", "cpu", "--threads", "1", "--every", "0.1s"];
    let mut first = command(at, &part).stdout(std::process::Stdio::null()).spawn().unwrap();
    until("the film is not written", || part_path(at, "p", 0).exists());
    let (_, message) = ends(at, 2, &part);
    assert!(message.contains("part-0.exr is locked"), "{message}");
    signal(&first, "TERM");
    assert_eq!(first.wait().unwrap().code(), Some(143));
    assert!(film(&part_path(at, "p", 0)).sample_count() > 0);
}
