//! Outputs: what is written where, and which ones are refused.

use super::common::{film, names, refused, refused_in, render, run, temp, text};
use serde_json::Value;

#[test]
fn the_default_picture_is_named_after_its_scene() {
    let directory = temp();
    let output = render(directory.path(), &["--samples", "2"]);
    assert_eq!(names(directory.path()), ["three-spheres.png"]);
    let summary = text(&output.stdout);
    for part in [
        "three-spheres, 32x18",
        "kernel   ",
        "left out lens, ",
        "2 per pixel",
        "number of samples",
        "three-spheres.png",
        "threads",
    ] {
        assert!(summary.contains(part), "{summary}");
    }
    assert!(output.stderr.is_empty(), "quiet when redirected: {}", text(&output.stderr));
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_rendering() {
    let endless = ["--batch", "--samples", "4294967296", "--size", "1600x900"];
    let with = |more: &[&'static str]| [&endless[..], more].concat();
    refused(&with(&["--out", "x.jpg"]), &["x.jpg", ".png", ".ppm", ".exr"]);
    refused(&with(&["--out", "x"]), &["x", ".png"]);
    refused(&with(&["--out", "nowhere/x.png"]), &["nowhere/x.png"]);
    refused(&with(&["--checkpoint", "nowhere/x.exr"]), &["nowhere/x.exr"]);
    refused(&with(&["--checkpoint", "x.png"]), &["--checkpoint", "x.png", ".exr"]);
    refused(&with(&["--json", "nowhere/x.json"]), &["nowhere/x.json"]);
    refused(&with(&["--save-scene", "nowhere/x.toml"]), &["nowhere/x.toml"]);
    refused(&with(&["--out", "x.exr", "--checkpoint", "x.exr"]), &["x.exr", "name of its own"]);
    refused(&["--out", "x.png"], &["--batch"]);
    refused(&with(&["--every", "5m"]), &["--checkpoint"]);
}

#[test]
fn list_names_scenes_stages_and_devices() {
    let output = run(temp().path(), &["--list"]);
    assert!(output.status.success());
    let list = text(&output.stdout);
    for part in ["three-spheres", "book", "glass-schlick", "11.4", "portable", "reference", "(auto)"] {
        assert!(list.contains(part), "{list}");
    }
}

#[test]
fn an_output_is_no_input_and_no_other_output() {
    let directory = temp();
    let path = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "2", "--checkpoint", "g.exr"]);
    let saved = run(directory.path(), &["--save-scene", "s.toml"]);
    assert!(saved.status.success(), "{}", text(&saved.stderr));
    let before = std::fs::read(path("g.exr")).unwrap();
    let endless = ["--batch", "--samples", "4294967296", "--size", "32x18"];
    let refused =
        |more: &[&str], parts: &[&str]| refused_in(&directory, &[&endless[..], more].concat(), parts);
    refused(&["--out", "x.exr", "--checkpoint", "./x.exr"], &["x.exr", "name of its own"]);
    refused(&["--resume", "g.exr", "--json", "./g.exr"], &["g.exr"]);
    refused(&["--scene", "s.toml", "--save-scene", "./s.toml"], &["s.toml"]);
    let frames = ["--turntable=3", "--out", "fr", "--json", "fr/frame-0001.png"];
    std::fs::create_dir(path("fr")).unwrap();
    refused(&frames, &["fr/frame-0001.png"]);
    refused_in(&directory, &["merge", "g.exr", "--out", "./g.exr"], &["./g.exr would replace"]);
    refused_in(&directory, &["diff", "--pixel", "1,1", "--scene", "s.toml", "--json", "s.toml"], &["s.toml"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("g.exr", path("link.exr")).unwrap();
        refused(&["--resume", "link.exr", "--json", "g.exr"], &["g.exr"]);
    }
    assert_eq!(std::fs::read(path("g.exr")).unwrap(), before);
    // A film may be replaced by its own continuation.
    let resumed =
        ["--resume", "g.exr", "--checkpoint", "./g.exr", "--samples", "4", "--batch", "--out", "y.png"];
    let output = run(directory.path(), &resumed);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(film(path("g.exr")).sample_count(), 4);
}

#[test]
fn outputs_never_replace_files_of_a_plan() {
    let directory = temp();
    let plan = ["plan", "--parts", "2", "--size", "8x4", "--samples", "4", "--out"];
    assert!(run(directory.path(), &[&plan[..], &["q"]].concat()).status.success());
    for name in ["q/plan.json", "q/scene.toml", "q/part-1.exr"] {
        let part = ["render-part", "q", "--part", "0", "--json", name];
        refused_in(&directory, &part, &[name]);
    }
    let merge = ["merge", "q", "--out", "q/part-0.exr"];
    refused_in(&directory, &merge, &["q/part-0.exr"]);
}

#[test]
fn json_has_the_figures() {
    let directory = temp();
    render(directory.path(), &["--samples", "16", "--seed", "7", "--json", "figures.json"]);
    let json: Value =
        serde_json::from_slice(&std::fs::read(directory.path().join("figures.json")).unwrap()).unwrap();
    for (key, value) in [
        ("schema", Value::from(1)),
        ("scene", Value::from("three-spheres")),
        ("width", Value::from(32)),
        ("samples_per_pixel", Value::from(16)),
        ("ended_by", Value::from("samples")),
        ("files", Value::from(vec!["three-spheres.png"])),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert!(json["left_out"].as_array().unwrap().contains(&Value::from("lens")), "{}", json["left_out"]);
    let number = |key: &str| json[key].as_f64().unwrap();
    let parts = ["prepare_seconds", "hierarchy_seconds", "trace_seconds", "write_seconds"].map(number);
    assert!(number("total_seconds") > parts.iter().sum::<f64>() - 1e-6, "{json}");
    let paths = number("paths_per_second") * number("trace_seconds");
    assert!((paths / number("paths") - 1.0).abs() < 1e-9 && number("paths") == 32.0 * 18.0 * 16.0, "{json}");
    assert_eq!(json["history"].as_array().unwrap().last().unwrap()["samples_per_pixel"], 16);

    let output = render(directory.path(), &["--samples", "1", "--estimate-error", "off", "--json", "-"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["rmse_estimate"].is_null());
    assert!(text(&output.stderr).contains("three-spheres"), "the summary makes way for the JSON");
}

/// Its loader takes time, and some of its libraries print messages of their own.
#[test]
fn only_what_may_need_a_gpu_looks_for_one() {
    let directory = temp();
    let log = |arguments: &[&str]| {
        let output = run(directory.path(), &[arguments, &["--log", "run.log"]].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        std::fs::read_to_string(directory.path().join("run.log")).unwrap()
    };
    let picture = ["--batch", "--device", "cpu", "--size", "16x9", "--samples", "1", "--out", "a.png"];
    for arguments in [&picture[..], &["info", "a.png"], &["compare", "a.png", "a.png"]] {
        let log = log(arguments);
        assert!(!log.contains("found "), "{arguments:?}: {log}");
    }
}
