//! `weekender bench` as a program: what it measures, writes and refuses.

use crate::common::program::{ends, json_file, outcome, refused, weekender};
use serde_json::Value;

const TINY: [&str; 11] =
    ["bench", "--size", "32x18", "--samples", "4", "--runs", "3", "--run-limit", "0.2", "--threads", "2"];

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
    let flags = ["--scene", "three-spheres", "--scene", "book", "--json", "b.json"];
    let (table, message) = ends(directory.path(), 0, &[&TINY[..], &flags].concat());
    assert!(table.contains("three-spheres") && message.is_empty(), "quiet when redirected: {message}");
    let report = json_file(&directory.path().join("b.json"));
    assert_eq!((&report["schema"], &report["interrupted"]), (&3.into(), &false.into()));
    let scenes = report["scenes"].as_array().unwrap();
    assert_eq!(scenes.iter().map(|scene| &scene["scene"]).collect::<Vec<_>>(), ["three-spheres", "book"]);
    for scene in scenes {
        let rows = scene["rows"].as_array().unwrap();
        let kinds: Vec<&str> = rows.iter().map(|row| row["kind"].as_str().unwrap()).collect();
        assert_eq!(kinds[0], "baseline");
        assert!(kinds.contains(&"scalar") && kinds.contains(&"threads"), "{kinds:?}");
        let baseline = number(&rows[0]["paths_per_second"], "median");
        for row in rows {
            check_spread(&row["paths_per_second"]);
            check_spread(&row["rays_per_second"]);
            let ratio = number(&row["paths_per_second"], "median") / baseline;
            assert!((number(row, "ratio_to_baseline") / ratio - 1.0).abs() < 1e-9);
            assert_eq!(row["runs"].as_array().unwrap().len(), 3);
            for run in row["runs"].as_array().unwrap() {
                assert_eq!(number(run, "paths"), 32.0 * 18.0 * number(row, "samples_per_pixel"));
                let rays = number(run, "rays") / number(run, "paths");
                assert!((1.0..24.0).contains(&rays), "{rays} rays a path");
            }
            let lanes = row["lanes_in_use"].as_f64();
            assert_eq!(lanes.is_none(), row["kind"] == "baseline", "{row}");
            // An absorbed path costs a single lane one more iteration.
            let least = if row["lanes"] == 1 { 0.9 } else { 0.0 };
            assert!(lanes.is_none_or(|share| (least..=1.0).contains(&share)), "{row}");
        }
    }
}

#[test]
fn baseline_is_skipped_without_compiler() {
    let directory = tempfile::tempdir().unwrap();
    for (compiler, part) in [("no-such-compiler", "no-such-compiler"), (" ", "C89, cc -O2")] {
        let mut command = weekender(directory.path(), &[&TINY[..], &["--scene", "metals"]].concat());
        let (code, table, _) = outcome(&command.env("CC", compiler).output().unwrap());
        assert!(code == Some(0) && table.contains(part), "{table}");
    }
}

#[test]
fn bad_flags_fail_early() {
    let directory = tempfile::tempdir().unwrap();
    for (flags, part) in [
        (["--scene", "no-such"], "no-such"),
        (["--isa", "mmx"], "sse4.2"),
        (["--runs", "0"], "1000"),
        (["--json", "no/such/place.json"], "no/such"),
    ] {
        refused(directory.path(), &[&["bench"], &flags[..]].concat(), &[part]);
    }
}
