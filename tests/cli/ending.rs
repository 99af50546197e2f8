//! What ends a render.

use super::common::{PATIENCE, film, names, render, run, temp, text, wait, weekender};
use serde_json::Value;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

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

#[cfg(unix)]
#[test]
fn ctrl_c_writes_picture_and_checkpoint() {
    let directory = temp();
    let mut child = weekender(
        directory.path(),
        &[
            "--batch",
            "--size",
            "64x36",
            "--samples",
            "4294967296",
            "--checkpoint",
            "film.exr",
            "--progress",
            "on",
        ],
    )
    .stdout(Stdio::null())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap();
    // It prints its first line once it handles signals.
    let mut stderr = std::io::BufReader::new(child.stderr.take().unwrap());
    std::io::BufRead::read_line(&mut stderr, &mut String::new()).unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let killed = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());

    let status = wait(&mut child, "the interrupted render");
    assert_eq!(status.code(), Some(130));
    assert_eq!(names(directory.path()), ["film.exr", "three-spheres.png"]);
    let samples = film(directory.path().join("film.exr")).sample_count();
    assert!(samples > 0);

    // The saved film can be resumed.
    let more = (samples + 2).to_string();
    let resumed =
        run(directory.path(), &["--batch", "--resume", "film.exr", "--samples", &more, "--out", "more.exr"]);
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert_eq!(film(directory.path().join("more.exr")).sample_count(), samples + 2);
}
