//! Warnings: what is rendered, but is not what was meant.

use super::common::{render, run, temp, text};
use serde_json::Value;
use std::path::Path;

/// The warnings of a picture in its JSON. Each is on standard error as well.
fn warnings(directory: &Path, arguments: &[&str]) -> Vec<String> {
    let output = render(directory, &[arguments, &["--device", "cpu", "--json", "-"]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warnings = json["warnings"].as_array().unwrap().iter();
    let warnings: Vec<String> = warnings.map(|warning| warning.as_str().unwrap().to_owned()).collect();
    let told = text(&output.stderr);
    for warning in &warnings {
        assert!(told.contains(&format!("warning: {warning}")), "{warning:?} is not in {told}");
    }
    warnings
}

#[test]
fn flags_that_a_stage_ignores_are_named() {
    let directory = temp();
    let tiny = ["--stage", "ppm-tiny", "--look-from", "1,2,3"];
    let expected = ["--look-from has no effect: the stage ppm-tiny traces no rays"];
    assert_eq!(warnings(directory.path(), &tiny), expected);
    let turn = [&tiny[..2], &["--turntable=2", "--out", "turn"]].concat();
    let expected = ["--turntable has no effect: the stage ppm-tiny traces no rays"];
    assert_eq!(warnings(directory.path(), &turn), expected);
    let plan = [&["plan", "--parts", "2", "--out", "p", "--samples", "4"], &tiny[..]].concat();
    let told = text(&run(directory.path(), &plan).stderr);
    assert!(told.contains("warning: --look-from has no effect"), "{told}");
    assert!(told.contains("warning: --samples above 1 has no effect"), "{told}");
}
