//! The program with a GPU, as users run it: the device is lost, or CPU and GPU share a film.

use crate::common::program::{ends, film, json_file};
use tempfile::TempDir;
use weekender::render_gpu::GpuOptions;

const PICTURE: [&str; 5] = ["--batch", "--size", "64x36", "--progress", "off"];

/// Runs the program on the tests' adapter, and returns its messages; `None` without one.
fn run(directory: &TempDir, arguments: &[&str]) -> Option<String> {
    let gpu = crate::common::gpu::gpu(GpuOptions::default())?;
    let adapter = ["--adapter", &gpu.adapter().name];
    Some(ends(directory.path(), 0, &[&PICTURE, &adapter[..], arguments].concat()).1)
}

#[test]
fn fault_completes_picture_with_warning() {
    let directory = tempfile::tempdir().unwrap();
    let faults = [("--simulate-device-lost", "lost"), ("--simulate-invalid-call", "alidation")];
    // Beside the CPU, a slow device may only get its first piece.
    for (device, after) in [("gpu", "3"), ("cpu,gpu", "0")] {
        for (flag, word) in faults {
            // The CPU may trace a few samples before the device takes its first piece.
            let broken = [64, 4096, 262_144].into_iter().find_map(|samples| {
                let count = samples.to_string();
                let arguments =
                    ["--device", device, "--samples", &count, flag, after, "--out", "broken.exr", "--json"];
                let message = run(&directory, &[&arguments[..], &["broken.json"]].concat())?;
                let film = film(&directory.path().join("broken.exr"));
                assert_eq!((film.sample_count(), film.rejected()), (samples, 0), "{device} {flag}");
                let parts = parts(&directory, "broken.json");
                assert_eq!(
                    parts.iter().map(|part| part.1).sum::<u64>(),
                    samples,
                    "{device} {flag}: {parts:?}"
                );
                assert!(parts.iter().any(|(name, added)| name == "cpu" && *added > 0), "{parts:?}");
                (device == "gpu" || message.contains("continues")).then_some(message)
            });
            let Some(message) = broken else {
                assert!(
                    crate::common::gpu::gpu(GpuOptions::default()).is_none(),
                    "{device} {flag}: no warning"
                );
                return;
            };
            assert!(message.contains(word) && message.contains("continues"), "{device} {flag}: {message}");
        }
    }
}

/// The number of samples that each backend added, from the JSON.
fn parts(directory: &TempDir, name: &str) -> Vec<(String, u64)> {
    let report = json_file(&directory.path().join(name));
    let part = |share: &serde_json::Value| {
        (share["name"].as_str().unwrap().to_owned(), share["samples_per_pixel"].as_u64().unwrap())
    };
    report["backends"].as_array().unwrap().iter().map(part).collect()
}

/// The device's samples equal the GPU's bit for bit, and the others the CPU's.
#[test]
fn film_after_fault_matches_counts() {
    let directory = tempfile::tempdir().unwrap();
    let lost =
        ["--samples", "256", "--simulate-invalid-call", "5", "--out", "both.exr", "--json", "both.json"];
    if run(&directory, &[&["--device", "gpu"][..], &lost].concat()).is_none() {
        return;
    }
    let parts = parts(&directory, "both.json");
    println!("{parts:?}");
    let by_gpu = parts.iter().find(|(name, _)| name == "gpu").map_or(0, |(_, samples)| *samples);
    let split = by_gpu.to_string();
    let range = format!("{split}..256");
    if by_gpu > 0 {
        run(&directory, &["--device", "gpu", "--samples", &split, "--out", "first.exr"]).unwrap();
        let cpu = ["--device", "cpu", "--sample-range", &range, "--out", "second.exr"];
        ends(directory.path(), 0, &[&PICTURE, &cpu[..]].concat());
    }
    let load = |name: &str| film(&directory.path().join(name));
    let mut expected = load("first.exr");
    expected.merge(&load("second.exr")).unwrap();
    assert!(load("both.exr") == expected);
}

#[test]
fn cpu_and_gpu_share_film() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = ["--device", "cpu,gpu", "--samples", "256", "--out", "both.exr", "--json", "both.json"];
    if run(&directory, &arguments).is_none() {
        return;
    }
    assert_eq!(film(&directory.path().join("both.exr")).samples().to_string(), "0..256");
    let parts = parts(&directory, "both.json");
    assert_eq!(parts.len(), 2, "{parts:?}");
    assert!(parts.iter().all(|(_, samples)| *samples > 0), "{parts:?}");
    assert_eq!(parts.iter().map(|(_, samples)| samples).sum::<u64>(), 256);
}
