//! `weekender report`: its files and figures, and what it refuses.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn command(arguments: &[&str], directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.arg("report").args(arguments).current_dir(directory).stdin(Stdio::null());
    command
}

fn report(arguments: &[&str], directory: &Path) -> (i32, String, String) {
    let mut command = command(&[&["--progress", "off"], arguments].concat(), directory);
    let Output { status, stdout, stderr } = command.output().unwrap();
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

/// The raw runs of a report, and the denoised ones.
fn runs(found: &serde_json::Value) -> (Vec<&serde_json::Value>, Vec<&serde_json::Value>) {
    let is_raw = |run: &&serde_json::Value| !run["backend"].as_str().unwrap().ends_with("denoised");
    found["runs"].as_array().unwrap().iter().partition(is_raw)
}

#[test]
fn report_has_files_and_plausible_figures() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let (code, text, errors) =
        report(&[&SMALL[..], &["--backends", "cpu,portable", "--target", "0.02"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    assert!(text.contains("error-vs-time.svg"), "{text}");
    let data_found = data(at);
    let (runs, denoised) = runs(&data_found);
    assert_eq!((runs.len(), denoised.len()), (2 * 2 * 4, 2 * 4));
    for run in &runs {
        let points = run["points"].as_array().unwrap();
        let samples: Vec<u64> = points.iter().map(|p| p["samples"].as_u64().unwrap()).collect();
        assert_eq!(samples, [1, 2, 4, 8, 16, 32]);
        let of = |point: usize, key: &str| points[point][key].as_f64().unwrap();
        // With 16 times as many samples, true and estimated errors are at least 3 times smaller.
        for key in ["mse", "mse_estimate", "rel_mse"] {
            assert!(of(5, key) < of(1, key) / 9.0, "{key}: {} to {}", of(1, key), of(5, key));
        }
        assert!(of(5, "wall_seconds") >= of(5, "trace_seconds"));
        assert_eq!(of(5, "rejected"), 0.0);
        let ratio = (of(5, "mse_estimate") / of(5, "mse")).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    for part in [
        "| cpu | sobol |",
        "| to RMSE 0.02 | to RMSE 0.01 | to RMSE 0.001 |",
        "Is the error estimate accurate",
        "weekender report --progress",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(fs::read_to_string(at.join("found/error-vs-time.svg")).unwrap().contains("cpu, sobol"));
}

#[test]
fn bad_requests_fail_before_rendering() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("file"), "").unwrap();
    let cases: [(&[&str], &[&str]); 6] = [
        (&[], &["--out"]),
        (&["--out", "file"], &["file", "choose another"]),
        (&["--out", "o", "--scenes", "three-sphere"], &["three-sphere", "three-spheres"]),
        (&["--out", "o", "--scenes", "book,metals,book"], &["two scenes called book", "leave one out"]),
        (&["--out", "o", "--backends", "cpu,tpu"], &["tpu", "scalar", "c89"]),
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
