//! The ends of a render.

use super::common::{json, temp};

#[test]
fn time_limit_and_noise_target_end_a_render() {
    let directory = temp();
    let ended = |arguments: &[&str]| {
        let common = ["--batch", "--size", "32x18", "--threads", "2", "--json", "-"];
        json(directory.path(), &[&common, arguments].concat())
    };
    assert_eq!(ended(&["--time-limit", "0.3"])["ended_by"], "time_limit");
    let json = ended(&["--noise-target", "0.05", "--time-limit", "1000"]);
    assert_eq!(json["ended_by"], "noise_target");
    assert!(json["rmse_estimate"].as_f64().unwrap() <= 0.05);
    assert_eq!(ended(&["--samples", "3", "--time-limit", "1000"])["ended_by"], "samples");
}
