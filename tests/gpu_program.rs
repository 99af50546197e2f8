//! The program with a GPU, as its user runs it: the device lost in mid-flight, CPU and GPU on one film.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod gpu_common;

use std::process::{Command, Output};
use tempfile::TempDir;
use weekender::film::checkpoint;

/// Runs the program on the adapter of these tests; `None` where there is none.
fn run(directory: &TempDir, arguments: &[&str]) -> Option<Output> {
    let adapter = gpu_common::gpu(weekender::render_gpu::GpuOptions::default())?.adapter().name.clone();
    let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .current_dir(directory.path())
        .args(["--batch", "--size", "64x36", "--progress", "off", "--adapter", &adapter])
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(output)
}

#[test]
fn a_lost_device_leaves_a_whole_picture_and_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    for device in ["gpu", "cpu,gpu"] {
        let arguments =
            ["--device", device, "--samples", "64", "--simulate-device-lost", "2", "--out", "lost.exr"];
        let Some(output) = run(&directory, &arguments) else { return };
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(message.contains("lost") && message.contains("goes on"), "{device}: {message}");
        let film = checkpoint::load(&directory.path().join("lost.exr")).unwrap().film;
        assert_eq!((film.sample_count(), film.rejected()), (64, 0), "{device}");
    }
}

#[test]
fn cpu_and_gpu_share_a_film_and_say_who_did_what() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = ["--device", "cpu,gpu", "--samples", "256", "--out", "both.exr", "--json", "both.json"];
    if run(&directory, &arguments).is_none() {
        return;
    }
    let film = checkpoint::load(&directory.path().join("both.exr")).unwrap().film;
    assert_eq!(film.samples().to_string(), "0..256");
    let json = std::fs::read_to_string(directory.path().join("both.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    let shares = report["backends"].as_array().unwrap();
    let samples = |share: &serde_json::Value| share["samples_per_pixel"].as_u64().unwrap();
    assert_eq!(shares.len(), 2, "{json}");
    assert!(shares.iter().all(|share| samples(share) > 0), "{json}");
    assert_eq!(shares.iter().map(samples).sum::<u64>(), 256);
}
