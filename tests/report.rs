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
fn baseline_has_own_curve() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let (code, _, errors) =
        report(&[&SMALL[..], &["--backends", "cpu,c89", "--samplers", "independent"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    let found = data(at);
    let (runs, _) = runs(&found);
    // Independent samples of the same picture have the same error on every backend: compares all runs at 32 samples.
    let mean = |backend: &str| {
        let of = runs.iter().filter(|run| run["backend"] == backend);
        let errors: Vec<f64> = of.map(|run| run["points"][5]["mse"].as_f64().unwrap()).collect();
        assert_eq!(errors.len(), 4, "{backend}");
        errors.iter().sum::<f64>() / 4.0
    };
    let ratio = mean("c89") / mean("cpu");
    assert!((0.85..1.18).contains(&ratio), "{ratio}");
    assert!(found["calibration"].as_array().unwrap().iter().all(|row| row["backend"] == "cpu"));
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    assert!(table.contains("times c89") && table.contains("| c89 | independent |"), "{table}");
    // Without a compiler there is no baseline, which is an error if it was asked for.
    let failing = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .args(["report", "--out", "other", "--backends", "c89"])
        .env("CC", "no-such-compiler")
        .current_dir(at)
        .output()
        .unwrap();
    let message = String::from_utf8(failing.stderr).unwrap();
    assert_eq!(failing.status.code(), Some(2), "{message}");
    assert!(message.contains("no-such-compiler") && message.contains("CC"), "{message}");
}

#[test]
fn estimates_are_compared_with_errors() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let seeds = ["--seeds", "12", "--reference-samples", "512", "--backends", "cpu"];
    let (code, _, errors) = report(&[&SMALL[..6], &SMALL[8..], &seeds[..]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    let found = data(at);
    assert_eq!(found["settings"]["reference_samples"], 512);
    let rows = found["calibration"].as_array().unwrap();
    let what: Vec<_> =
        rows.iter().map(|row| (row["sampler"].as_str().unwrap(), row["samples"].as_u64().unwrap())).collect();
    assert_eq!(what, [("independent", 16), ("independent", 32), ("sobol", 16), ("sobol", 32)]);
    for row in rows {
        let of = |key: &str| row[key].as_f64().unwrap();
        assert_eq!(of("seeds"), 12.0);
        assert!((of("predicted_rmse") / of("actual_rmse") - of("ratio")).abs() < 1e-9, "{row}");
        // The deviation is itself uncertain, hence 4 deviations, but at least a hundredth.
        assert!(
            (of("ratio") - 1.0).abs() < 4.0 * of("deviation").max(0.01) && of("deviation") < 0.05,
            "{row}"
        );
    }
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    assert!(table.contains("4 of 4 ratios are within 1 ± 0.05"), "{table}");
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
