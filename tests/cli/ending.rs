//! What ends a render.

use super::common::{PATIENCE, render, temp};
use serde_json::Value;
use std::time::Instant;

#[test]
fn time_limit_and_noise_target_end_a_render() {
    let directory = temp();
    let ended = |arguments: &[&str]| {
        let output = render(directory.path(), &[arguments, &["--json", "-"]].concat());
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let begin = Instant::now();
    let json = ended(&["--time-limit", "0.3"]);
    assert_eq!(json["ended_by"], "time_limit");
    assert!(begin.elapsed() < PATIENCE && json["total_seconds"].as_f64().unwrap() < 10.0);
    let json = ended(&["--noise-target", "0.05", "--time-limit", "100"]);
    assert_eq!(json["ended_by"], "noise_target");
    assert!(json["rmse_estimate"].as_f64().unwrap() <= 0.05);
    assert_eq!(ended(&["--samples", "3", "--time-limit", "100"])["ended_by"], "samples");
}
