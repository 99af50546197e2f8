//! `weekender bench` as a program: what it measures, writes and refuses.

#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn bench(directory: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.current_dir(directory).arg("bench").args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

const TINY: [&str; 10] =
    ["--size", "32x18", "--samples", "4", "--runs", "3", "--run-limit", "0.2", "--threads", "2"];

fn tiny(directory: &Path, arguments: &[&str]) -> Output {
    let output = bench(directory, &[&TINY, arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn check_spread(spread: &Value) {
    let [median, min, max] = ["median", "min", "max"].map(|key| number(spread, key));
    assert!(0.0 < min && min <= median && median <= max, "{spread}");
}

#[test]
fn rows_have_sane_figures() {
    let directory = tempfile::tempdir().unwrap();
    let output = tiny(directory.path(), &["--scene", "three-spheres", "--scene", "book", "--json", "b.json"]);
    let report: Value =
        serde_json::from_str(&std::fs::read_to_string(directory.path().join("b.json")).unwrap()).unwrap();
    assert_eq!(report["schema"], 1);
    assert_eq!(report["interrupted"], false);
    assert_eq!(report["machine"]["version"], env!("CARGO_PKG_VERSION"));
    let scenes = report["scenes"].as_array().unwrap();
    assert_eq!(scenes.iter().map(|scene| &scene["scene"]).collect::<Vec<_>>(), ["three-spheres", "book"]);
    for scene in scenes {
        let rows = scene["rows"].as_array().unwrap();
        let kinds: Vec<&str> = rows.iter().map(|row| row["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds[0], "baseline");
        assert!(kinds.contains(&"scalar") && kinds.contains(&"threads"), "{kinds:?}");
        let baseline = number(&rows[0]["paths_per_second"], "median");
        for row in rows {
            assert_eq!(row["skipped"], Value::Null, "{row}");
            assert_eq!(row["runs"].as_array().unwrap().len(), 3);
            check_spread(&row["paths_per_second"]);
            check_spread(&row["rays_per_second"]);
            let ratio = number(&row["paths_per_second"], "median") / baseline;
            assert!((number(row, "ratio_to_baseline") / ratio - 1.0).abs() < 1e-9);
            for run in row["runs"].as_array().unwrap() {
                assert_eq!(number(run, "paths"), 32.0 * 18.0 * number(row, "samples_per_pixel"));
                let rays = number(run, "rays") / number(run, "paths");
                assert!((1.0..24.0).contains(&rays), "{rays} rays a path");
            }
            if row["kind"] == "baseline" {
                assert_eq!((&row["lanes_in_use"], &row["efficiency"]), (&Value::Null, &Value::Null));
                for run in row["runs"].as_array().unwrap() {
                    assert_eq!((&run["busy_lanes"], &run["offered_lanes"]), (&0.into(), &0.into()));
                }
                continue;
            }
            assert!((0.0..=1.0).contains(&number(row, "lanes_in_use")), "{row}");
            if row["lanes"] == 1 {
                // An absorbed path costs its lane one more iteration.
                assert!(number(row, "lanes_in_use") > 0.9, "{row}");
            }
            assert!(number(row, "efficiency") > 0.0);
        }
    }
    // The machine's name and the warnings may be longer.
    let is_free = |line: &str| line.starts_with("Weekender") || line.starts_with("warning");
    let table = text(&output.stdout);
    assert!(table.lines().all(|line| line.chars().count() <= 100 || is_free(line)), "{table}");
    assert!(output.stderr.is_empty(), "quiet when redirected: {}", text(&output.stderr));
}

#[test]
fn baseline_is_skipped_without_compiler() {
    let directory = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.env("CC", "no-such-compiler").arg("bench").args(TINY).args(["--scene", "metals"]);
    let output = command.current_dir(directory.path()).output().unwrap();
    assert!(output.status.success());
    let table = text(&output.stdout);
    assert!(table.contains("skipped") && table.contains("no-such-compiler"), "{table}");
    // An empty name counts as none.
    command.env("CC", " ");
    let table = text(&command.output().unwrap().stdout);
    assert!(table.contains("C89, cc -O2"), "{table}");
}

#[test]
fn features_compare_own_kernel_with_general_one() {
    let directory = tempfile::tempdir().unwrap();
    let flags = ["--features", "--runs", "2", "--size", "32x18", "--run-limit", "0.002", "--json", "-"];
    let scenes = ["--scene", "three-spheres", "--scene", "book"];
    let output = bench(directory.path(), &[&flags[..], &scenes].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let left_out = |scene: usize| {
        let rows = report["scenes"][scene]["rows"].as_array().unwrap();
        assert_eq!([&rows[0]["kind"], &rows[1]["kind"]], ["general", "packets"]);
        let median = |row: &Value| number(&row["paths_per_second"], "median");
        let gain = median(&rows[1]) / median(&rows[0]);
        assert!((number(&rows[1], "ratio_to_baseline") / gain - 1.0).abs() < 1e-9);
        rows[1]["left_out"].to_string()
    };
    assert!(left_out(0).contains("lens"), "{}", left_out(0));
    assert!(!left_out(1).contains("lens"), "{}", left_out(1));
}

#[test]
fn bad_flags_fail_early() {
    let cases: [(&[&str], &str); 4] = [
        (&["--scene", "no-such"], "no-such"),
        (&["--isa", "mmx"], "sse4.2"),
        (&["--runs", "0"], "from 1 to 1000"),
        (&["--json", "no/such/place.json"], "no/such"),
    ];
    for (arguments, part) in cases {
        let directory = tempfile::tempdir().unwrap();
        let output = bench(directory.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
    }
}
