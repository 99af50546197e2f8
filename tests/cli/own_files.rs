//! Files to which commands give names of their own: no flag may replace one, and none may replace what a flag reads.

use super::common::{refused_in, run, temp, text};
use std::fs;
use std::path::Path;

const SMALL: [&str; 4] = ["--size", "8x4", "--samples", "4"];

fn succeeds(at: &Path, arguments: &[&str]) {
    let output = run(at, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
}

#[test]
fn no_output_replaces_a_file_of_its_command_s_own() {
    let directory = temp();
    let at = directory.path();
    let plan = |more: &[&str]| succeeds(at, &[&["plan", "--parts", "2"], &SMALL[..], more].concat());
    plan(&["--out", "q", "--format", "slurm"]);
    plan(&["--out", "a", "--turntable=4"]);
    succeeds(at, &["--save-scene", "s.toml"]);
    for name in
        ["plan.json", "scene.toml", "part-0.exr", "part-1.exr", "picture.exr", "submit.sh", "./part-0.exr"]
    {
        let json = format!("q/{name}");
        let told = format!("--json {json} would replace a file of the plan;");
        for plan in ["q", "q/plan.json", "./a/../q"] {
            refused_in(&directory, &["render-part", plan, "--part", "0", "--json", &json], &[&told]);
        }
    }
    for name in ["plan.json", "scene.toml", "frame-0000.png", "frame-0003.png", "animation.png"] {
        let told = "would replace a file of the plan;";
        refused_in(&directory, &["render-part", "a", "--part", "0", "--json", &format!("a/{name}")], &[told]);
    }
    let batch = |more: &[&str], parts: &[&str]| {
        refused_in(&directory, &[&["--batch", "--turntable=3"], &SMALL[..], more].concat(), parts);
    };
    let told = ["would replace a frame of the animation;"];
    batch(&["--out", "fr", "--json", "fr/frame-0001.png"], &told);
    batch(&["--out", "t.png", "--json", "t-frames/frame-0000.png"], &told);
    batch(&["--out", "n-#.png", "--json", "n-2.png"], &told);
    for (plan, name, more) in [
        ("q", "part-0.exr", &[][..]),
        ("q/plan.json", "part-1.exr", &["--watch"]),
        ("a", "frame-0001.png", &[]),
        ("a", "frame-0001.png", &["--watch"]),
    ] {
        let out = Path::new(plan.split('/').next().unwrap()).join(name);
        let words = [&["merge", plan, "--out", out.to_str().unwrap()], more].concat();
        refused_in(&directory, &words, &["--out", name, "would replace a file of the plan;"]);
    }
    fs::create_dir(at.join("st")).unwrap();
    let words = ["stress", "--filter", "scaled/1e-3", "--out", "st", "--json", "st/scaled-1e-3-ours.png"];
    refused_in(&directory, &words, &["would replace a file of --out,"]);
    // What is no file of the plan may have any name, and the result has its own.
    succeeds(at, &["render-part", "q", "--part", "0", "--json", "q/part-2.exr", "--device", "cpu"]);
    succeeds(at, &["render-part", "q", "--part", "1", "--json", "q/figures.json", "--device", "cpu"]);
    succeeds(at, &["merge", "q", "--out", "q/picture.exr", "--out", "q/picture.png"]);
}

#[test]
fn no_file_of_a_command_s_own_replaces_an_input() {
    let directory = temp();
    let at = directory.path();
    succeeds(at, &["--save-scene", "s.toml"]);
    for folder in ["p", "fr", "c", "c/figures"] {
        fs::create_dir(at.join(folder)).unwrap();
    }
    for copy in ["p/scene.toml", "p/plan.json", "fr/frame-0001.png", "c/figures/a.png"] {
        fs::copy(at.join("s.toml"), at.join(copy)).unwrap();
    }
    let scene = fs::read(at.join("s.toml")).unwrap();
    let plan = ["plan", "--size", "8x4", "--samples", "4", "--parts", "2", "--out", "p", "--scene"];
    let frames = ["--batch", "--size", "8x4", "--samples", "4", "--turntable=3", "--out", "fr", "--scene"];
    for (words, told) in [
        ([&plan[..], &["p/scene.toml"]].concat(), "would replace the file that --scene reads"),
        ([&plan[..], &["./p/../p/plan.json"]].concat(), "would replace the file that --scene reads"),
        ([&frames[..], &["fr/frame-0001.png"]].concat(), "would replace the file that --scene reads"),
        (
            vec!["companion", "--out", "c", "--bench", "c/figures/a.png"],
            "would replace the file that --bench reads",
        ),
    ] {
        refused_in(&directory, &words, &[told]);
    }
    for copy in ["p/scene.toml", "p/plan.json", "fr/frame-0001.png", "c/figures/a.png"] {
        assert_eq!(fs::read(at.join(copy)).unwrap(), scene, "{copy}");
    }
}

#[test]
fn a_log_replaces_no_other_file_of_its_command() {
    let directory = temp();
    let at = directory.path();
    succeeds(at, &["--save-scene", "s.toml"]);
    fs::rename(at.join("s.toml"), at.join("s.log")).unwrap();
    let scene = fs::read(at.join("s.log")).unwrap();
    let told = ["--log", "s.log would replace another file of this command"];
    refused_in(&directory, &["--batch", "--scene", "s.log", "--log", "./s.log"], &told);
    refused_in(&directory, &["info", "s.log", "--log", "s.log"], &told);
    refused_in(&directory, &["diff", "--pixel", "1,1", "--json=s.log", "--log", "s.log"], &told);
    assert_eq!(fs::read(at.join("s.log")).unwrap(), scene);
}
