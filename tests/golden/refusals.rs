//! What is refused, with which exit code and which words.

use crate::common::{at_once, check, told};
use crate::program_common::names;
use std::fmt::Write as _;
use weekender::recipe::file::parse;

/// Files that the command lines name.
const MAKE: &[&str] = &[
    "--save-scene s.toml --scene metals --size 8x4 --samples 2",
    "--batch --size 8x4 --samples 4 --device reference --out p.png --checkpoint f.exr",
    "--batch --size 8x4 --samples 4 --device reference --estimate-error off --out h.exr",
    "--batch --size 4x8 --samples 4 --device reference --out u.exr",
    "plan --size 8x4 --samples 4 --parts 2 --out p",
];

const LINES: &[&str] = &[
    "",
    "--batch --size 0x3",
    "--batch --size 3",
    "--batch --size 16385x3",
    "--batch --depth 0",
    "--batch --depth 10001",
    "--batch --samples 0",
    "--batch --samples 4294967297",
    "--batch --seed 4294967296",
    "--batch --seed -1",
    "--batch --sampler halton",
    "--batch --threads 0",
    "--batch --threads 1025",
    "--batch --simd 3",
    "--batch --simd 16 --isa portable",
    "--batch --isa mmx",
    "--batch --device tpu",
    "--batch --device cpu --adapter x",
    "--batch --device reference --simd 4",
    "--batch --device reference --simulate-hang 1",
    "--batch --vfov 0",
    "--batch --vfov 179.5",
    "--batch --vfov x",
    "--batch --vup 0,0,0",
    "--batch --vup 0,0,1 --look-from 0,0,1 --look-at 0,0,0",
    "--batch --look-from 1,2",
    "--batch --look-from 1e19,0,0",
    "--batch --look-from 0,0,0 --look-at 0,0,0",
    "--batch --defocus-angle 179",
    "--batch --defocus-angle -1",
    "--batch --focus-distance 0",
    "--batch --focus-distance nan",
    "--batch --time-limit 0",
    "--batch --time-limit x",
    "--batch --noise-target 0",
    "--batch --noise-target -1",
    "--batch --noise-target .1 --estimate-error off",
    "--batch --sample-range 4..4",
    "--batch --sample-range 5..4",
    "--batch --sample-range 0..4294967297",
    "--batch --sample-range 1..2 --samples 3",
    "--batch --every 0",
    "--batch --every 31d --checkpoint c.exr",
    "--batch --every 5x --checkpoint c.exr",
    "--batch --every 5s",
    "--batch --scene nosuch",
    "--batch --scene three-sphere",
    "--batch --scene nosuch.toml",
    "--batch --scene field:0",
    "--batch --scene field:x",
    "--batch --scene metals --stage metal",
    "--batch --stage metl",
    "--batch --stage all",
    "--batch --stage all --out d --checkpoint c.exr",
    "--batch --stage all --out d --resume f.exr",
    "--batch --out p.jpg",
    "--batch --out p",
    "--batch --out no/p.png",
    "--batch --out p.png --ppm ascii",
    "--batch --checkpoint c.png",
    "--batch --continue",
    "--batch --checkpoint f.exr --resume f.exr --continue",
    "--batch --resume nosuch.exr",
    "--batch --resume p.png",
    "--batch --resume f.exr --seed 3",
    "--batch --resume f.exr --size 9x4",
    "--batch --resume f.exr --depth 3",
    "--batch --resume f.exr --scene metals",
    "--batch --resume f.exr --estimate-error off",
    "--batch --resume f.exr --samples 4 --out q.png --json f.exr",
    "--batch --json j.txt --out f.exr --checkpoint f.exr",
    "--batch --frames 0..3 --turntable",
    "--batch --frames 0..3 --out d",
    "--batch --frames 3..3 --turntable --out d",
    "--batch --turntable=0deg --frames 0..3 --out d",
    "--batch --turntable 1 --out d",
    "--batch --turntable --fps 0 --out a.png",
    "--batch --turntable --fps 24 --out d",
    "--batch --turntable --out a.exr",
    "--batch --turntable --out a-#-#.png",
    "--batch --fresh",
    "--batch --draw-with gl",
    "--log x.txt --list",
    "--verbose",
    "--nosuch",
    "nosuch",
    "bench --runs 0",
    "bench --runs 1001",
    "bench --scale 5..1",
    "bench --scale 10..20 --scene book",
    "bench --features --scale 10..20",
    "bench --plot c.jpg",
    "bench --run-limit 0",
    "plan --out q",
    "plan --out q --parts 0",
    "plan --out q --parts 5 --samples 4",
    "plan --out q --parts 2 --stage all",
    "plan --out p --parts 2 --samples 8 --size 8x4",
    "plan --out q --parts 9 --frames 0..5 --turntable",
    "plan --out q --parts 2 --turntable=5deg",
    "render-part p/plan.json --part 2",
    "render-part p/plan.json",
    "render-part s.toml --part 0",
    "render-part no/plan.json --part 0",
    "merge f.exr",
    "merge f.exr f.exr",
    "merge f.exr h.exr --out m.exr",
    "merge f.exr u.exr --out m.exr",
    "merge f.exr p.png --out m.exr",
    "merge f.exr nosuch.exr --out m.exr",
    "merge f.exr h.exr --out m.jpg",
    "merge p/plan.json --every 5s",
    "merge p/plan.json --check --watch",
    "merge p/plan.json --out m.txt",
    "info nosuch",
    "info .",
    "info s.txt",
    "diff --sides portable",
    "diff --sides portable,reference",
    "diff --sides portable,nosuch --pixel 1,1",
    "diff --sides portable,reference --pixel 99999,1",
    "diff --sides portable,reference --pixel 1",
    "diff --sides portable,reference --pixel 1,1 --find",
    "diff --sides portable,reference --pixel 1,1 --sample 4294967296",
    "compare f.exr",
    "compare f.exr nosuch",
    "compare f.exr u.exr",
    "compare p.png p.png --heat-map h.exr",
    "compare p.png s.toml",
    "report",
    "report --out r --seeds 0",
    "report --out r --scenes nosuch",
    "report --out r --backends nosuch",
    "report --out r --samplers nosuch",
    "report --out r --max-samples 0",
    "report --out r --target 0",
    "report --out r --estimate-error off --calibration",
    "report --out p --reference nosuch.exr --backends portable --scenes metals",
    "stress --isa mmx",
    "stress --filter nosuch",
    "stress --search 0",
    "companion",
    "companion --out d --source nosuch",
    "companion --out d --bench nosuch.json",
    "gallery --out d --only nosuch",
    "gallery --out d --only metl",
    "check nosuch.png",
    "check s.toml",
    "check p.png --stage nosuch",
    "check p.png --stage all",
    "check p.png --json p.png",
];

