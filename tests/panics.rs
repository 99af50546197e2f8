//! A panic in the tracer: the picture is complete, and the user is told.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::process::Command;
use weekender::film::checkpoint;

#[test]
fn a_panic_of_the_tracer_leaves_a_whole_picture_and_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    for (tiles, level) in [("0", "auto"), ("7", "auto"), ("30", "auto"), ("20", "portable")] {
        let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
            .current_dir(directory.path())
            .args(["--batch", "--device", "cpu", "--size", "100x70", "--samples", "64", "--isa", level])
            .args(["--simulate-panic", tiles, "--out", "broken.exr", "--json", "broken.json"])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{tiles}: {said}");
        assert!(said.contains("panicked") && said.contains("continues the same picture"), "{tiles}: {said}");
        let film = checkpoint::load(&directory.path().join("broken.exr")).unwrap().film;
        assert_eq!((film.samples().to_string().as_str(), film.rejected()), ("0..64", 0), "{tiles}");
        let json = std::fs::read_to_string(directory.path().join("broken.json")).unwrap();
        let report: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(report["warnings"].as_array().unwrap().len(), 1, "{report}");
        let added: u64 = report["backends"]
            .as_array()
            .unwrap()
            .iter()
            .map(|part| part["samples_per_pixel"].as_u64().unwrap())
            .sum();
        assert_eq!(added, 64, "{report}");
    }
}
