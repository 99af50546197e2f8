//! The program with a GPU, as users run it: the device is lost, or CPU and GPU share a film.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use std::process::{Command, Output};
use tempfile::TempDir;
use weekender::film::checkpoint;
use weekender::render_gpu::GpuOptions;

/// Runs the program on the tests' adapter; `None` without one.
fn run(directory: &TempDir, arguments: &[&str]) -> Option<Output> {
    let gpu = gpu_common::gpu(GpuOptions::default())?;
    let adapter = gpu.adapter();
    let program = env!("CARGO_BIN_EXE_weekender");
    let mut command = Command::new(program);
    let output = command
        .current_dir(directory.path())
        .args(["--batch", "--size", "64x36", "--progress", "off", "--adapter", &adapter.name])
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(output)
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
                let output = run(&directory, &[&arguments[..], &["broken.json"]].concat())?;
                let film = checkpoint::load(&directory.path().join("broken.exr")).unwrap().film;
                assert_eq!((film.sample_count(), film.rejected()), (samples, 0), "{device} {flag}");
                let parts = parts(&directory, "broken.json");
                assert_eq!(
                    parts.iter().map(|(_, samples)| samples).sum::<u64>(),
                    samples,
                    "{device} {flag}: {parts:?}"
                );
                assert!(
                    parts.iter().any(|(name, samples)| name == "cpu" && *samples > 0),
                    "{device} {flag}: {parts:?}"
                );
                let message = String::from_utf8_lossy(&output.stderr).into_owned();
                (device == "gpu" || message.contains("continues")).then_some(message)
            });
            let Some(message) = broken else {
                assert!(gpu_common::gpu(GpuOptions::default()).is_none(), "{device} {flag}: no warning");
                return;
            };
            assert!(message.contains(word) && message.contains("continues"), "{device} {flag}: {message}");
        }
    }
}

/// The number of samples that each backend added, from the JSON.
fn parts(directory: &TempDir, name: &str) -> Vec<(String, u64)> {
    let json = std::fs::read_to_string(directory.path().join(name)).unwrap();
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
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
        let cpu =
            ["--batch", "--size", "64x36", "--progress", "off", "--device", "cpu", "--sample-range", &range];
        let program = || Command::new(env!("CARGO_BIN_EXE_weekender"));
        let second =
            program().current_dir(directory.path()).args(cpu).args(["--out", "second.exr"]).output().unwrap();
        assert!(second.status.success());
    }
    let load = |name: &str| checkpoint::load(&directory.path().join(name)).unwrap().film;
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
    let film = checkpoint::load(&directory.path().join("both.exr")).unwrap().film;
    assert_eq!(film.samples().to_string(), "0..256");
    let parts = parts(&directory, "both.json");
    assert_eq!(parts.len(), 2, "{parts:?}");
    assert!(parts.iter().all(|(_, samples)| *samples > 0), "{parts:?}");
    assert_eq!(parts.iter().map(|(_, samples)| samples).sum::<u64>(), 256);
}