/// Old and new text of a scene file that is otherwise right.
const EDITS: &[(&str, &str)] = &[
    ("radius = 1", "radius = 0"),
    ("radius = 1", "radius = -1"),
    ("radius = 1", "radius = 1e19"),
    ("radius = 1", "radius = \"x\""),
    ("radius = 1", ""),
    ("radius = 1", "radios = 1"),
    ("center = [0, 0, 0]", "center = [0, 0]"),
    ("center = [0, 0, 0]", "center = [0, 1e19, 0]"),
    ("material = \"ball\"", "material = \"bell\""),
    ("material = \"ball\"", ""),
    ("kind = \"lambertian\"", "kind = \"matte\""),
    ("kind = \"lambertian\"", "kind = \"metal\""),
    ("kind = \"lambertian\"", "kind = \"dielectric\""),
    ("kind = \"lambertian\"", ""),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, 1.5, 0.5]"),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, -0.1, 0.5]"),
    ("albedo = [0.5, 0.5, 0.5]", "albedo = [0.5, 0.5, 0.5]\nfuzz = 1"),
    ("albedo = [0.5, 0.5, 0.5]", ""),
    ("width = 8", "width = 0"),
    ("width = 8", "width = 16385"),
    ("width = 8", "width = 1.5"),
    ("height = 4", "height = 0"),
    ("samples_per_pixel = 2", "samples_per_pixel = 0"),
    ("samples_per_pixel = 2", "samples_per_pixel = 4294967297"),
    ("max_depth = 5", "max_depth = 0"),
    ("max_depth = 5", "max_depth = 10001"),
    ("max_depth = 5", "max_dept = 5"),
    ("max_depth = 5", "sampler = \"halton\""),
    ("max_depth = 5", "seed = -1"),
    ("max_depth = 5", "estimate_error = 1"),
    ("vfov_degrees = 40", "vfov_degrees = 0"),
    ("vfov_degrees = 40", "vfov_degrees = 179.1"),
    ("vfov_degrees = 40", "vfov_degrees = nan"),
    ("vfov_degrees = 40", "defocus_angle_degrees = 179"),
    ("vfov_degrees = 40", "focus_distance = 0"),
    ("look_at = [0, 0, 0]", "look_at = [0, 0, 5]"),
    ("look_at = [0, 0, 0]", "vup = [0, 0, 1]"),
    ("look_at = [0, 0, 0]", "vup = [0, 0, 0]"),
    ("top = [1, 1, 1]", "top = [1, 1, 101]"),
    ("top = [1, 1, 1]", "top = [1, 1, -1]"),
    ("[sky]", "[skies]"),
    ("[sky]", "[rules]\nsurface = \"nosuch\"\n[sky]"),
    ("[sky]", "[[keyframes]]\nframe = 3\n[[keyframes]]\nframe = 3\n[sky]"),
    ("[sky]", "[[keyframes]]\nlook_at = [0, 0, 0]\n[sky]"),
    ("[sky]", "[[keyframes]]\nframe = 100001\n[sky]"),
    ("[sky]", "[[keyframes]]\nframe = 1\nvfov_degrees = 0\n[sky]"),
    ("[sky]", "field = 5\n[sky]"),
    ("[sky]", "[sky"),
];

