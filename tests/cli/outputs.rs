//! What is written, where, and which outputs are refused.

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
fn the_ending_decides_the_format() {
    let directory = temp();
    for (name, magic) in [("a.png", &b"\x89PNG"[..]), ("b.ppm", b"P6"), ("c.exr", b"\x76\x2f\x31\x01")] {
        render(directory.path(), &["--samples", "1", "--out", name]);
        assert!(std::fs::read(directory.path().join(name)).unwrap().starts_with(magic), "{name}");
    }
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
    refused(&with(&["--out", "x.exr", "--checkpoint", "x.exr"]), &["--out", "--checkpoint", "x.exr"]);
    refused(&with(&["--stage", "all"]), &["--out DIR"]);
    refused(&["--batch", "--stage", "all", "--out", "d", "--checkpoint", "x.exr"], &["--checkpoint"]);
}

#[test]
fn files_that_get_in_each_other_s_way_are_refused_before_rendering() {
    let directory = temp();
    let path = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "2", "--checkpoint", "g.exr"]);
    let saved = run(directory.path(), &["--save-scene", "s.toml"]);
    assert!(saved.status.success(), "{}", text(&saved.stderr));
    let before = std::fs::read(path("g.exr")).unwrap();
    let endless = ["--batch", "--samples", "4294967296", "--size", "32x18"];
    let refused =
        |more: &[&str], parts: &[&str]| refused_in(&directory, &[&endless[..], more].concat(), parts);
    // Outputs that would replace outputs.
    refused(&["--out", "x.exr", "--checkpoint", "./x.exr"], &["--out", "--checkpoint", "x.exr"]);
    refused(&["--out", "x.png", "--json", "../x.png/../x.png"], &["x.png"]);
    refused(&["--checkpoint", "x.exr", "--save-scene", "x.exr"], &["--checkpoint", "--save-scene"]);
    // Outputs that would replace inputs.
    refused(&["--resume", "g.exr", "--json", "g.exr"], &["--json", "--resume", "g.exr"]);
    refused(&["--resume", "g.exr", "--save-scene", "./g.exr"], &["--save-scene", "--resume"]);
    refused(&["--scene", "s.toml", "--json", "s.toml"], &["--json", "--scene"]);
    refused(&["--scene", "s.toml", "--save-scene", "./s.toml"], &["--save-scene", "--scene"]);
    refused_in(&directory, &["--scene", "s.toml", "--save-scene", "s.toml"], &["--save-scene"]);
    refused_in(
        &directory,
        &["merge", "g.exr", "--out", "./g.exr"],
        &["--out ./g.exr would replace one of the films to merge;"],
    );
    refused_in(&directory, &["compare", "g.exr", "cpu", "--json", "./g.exr"], &["--json", "comparison"]);
    std::fs::copy(path("three-spheres.png"), path("p.png")).unwrap();
    refused_in(&directory, &["compare", "p.png", "cpu", "--heat-map", "./p.png"], &["--heat-map"]);
    refused_in(&directory, &["diff", "--pixel", "1,1", "--scene", "s.toml", "--json", "s.toml"], &["--json"]);
    refused_in(&directory, &["bench", "--scene", "s.toml", "--json", "./s.toml"], &["--json", "--scene"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink("g.exr", path("link.exr")).unwrap();
        refused(&["--resume", "link.exr", "--json", "g.exr"], &["--json", "--resume"]);
        symlink("unborn.exr", path("future.exr")).unwrap();
        refused(&["--out", "future.exr", "--checkpoint", "unborn.exr"], &["--out", "--checkpoint"]);
        std::fs::remove_file(path("future.exr")).unwrap();
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
fn places_that_look_like_files_and_are_none_are_found_before_rendering() {
    let endless = ["--batch", "--samples", "4294967296", "--size", "1600x900"];
    refused(&[&endless[..], &["--out", "nodir.png/"]].concat(), &["nodir.png/", "stands for a directory"]);
    refused(&[&endless[..], &["--out", "nodir.png/."]].concat(), &["nodir.png", "stands for a directory"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        let directory = temp();
        symlink("gone/target.png", directory.path().join("to-nowhere.png")).unwrap();
        let dangling = [&endless[..], &["--out", "to-nowhere.png"]].concat();
        refused_in(&directory, &dangling, &["to-nowhere.png", "create its directory first"]);
        symlink("circle.png", directory.path().join("circle.png")).unwrap();
        refused_in(&directory, &[&endless[..], &["--out", "circle.png"]].concat(), &["circle.png"]);
        // A link to a file that can be created is followed.
        symlink("target.png", directory.path().join("link.png")).unwrap();
        render(directory.path(), &["--samples", "1", "--out", "link.png"]);
        assert!(directory.path().join("link.png").is_symlink());
        assert!(std::fs::read(directory.path().join("target.png")).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn json_has_its_keys() {
    let directory = temp();
    render(directory.path(), &["--samples", "16", "--seed", "7", "--json", "figures.json"]);
    let json: Value =
        serde_json::from_slice(&std::fs::read(directory.path().join("figures.json")).unwrap()).unwrap();
    for (key, value) in [
        ("schema", Value::from(1)),
        ("scene", Value::from("three-spheres")),
        ("width", Value::from(32)),
        ("height", Value::from(18)),
        ("seed", Value::from(7)),
        ("sampler", Value::from("sobol")),
        ("samples_per_pixel", Value::from(16)),
        ("rejected_samples", Value::from(0)),
        ("ended_by", Value::from("samples")),
        ("backend", Value::from("cpu")),
        ("files", Value::from(vec!["three-spheres.png"])),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert!(json["left_out"].as_array().unwrap().contains(&Value::from("lens")), "{}", json["left_out"]);
    for key in [
        "prepare_seconds",
        "trace_seconds",
        "write_seconds",
        "total_seconds",
        "paths_per_second",
        "rays_per_second",
        "rmse_estimate",
        "lanes",
        "threads",
    ] {
        assert!(json[key].is_number(), "{key}: {}", json[key]);
    }
    let number = |key: &str| json[key].as_f64().unwrap();
    let parts = ["prepare_seconds", "hierarchy_seconds", "trace_seconds", "write_seconds"].map(number);
    assert!(
        number("write_seconds") > 0.0 && number("total_seconds") > parts.iter().sum::<f64>() - 1e-6,
        "{json}"
    );
    for (speed, count) in [("paths_per_second", "paths"), ("rays_per_second", "rays")] {
        assert!(
            (number(speed) * number("trace_seconds") / number(count) - 1.0).abs() < 1e-9,
            "{speed}: {json}"
        );
    }
    assert!(number("rays") > number("paths") && number("paths") == 32.0 * 18.0 * 16.0, "{json}");
    let history = json["history"].as_array().unwrap();
    assert_eq!(history.last().unwrap()["samples_per_pixel"], 16);

    let output = render(directory.path(), &["--samples", "1", "--estimate-error", "off", "--json", "-"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["rmse_estimate"].is_null());
    assert!(text(&output.stderr).contains("three-spheres"), "the summary makes way for the JSON");
}

#[cfg(target_os = "linux")]
#[test]
fn any_name_is_told_on_one_line_and_in_json() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let directory = temp();
    let with = |out: &[u8], more: &[&str]| {
        let common = ["--batch", "--size", "8x4", "--samples", "1", "--json", "j.json"];
        let mut command = super::common::weekender(directory.path(), &[&common[..], more].concat());
        let output = command.arg("--out").arg(OsStr::from_bytes(out)).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json = std::fs::read(directory.path().join("j.json")).unwrap();
        (text(&output.stdout), serde_json::from_slice::<Value>(&json).unwrap())
    };
    let (told, json) = with(b"q\xff.png", &[]);
    assert!(told.contains("files    q\u{fffd}.png\n"), "{told}");
    assert_eq!(json["files"][0], "q\u{fffd}.png");
    let (told, json) = with(b"a\nb\x1b[31m.png", &[]);
    assert!(told.contains("files    a\\nb\\u{1b}[31m.png\n"), "{told}");
    assert_eq!(json["files"][0], "a\nb\u{1b}[31m.png");
    let (told, json) = with(b"d\xff\n", &["--turntable=2"]);
    assert!(told.contains("d\u{fffd}\\n/"), "{told}");
    assert_eq!(json["directory"], "d\u{fffd}\n");
    // Errors, and the names of scenes.
    refused(&["--batch", "--out", "no\nwhere/x.png"], &["no\\nwhere/x.png"]);
    render(directory.path(), &["--samples", "1", "--save-scene", "s\nt.toml"]);
    let output = render(directory.path(), &["--samples", "1", "--scene", "s\nt.toml"]);
    assert!(text(&output.stdout).starts_with("scene    s\\nt, "), "{}", text(&output.stdout));
    let mut command = super::common::weekender(directory.path(), &["--batch", "--scene"]);
    let output = command.arg(OsStr::from_bytes(b"s\xff.toml")).output().unwrap();
    let told = text(&output.stderr);
    assert!(output.status.code() == Some(2) && told.contains("\"s\\xFF.toml\""), "{told}");
}

#[test]
fn every_stage_renders_into_the_directory() {
    let directory = temp();
    let output =
        render(directory.path(), &["--stage", "all", "--samples", "1", "--out", "gallery", "--json", "-"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let stages = weekender::stages::Stage::ALL;
    assert_eq!(json["stages"].as_array().unwrap().len(), stages.len());
    assert_eq!(names(&directory.path().join("gallery")).len(), stages.len());
}

#[test]
fn the_list_names_scenes_stages_and_devices() {
    let output = run(temp().path(), &["--list"]);
    assert!(output.status.success());
    let list = text(&output.stdout);
    for part in ["three-spheres", "book", "glass-schlick", "11.4", "portable", "reference", "(auto)"] {
        assert!(list.contains(part), "{list}");
    }
    // What is said of each name begins in the same column.
    let (_, stages) = list.split_once("Stages (--stage)").unwrap();
    let column = |stage: &weekender::stages::Stage| {
        let line = stages.lines().find(|line| line.split_whitespace().next() == Some(stage.id));
        line.and_then(|line| line.find(stage.title))
    };
    let columns: Vec<_> = weekender::stages::Stage::ALL.iter().map(column).collect();
    assert!(columns.iter().all(|column| column.is_some() && *column == columns[0]), "{columns:?}: {list}");
}

#[test]
fn help_tells_units_and_ranges() {
    let output = run(temp().path(), &["--help"]);
    assert!(output.status.success());
    let help = text(&output.stdout);
    for part in ["degrees", "16384", "--sample-range", "merge", "Seconds of rendering"] {
        assert!(help.contains(part), "{help}");
    }
}

#[test]
fn progress_can_be_asked_for_where_there_is_no_terminal() {
    let output = render(temp().path(), &["--samples", "2", "--progress", "on"]);
    assert!(text(&output.stderr).contains("writing"), "{}", text(&output.stderr));
}
