//! `weekender report`: what it writes, that it goes on where it ended, and what it refuses.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn report(arguments: &[&str], directory: &Path) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    let Output { status, stdout, stderr } = command
        .args([&["report", "--progress", "off"], arguments].concat())
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

const SMALL: [&str; 12] = [
    "--out",
    "found",
    "--scenes",
    "three-spheres",
    "--size",
    "48x27",
    "--seeds",
    "4",
    "--max-samples",
    "32",
    "--time-limit",
    "600",
];

fn data(at: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(at.join("found/report.json")).unwrap()).unwrap()
}

#[test]
fn a_report_has_its_files_and_figures_that_make_sense() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let (code, text, errors) = report(&[&SMALL[..], &["--backends", "cpu,baseline"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    assert!(text.contains("error-vs-time.png"), "{text}");
    let data_found = data(at);
    let runs = data_found["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 2 * 2 * 4);
    for run in runs {
        let points = run["points"].as_array().unwrap();
        let samples: Vec<u64> = points.iter().map(|p| p["samples"].as_u64().unwrap()).collect();
        assert_eq!(samples, [1, 2, 4, 8, 16, 32]);
        let of = |point: usize, key: &str| points[point][key].as_f64().unwrap();
        // Halves of 16 times as many samples have at least 3 times less error, the true one and the estimated one.
        for key in ["mse", "mse_estimate", "rel_mse"] {
            assert!(of(5, key) < of(1, key) / 9.0, "{key}: {} to {}", of(1, key), of(5, key));
        }
        assert!(of(5, "flip") < of(0, "flip") && of(5, "wall_seconds") >= of(5, "trace_seconds"));
        assert_eq!(of(5, "rejected"), 0.0);
        let ratio = (of(5, "mse_estimate") / of(5, "mse")).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    let rounding = data_found["rounding"].as_array().unwrap();
    assert_eq!(rounding.len(), 2);
    assert!(
        rounding
            .iter()
            .all(|row| row["rms"].as_f64().unwrap() < 1e-3 && row["bias"].as_f64().unwrap().abs() < 1e-4)
    );

    let csv = fs::read_to_string(at.join("found/report.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 16 * 6);
    let fields = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == fields));
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    for part in [
        "| cpu | sobol |",
        "Sobol points against",
        "Is the estimate true",
        "What rounding costs",
        "weekender report --progress",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(image::open(at.join("found/error-vs-time.png")).unwrap().width() > 500);
    assert!(fs::read_to_string(at.join("found/error-vs-time.svg")).unwrap().contains("cpu, sobol"));
}

#[test]
fn a_report_goes_on_with_what_is_there() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let sobol = [&SMALL[..], &["--backends", "cpu", "--samplers", "sobol"]].concat();
    assert_eq!(report(&sobol, at).0, 0);
    let first = data(at);
    // More curves with the same settings: those that are there stay, to the bit, times and all.
    let both = [&SMALL[..], &["--backends", "cpu", "--samplers", "sobol,independent"]].concat();
    assert_eq!(report(&both, at).0, 0);
    let second = data(at);
    assert_eq!(second["runs"].as_array().unwrap().len(), 8);
    assert_eq!(second["runs"].as_array().unwrap()[..4], first["runs"].as_array().unwrap()[..]);
    // A run that is missing is measured again, with the kept reference.
    let mut cut = second.clone();
    cut["runs"].as_array_mut().unwrap().truncate(3);
    fs::write(at.join("found/report.json"), cut.to_string()).unwrap();
    let kept = fs::metadata(at.join("found/reference-three-spheres.exr")).unwrap().modified().unwrap();
    assert_eq!(report(&sobol, at).0, 0);
    let third = data(at);
    assert_eq!(third["runs"].as_array().unwrap().len(), 4);
    assert_eq!(third["runs"][3]["points"][5]["mse"], first["runs"][3]["points"][5]["mse"]);
    assert_eq!(fs::metadata(at.join("found/reference-three-spheres.exr")).unwrap().modified().unwrap(), kept);
    // The kept reference serves as a given one.
    let given = ["--reference", "found/reference-three-spheres.exr"];
    let (code, _, errors) = report(&[&sobol[..], &given[..]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    assert_eq!(data(at)["runs"][0]["points"][5]["mse"], first["runs"][0]["points"][5]["mse"]);
}

#[test]
fn what_cannot_be_measured_is_refused_before_anything_is_rendered() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("file"), "").unwrap();
    let cases: [(&[&str], &[&str]); 7] = [
        (&[], &["--out"]),
        (&["--out", "file"], &["file", "choose another"]),
        (&["--out", "o", "--scenes", "three-sphere"], &["three-sphere", "three-spheres"]),
        (&["--out", "o", "--backends", "cpu,tpu"], &["tpu", "scalar"]),
        (&["--out", "o", "--reference", "x.exr"], &["--reference", "--scenes"]),
        (&["--out", "o", "--scenes", "book", "--reference", "x.exr"], &["x.exr"]),
        (&["--out", "o", "--backends", "cpu", "--adapter", "x"], &["--adapter", "gpu"]),
    ];
    for (arguments, parts) in cases {
        let (code, text, message) = report(arguments, at);
        assert_eq!((code, text.as_str()), (2, ""), "{arguments:?}: {message}");
        for part in parts {
            assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
        }
    }
}
