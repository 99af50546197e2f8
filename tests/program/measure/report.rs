//! `weekender report`: its files and figures, and what it refuses.

use crate::common::program::{json_file, refused, succeeds};
use std::fs;
use tempfile::TempDir;

#[test]
fn report_has_files_and_plausible_figures() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let small = "report --progress off --out found --scenes three-spheres --size 48x27 --seeds 4 --max-samples 32 \
                 --time-limit 600 --backends cpu,portable --target 0.02";
    let text = succeeds(at, &small.split_whitespace().collect::<Vec<_>>());
    assert!(text.contains("error-vs-time.svg"), "{text}");
    let found = json_file(&at.join("found/report.json"));
    let is_raw = |run: &&serde_json::Value| !run["backend"].as_str().unwrap().ends_with("denoised");
    let (runs, denoised): (Vec<_>, Vec<_>) = found["runs"].as_array().unwrap().iter().partition(is_raw);
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
        assert_eq!(of(5, "rejected"), 0.0);
        let ratio = (of(5, "mse_estimate") / of(5, "mse")).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    assert!(table.contains("| cpu | sobol |") && table.contains("weekender report --progress"), "{table}");
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
        (&["--out", "o", "--scenes", "three-sphere"], &["three-sphere", "--list"]),
        (&["--out", "o", "--scenes", "book,metals,book"], &["two scenes called book", "leave one out"]),
        (&["--out", "o", "--backends", "cpu,tpu"], &["tpu", "scalar", "c89"]),
        (&["--out", "o", "--backends", "cpu", "--adapter", "x"], &["--adapter", "gpu"]),
    ];
    for (arguments, parts) in cases {
        refused(at, &[&["report"], arguments].concat(), parts);
    }
}
