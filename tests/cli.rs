//! The program from outside: what it writes, says and returns.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(120);

fn weekender(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    // Whatever should have been refused opens no window.
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.current_dir(directory).args(arguments).stdin(Stdio::null());
    command
}

fn run(directory: &Path, arguments: &[&str]) -> Output {
    weekender(directory, arguments).output().unwrap()
}

/// Runs a small batch render that must succeed.
fn render(directory: &Path, arguments: &[&str]) -> Output {
    let output = run(directory, &[&["--batch", "--size", "32x18", "--threads", "2"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn temp() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn film(path: PathBuf) -> weekender::film::Film {
    weekender::film::checkpoint::load(&path).unwrap().film
}

/// Bad input: exit code 2, a message with all of `parts`, and no new file.
fn refused(arguments: &[&str], parts: &[&str]) {
    refused_in(&temp(), arguments, parts);
}

fn refused_in(directory: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = names(directory.path());
    let output = run(directory.path(), arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
    }
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert_eq!(names(directory.path()), before, "{arguments:?} left something behind");
}

#[test]
fn the_default_picture_is_named_after_its_scene() {
    let directory = temp();
    let output = render(directory.path(), &["--samples", "2"]);
    assert_eq!(names(directory.path()), ["three-spheres.png"]);
    let summary = text(&output.stdout);
    for part in ["three-spheres, 32x18", "2 per pixel", "number of samples", "three-spheres.png", "threads"] {
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
fn without_batch_it_names_the_flag() {
    refused(&[], &["--batch"]);
}

#[test]
fn values_out_of_range_are_refused_with_value_and_limit() {
    let cases: [(&[&str], &[&str]); 28] = [
        (&["--size", "0x10"], &["0x10", "16384"]),
        (&["--size", "100000x100000"], &["100000x100000", "16384"]),
        (&["--size", "800"], &["800", "WIDTHxHEIGHT"]),
        (&["--samples", "0"], &["0", "4294967296"]),
        (&["--samples", "-3"], &["-3"]),
        (&["--samples", "many"], &["many"]),
        (&["--depth", "0"], &["0", "10000"]),
        (&["--depth", "10001"], &["10001", "10000"]),
        (&["--vfov", "0"], &["vfov", "0.01", "179"]),
        (&["--vfov", "180"], &["180", "179"]),
        (&["--vfov", "nan"], &["NaN", "finite"]),
        (&["--vfov", "wide"], &["wide", "number"]),
        (&["--defocus-angle", "180"], &["180", "179"]),
        (&["--defocus-angle", "-1"], &["-1", "179"]),
        (&["--focus-distance", "0"], &["focus_distance is 0"]),
        (&["--focus-distance", "inf"], &["inf", "finite"]),
        (&["--look-from", "1,2,3", "--look-at", "1,2,3"], &["[1, 2, 3]", "direction"]),
        (&["--look-from", "1,2"], &["1,2", "three numbers"]),
        (&["--look-from", "nan,0,0"], &["look_from.x is NaN"]),
        (&["--time-limit", "0"], &["0", "seconds"]),
        (&["--time-limit", "inf"], &["inf", "1e9"]),
        (&["--noise-target", "-0.1"], &["-0.1", "above 0"]),
        (&["--noise-target", "0.1", "--estimate-error", "off"], &["--noise-target", "--estimate-error on"]),
        (&["--sample-range", "8..8"], &["8..8", "A below B"]),
        (&["--sample-range", "0..8", "--samples", "9"], &["--sample-range", "--samples"]),
        (&["--threads", "0"], &["0", "1024"]),
        (&["--threads", "100000"], &["100000", "1024"]),
        (&["--seed", "-1"], &["-1", "4294967295"]),
    ];
    for (arguments, parts) in cases {
        refused(&[&["--batch"], arguments].concat(), parts);
    }
}

#[test]
fn names_that_do_not_exist_are_refused() {
    refused(&["--batch", "--scene", "three-spheeres"], &["three-spheeres", "three-spheres"]);
    refused(&["--batch", "--scene", "field:0"], &["0"]);
    refused(&["--batch", "--stage", "glass-schlik"], &["glass-schlik", "glass-schlick"]);
    refused(&["--batch", "--scene", "book", "--stage", "book"], &["--scene", "--stage"]);
    refused(&["--batch", "--device", "tpu"], &["tpu", "cpu"]);
    refused(&["--batch", "--adapter", "no-such-adapter"], &["adapter"]);
    refused(&["--batch", "--device", "cpu", "--adapter", "any"], &["--adapter", "--device cpu"]);
    refused(&["--batch", "--simd", "3"], &["3", "16"]);
    refused(&["--batch", "--isa", "mmx"], &["mmx", "avx2"]);
    refused(&["--batch", "--device", "reference", "--simd", "8"], &["--simd", "reference"]);
    refused(&["--batch", "--no-such-flag"], &["--no-such-flag"]);
}

#[test]
fn what_the_processor_lacks_is_refused_with_what_it_has() {
    let foreign = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    refused(&["--batch", "--isa", foreign], &[foreign, "portable"]);
    refused(&["--batch", "--isa", "portable", "--simd", "16"], &["16 lanes", "portable"]);
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
    // Outputs over outputs.
    refused(&["--out", "x.exr", "--checkpoint", "./x.exr"], &["--out", "--checkpoint", "x.exr"]);
    refused(&["--out", "x.png", "--json", "../x.png/../x.png"], &["x.png"]);
    refused(&["--checkpoint", "x.exr", "--save-scene", "x.exr"], &["--checkpoint", "--save-scene"]);
    // Outputs over inputs.
    refused(&["--resume", "g.exr", "--json", "g.exr"], &["--json", "--resume", "g.exr"]);
    refused(&["--resume", "g.exr", "--save-scene", "./g.exr"], &["--save-scene", "--resume"]);
    refused(&["--scene", "s.toml", "--json", "s.toml"], &["--json", "--scene"]);
    refused(&["--scene", "s.toml", "--save-scene", "./s.toml"], &["--save-scene", "--scene"]);
    refused_in(&directory, &["--scene", "s.toml", "--save-scene", "s.toml"], &["--save-scene"]);
    refused_in(&directory, &["merge", "g.exr", "--out", "./g.exr"], &["--out", "the film"]);
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
    // What lives on in the output may be replaced.
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
        refused_in(&directory, &dangling, &["to-nowhere.png", "it is a link to gone/target.png"]);
        symlink("circle.png", directory.path().join("circle.png")).unwrap();
        refused_in(&directory, &[&endless[..], &["--out", "circle.png"]].concat(), &["circle.png"]);
        // One whose target can be made is followed.
        symlink("target.png", directory.path().join("link.png")).unwrap();
        render(directory.path(), &["--samples", "1", "--out", "link.png"]);
        assert!(directory.path().join("link.png").is_symlink());
        assert!(std::fs::read(directory.path().join("target.png")).unwrap().starts_with(b"\x89PNG"));
    }
}

#[test]
fn nothing_from_outside_steers_or_floods_a_terminal() {
    let directory = temp();
    let steers = |bytes: &[u8]| text(bytes).chars().any(|c| c.is_control() && c != '\n');
    let scene = "[camera]\nlook_from = [0.0, 0.0, 3.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n\
                 [materials.\"a\\u001b[2Jb\\u009bc\"]\nkind = \"lambertian\"\nalbedo = [0.5, 0.5, 0.5]\n\
                 [[spheres]]\ncenter = [0.0, 0.0, 0.0]\nradius = 1.0\nmaterial = \"a\\u001b[2Jb\\u009bc\"\n";
    std::fs::write(directory.path().join("s.toml"), scene).unwrap();
    for more in [&[][..], &["--json", "-"]] {
        let path =
            ["diff", "--scene", "s.toml", "--size", "9x9", "--pixel", "4,4", "--sides", "cpu,reference"];
        let output = run(directory.path(), &[&path[..], more].concat());
        assert!(!steers(&output.stdout) && !steers(&output.stderr), "{output:?}");
        let told = text(&output.stdout) + &text(&output.stderr);
        assert!(told.contains("a\\u{1b}[2Jb\\u{9b}c"), "{told}");
    }
    let long = "x".repeat(100_000);
    for arguments in [
        &["--batch", "--scene", "a\x1b[31mb"][..],
        &["--batch", "--out", "a\x1b]0;title\x07.png/"],
        &["--batch", "--stage", &long],
        &["--batch", "--scene", &long],
        &["--batch", "--size", &long],
        &["--batch", "--out", &long],
        &[&long],
    ] {
        let output = run(directory.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(!steers(&output.stderr) && output.stdout.is_empty(), "{output:?}");
        assert!(output.stderr.len() < 10_000, "{} bytes", output.stderr.len());
        assert!(text(&output.stderr).starts_with("error"), "{output:?}");
    }
}

#[test]
fn how_often_a_film_is_kept_is_a_time() {
    refused(&["--batch", "--checkpoint", "x.exr", "--every", "5 weeks"], &["5 weeks", "30d", "--every"]);
    refused(&["--batch", "--checkpoint", "x.exr", "--every", "-1s"], &["-1s", "0.1s"]);
    refused(&["--batch", "--every", "5m"], &["--every", "--checkpoint"]);
}

#[test]
fn scene_files_are_refused_with_their_reason() {
    let directory = temp();
    let write = |content: &str| std::fs::write(directory.path().join("s.toml"), content).unwrap();
    let camera = "[camera]\nlook_from = [0.0, 0.0, 1.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 90.0\n";
    let sphere = |radius: &str, material: &str| {
        format!("{camera}[[spheres]]\ncenter = [0.0, 0.0, 0.0]\nradius = {radius}\nmaterial = {material}\n")
    };
    let grey = "{ kind = \"lambertian\", albedo = [0.5, 0.5, 0.5] }";
    let cases: [(String, &[&str]); 11] = [
        ("camera = ".to_owned(), &["s.toml"]),
        (format!("{camera}zoom = 3\n"), &["zoom", "5"]),
        (sphere("0.0", grey), &["radius", "0"]),
        (sphere("-1.0", grey), &["radius", "-1"]),
        (sphere("nan", grey), &["radius", "NaN"]),
        (sphere("inf", grey), &["radius", "inf"]),
        (sphere("1.0", "\"nothing\""), &["nothing"]),
        (sphere("1.0", "{ kind = \"metal\", albedo = [1.0, 1.0, 1.0], fuzz = -1.0 }"), &["fuzz", "-1"]),
        (sphere("1.0", "{ kind = \"lambertian\", albedo = [2.0, 0.0, 0.0] }"), &["albedo", "2"]),
        (camera.replace("90.0", "180.0"), &["vfov", "180", "179"]),
        (camera.replace("1.0]", "0.0]"), &["look_from", "look_at"]),
    ];
    for (content, parts) in cases {
        write(&content);
        refused_in(&directory, &["--batch", "--scene", "s.toml"], parts);
    }
    std::fs::write(directory.path().join("s.toml"), [0xff, 0xfe, 0]).unwrap();
    refused_in(&directory, &["--batch", "--scene", "s.toml"], &["s.toml"]);
    refused_in(&directory, &["--batch", "--scene", "missing.toml"], &["missing.toml"]);
    refused_in(&directory, &["--batch", "--scene", "."], &["."]);
}

#[test]
fn a_saved_scene_renders_the_same_film() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    for from in [["--scene", "book"], ["--stage", "gamut"], ["--stage", "shadow-acne"]] {
        let saved =
            run(directory.path(), &[&from[..], &["--save-scene", "s.toml", "--size", "32x18"]].concat());
        assert!(saved.status.success(), "{}", text(&saved.stderr));
        render(directory.path(), &[&from[..], &["--samples", "4", "--checkpoint", "a.exr"]].concat());
        render(directory.path(), &["--scene", "s.toml", "--samples", "4", "--checkpoint", "b.exr"]);
        assert_eq!(film(at("a.exr")), film(at("b.exr")), "{from:?}");
    }
}

#[test]
fn a_resumed_film_equals_an_uninterrupted_one() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "37", "--checkpoint", "whole.exr"]);
    render(directory.path(), &["--samples", "10", "--checkpoint", "part.exr"]);
    // The film knows its scene and size: nothing of that need be said again.
    let output = run(
        directory.path(),
        &["--batch", "--resume", "part.exr", "--samples", "37", "--checkpoint", "part.exr", "--json", "-"],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(film(at("part.exr")), film(at("whole.exr")));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["scene"], "three-spheres");
    assert_eq!(json["samples_per_pixel"], 37);
    assert_eq!(json["added_samples_per_pixel"], 27);
}

#[test]
fn seconds_add_up_over_runs() {
    use weekender::film::{checkpoint, key};
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    let seconds = |name: &str| -> Option<f64> {
        let description = checkpoint::load(&at(name)).unwrap().description;
        description.get(key::SECONDS).map(|seconds| seconds.parse().unwrap())
    };
    render(directory.path(), &["--samples", "4", "--out", "film.exr"]);
    let first = seconds("film.exr").unwrap();
    assert!(first > 0.0 && first < 500.0, "{first}");
    // An earlier run that took long.
    let mut kept = checkpoint::load(&at("film.exr")).unwrap();
    kept.description.set(key::SECONDS, 1000.0);
    checkpoint::save(&at("film.exr"), &kept.film, &kept.description).unwrap();
    let resume = ["--resume", "film.exr", "--samples", "64"];
    render(
        directory.path(),
        &[&resume[..], &["--checkpoint", "more.exr", "--out", "more.png", "--json", "more.json"]].concat(),
    );
    let both = seconds("more.exr").unwrap();
    let json: Value = serde_json::from_slice(&std::fs::read(at("more.json")).unwrap()).unwrap();
    let of_run = json["trace_seconds"].as_f64().unwrap();
    assert!(of_run > 1e-5 && (both - 1000.0 - of_run).abs() < 1e-6, "{both} of 1000 and {of_run}");
    // Where the first run does not say what it took, nobody knows the sum.
    let mut silent = weekender::film::Description::new(kept.description.recipe());
    silent.set(key::SAMPLES, 4);
    checkpoint::save(&at("film.exr"), &kept.film, &silent).unwrap();
    render(directory.path(), &[&resume[..], &["--out", "unknown.exr"]].concat());
    assert_eq!(seconds("unknown.exr"), None);
}

#[test]
fn films_of_other_pictures_are_not_resumed() {
    let directory = temp();
    render(directory.path(), &["--samples", "2", "--checkpoint", "film.exr"]);
    std::fs::write(directory.path().join("broken.exr"), "not a film").unwrap();
    // The window refuses them as a batch render does.
    for way in [&["--batch"][..], &[]] {
        let with = |film: &'static str, more: &[&'static str]| [way, &["--resume", film], more].concat();
        for (flags, parts) in [
            (&["--size", "16x9"][..], &["16x9", "32x18"][..]),
            (&["--seed", "5"], &["seed is 5"]),
            (&["--depth", "3"], &["depth is 3"]),
            (&["--vfov", "30"], &["camera"]),
            (&["--sampler", "independent"], &["independent", "sobol"]),
            (&["--estimate-error", "off"], &["estimate-error is off"]),
            (&["--scene", "book", "--size", "32x18"], &["another picture"]),
            (&["--stage", "metal", "--size", "32x18"], &["another picture"]),
        ] {
            refused_in(&directory, &with("film.exr", flags), parts);
        }
        refused_in(&directory, &with("broken.exr", &[]), &["broken.exr"]);
        refused_in(&directory, &with("missing.exr", &[]), &["missing.exr"]);
        refused_in(&directory, &with("film.png", &[]), &["--resume", ".exr"]);
    }
}

#[test]
fn parts_add_up_to_the_whole() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "24", "--out", "whole.exr"]);
    for (range, name) in [("0..8", "a.exr"), ("8..13", "b.exr"), ("13..24", "c.exr")] {
        render(directory.path(), &["--sample-range", range, "--out", name]);
    }
    let merge = run(directory.path(), &["merge", "c.exr", "a.exr", "b.exr", "--out", "all.exr"]);
    assert!(merge.status.success(), "{}", text(&merge.stderr));
    assert!(text(&merge.stdout).contains("0..24"), "{}", text(&merge.stdout));
    assert_eq!(film(at("all.exr")), film(at("whole.exr")));

    refused_in(
        &directory,
        &["merge", "a.exr", "whole.exr", "--out", "x.exr"],
        &["a.exr", "whole.exr", "0..8"],
    );
    render(directory.path(), &["--sample-range", "24..32", "--seed", "9", "--out", "other.exr"]);
    refused_in(&directory, &["merge", "a.exr", "other.exr", "--out", "x.exr"], &["other.exr", "seed is 0"]);
    refused_in(&directory, &["merge", "a.exr", "b.exr", "--out", "x.gif"], &["x.gif", ".exr"]);
    refused_in(&directory, &["merge", "--out", "x.exr"], &["FILM"]);
    refused_in(&directory, &["merge", "a.exr", "none.exr", "--out", "x.exr"], &["none.exr"]);
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
    assert!(text(&output.stderr).contains("write"), "{}", text(&output.stderr));
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
    // Its first words come after it has begun to listen.
    let mut stderr = std::io::BufReader::new(child.stderr.take().unwrap());
    std::io::BufRead::read_line(&mut stderr, &mut String::new()).unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let killed = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());

    let begin = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("Ctrl-C did not end it");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(status.code(), Some(130));
    assert_eq!(names(directory.path()), ["film.exr", "three-spheres.png"]);
    let samples = film(directory.path().join("film.exr")).sample_count();
    assert!(samples > 0);

    // What was kept goes on.
    let more = (samples + 2).to_string();
    let resumed =
        run(directory.path(), &["--batch", "--resume", "film.exr", "--samples", &more, "--out", "more.exr"]);
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert_eq!(film(directory.path().join("more.exr")).sample_count(), samples + 2);
}
