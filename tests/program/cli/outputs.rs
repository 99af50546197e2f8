//! Outputs: what is written where, and which ones are refused.

use super::common::{ends, film, json_file, names, refused, refused_in, render, succeeds, temp};
use crate::common::program::{outcome, weekender};
use serde_json::Value;

#[test]
fn the_default_picture_is_named_after_its_scene() {
    let directory = temp();
    let small = ["--batch", "--size", "32x18", "--samples", "2", "--device", "cpu"];
    let (summary, message) = ends(directory.path(), 0, &small);
    assert_eq!(names(directory.path()), ["three-spheres.png"]);
    for part in ["three-spheres, 32x18", "2 per pixel", "three-spheres.png"] {
        assert!(summary.contains(part), "{summary}");
    }
    assert_eq!(message, "", "quiet when redirected");
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_rendering() {
    let endless = ["--batch", "--samples", "4294967296", "--size", "1600x900"];
    for (more, parts) in [
        (["--out", "x.jpg"], &["x.jpg", ".png", ".ppm", ".exr"][..]),
        (["--out", "x"], &["x", ".png"]),
        (["--out", "nowhere/x.png"], &["nowhere/x.png"]),
        (["--checkpoint", "nowhere/x.exr"], &["nowhere/x.exr"]),
        (["--checkpoint", "x.png"], &["--checkpoint", "x.png", ".exr"]),
        (["--json", "nowhere/x.json"], &["nowhere/x.json"]),
        (["--save-scene", "nowhere/x.toml"], &["nowhere/x.toml"]),
        (["--every", "5m"], &["--checkpoint"]),
    ] {
        refused(&[&endless[..], &more].concat(), parts);
    }
    refused(&["--out", "x.png"], &["--batch"]);
}

#[test]
fn list_names_scenes_stages_and_devices() {
    let list = succeeds(temp().path(), &["--list"]);
    for part in ["three-spheres", "book", "glass-schlick", "11.4", "portable", "reference", "(auto)"] {
        assert!(list.contains(part), "{list}");
    }
}

#[test]
fn outputs_never_replace_inputs_or_each_other() {
    let directory = temp();
    let path = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "2", "--checkpoint", "g.exr"]);
    succeeds(directory.path(), &["--save-scene", "s.toml"]);
    let before = std::fs::read(path("g.exr")).unwrap();
    let endless = ["--batch", "--samples", "4294967296", "--size", "32x18"];
    let refused =
        |more: &[&str], parts: &[&str]| refused_in(&directory, &[&endless[..], more].concat(), parts);
    refused(&["--out", "x.exr", "--checkpoint", "./x.exr"], &["x.exr", "its own name"]);
    refused(&["--resume", "g.exr", "--json", "./g.exr"], &["g.exr"]);
    refused(&["--scene", "s.toml", "--save-scene", "./s.toml"], &["s.toml"]);
    std::fs::write(path("t.csv"), "x,y,z,radius,red,green,blue\n").unwrap();
    let camera = "[camera]\nlook_from = [0, 0, 3]\nlook_at = [0, 0, 0]\nvfov_degrees = 40\n";
    std::fs::write(path("t.toml"), format!("spheres = \"t.csv\"\n{camera}")).unwrap();
    refused(&["--scene", "t.toml", "--json", "./t.csv"], &["t.csv would replace"]);
    let frames = ["--turntable=3", "--out", "fr", "--json", "fr/frame-0001.png"];
    std::fs::create_dir(path("fr")).unwrap();
    refused(&frames, &["fr/frame-0001.png"]);
    refused_in(&directory, &["merge", "g.exr", "--out", "./g.exr"], &["./g.exr would replace"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("g.exr", path("link.exr")).unwrap();
        refused(&["--resume", "link.exr", "--json", "g.exr"], &["g.exr"]);
    }
    assert_eq!(std::fs::read(path("g.exr")).unwrap(), before);
    // A film may be replaced by its own continuation.
    let resumed =
        ["--resume", "g.exr", "--checkpoint", "./g.exr", "--samples", "4", "--batch", "--out", "y.png"];
    succeeds(directory.path(), &resumed);
    assert_eq!(film(&path("g.exr")).sample_count(), 4);
}

#[test]
fn a_render_writes_all_its_outputs() {
    let directory = temp();
    let out = ["a.png", "b.exr", "c.ppm", "d.exr"].map(|name| ["--out", name]).concat();
    render(directory.path(), &[&["--samples", "2", "--denoise"][..], &out].concat());
    let [film, other] = ["b.exr", "d.exr"].map(|name| film(&directory.path().join(name)));
    assert!(film.sample_count() == 2 && film == other);
    for name in ["a.png", "c.ppm"] {
        assert!(directory.path().join(name).is_file(), "{name}");
    }
    refused_in(&directory, &["--batch", "--out", "a.png", "--out", "./a.png"], &["a.png", "its own name"]);
    refused_in(&directory, &["--batch", "--out", "-", "--format", "png", "--out", "-"], &["standard output"]);
    refused_in(&directory, &["--batch", "--turntable", "--out", "a", "--out", "b"], &["one --out"]);
}

#[test]
fn json_has_the_figures() {
    let directory = temp();
    render(directory.path(), &["--samples", "16", "--seed", "7", "--json", "figures.json"]);
    let json = json_file(&directory.path().join("figures.json"));
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

    let flags = ["--batch", "--size", "8x8", "--samples", "1", "--json", "-"];
    let (out, summary) = ends(directory.path(), 0, &flags);
    assert!(serde_json::from_str::<Value>(&out).unwrap()["rmse_estimate"].is_null());
    assert!(summary.contains("three-spheres"), "the summary makes way for the JSON");
}

/// Its loader takes time, and some of its libraries print messages of their own.
#[test]
fn only_commands_that_may_need_a_gpu_look_for_one() {
    let directory = temp();
    let picture = ["--batch", "--device", "cpu", "--size", "16x9", "--samples", "1", "--out", "a.png"];
    for arguments in [&picture[..], &["info", "a.png"], &["compare", "a.png", "a.png"]] {
        succeeds(directory.path(), &[arguments, &["--log", "run.log"]].concat());
        let log = std::fs::read_to_string(directory.path().join("run.log")).unwrap();
        assert!(!log.contains("found "), "{arguments:?}: {log}");
    }
}

/// As on a server: graphics libraries then print errors that look like the program's.
#[test]
fn libraries_print_nothing() {
    let directory = temp();
    for arguments in [&["--list"][..], &["--batch", "--size", "16x9", "--samples", "1", "--out", "a.png"]] {
        let mut command = weekender(directory.path(), arguments);
        command.env_remove("XDG_RUNTIME_DIR");
        let (code, _, message) = outcome(&command.output().unwrap());
        assert_eq!((code, message.as_str()), (Some(0), ""), "{arguments:?}");
    }
}