const SCENE: &str = "[camera]
look_from = [0, 0, 5]
look_at = [0, 0, 0]
vfov_degrees = 40

[render]
width = 8
height = 4
samples_per_pixel = 2
max_depth = 5

[sky]
top = [1, 1, 1]

[materials.ball]
kind = \"lambertian\"
albedo = [0.5, 0.5, 0.5]

[[spheres]]
center = [0, 0, 0]
radius = 1
material = \"ball\"
";

#[test]
fn refusals_are_as_kept() {
    let directory = tempfile::tempdir().unwrap();
    for line in MAKE {
        let told = told(directory.path(), line);
        assert!(!told.contains("[exit code"), "{told}");
    }
    std::fs::write(directory.path().join("s.txt"), "no picture").unwrap();
    let before = names(directory.path());
    let texts = at_once(LINES, |line| {
        let told = told(directory.path(), line);
        let told: String = told
            .lines()
            .filter(|line| !matches!(*line, "! " | "! For more information, try '--help'."))
            .map(|line| format!("{line}\n"))
            .collect();
        told
    });
    let accepted: Vec<&String> = texts.iter().filter(|told| !told.contains("[exit code 2]")).collect();
    assert!(accepted.is_empty(), "{accepted:#?}");
    assert_eq!(names(directory.path()), before);
    check("refusals", &texts.concat());
}

#[test]
fn refusals_of_scene_files_are_as_kept() {
    parse(SCENE, "s.toml").unwrap();
    let mut text = String::new();
    for (old, new) in EDITS {
        assert!(SCENE.contains(old), "{old}");
        match parse(&SCENE.replacen(old, new, 1), "s.toml") {
            Ok(_) => writeln!(text, "{new:?}\n  accepted").unwrap(),
            Err(error) => writeln!(text, "{new:?}\n  {error}").unwrap(),
        }
    }
    check("scene_files", &text);
}
