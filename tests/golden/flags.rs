//! What every flag of every command changes in the request that is made of the command line.

use crate::common::{at_once, check, digest_of, fields, told};
use crate::program_common::names;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::{LazyLock, Mutex};
use tempfile::TempDir;
use weekender::cli::{Request, command, parse};

/// Changes that are told one by one; of more, only the number and a digest.
const MOST: usize = 8;

/// For each command: its shortest request, then what is added to it.
const COMMANDS: &[(&str, &[&str])] = &[
    (
        "--device cpu",
        &[
            "--scene metals",
            "--scene field:20",
            "--scene s.toml",
            "--stage glass-tir",
            "--size 20x10",
            "--samples 7",
            "--time-limit 3",
            "--noise-target .25",
            "--autosave-every 2m",
            "--frame-log frames.csv",
            "--fresh",
            "--draw-with gl",
            "--draw-with wgpu",
            "--resume f.exr",
            "--threads 3",
            "--simulate-crash 5",
            "--vfov 30",
        ],
    ),
    (
        "--batch --device cpu",
        &[
            "--scene two-spheres",
            "--scene s.toml",
            "--stage shadow-acne",
            "--stage shadow-acne --samples 3",
            "--stage all --out d",
            "--stage all --out d --size 20x10 --samples 4",
            "--size 20x10",
            "--depth 7",
            "--sampler independent",
            "--seed 9",
            "--look-from 1,2,3",
            "--look-at 1,2,-3",
            "--vup 1,1,0",
            "--vfov 30",
            "--defocus-angle 2",
            "--defocus-angle 2 --focus-distance 3",
            "--samples 7",
            "--time-limit 3",
            "--time-limit 3 --samples 7",
            "--noise-target .25",
            "--noise-target .25 --time-limit 3",
            "--sample-range 4..12",
            "--sample-range 4..12 --time-limit 2",
            "--estimate-error off",
            "--estimate-error on",
            "--out p.exr",
            "--out p.ppm",
            "--out p.ppm --ppm ascii",
            "--out p.ppm --ppm binary",
            "--checkpoint c.exr",
            "--checkpoint c.exr --every 5m",
            "--checkpoint f.exr --continue",
            "--checkpoint c.exr --continue",
            "--resume f.exr",
            "--resume f.exr --samples 20",
            "--save-scene t.toml",
            "--json j.json",
            "--json -",
            "--progress on",
            "--progress off",
            "--threads 3",
            "--simd 1 --isa portable",
            "--simd off",
            "--simulate-panic 3",
            "--simulate-crash 5",
            "--frames 3..5 --turntable --out d",
            "--frames 3..5 --turntable=90 --out a.png",
            "--frames 3..5 --turntable=-1.5deg --out a-###.png",
            "--frames 3..5 --turntable --out a.png --fps 24",
            "--turntable=4 --out d --samples 3",
            "--scene k.toml --frames 0..3 --out d",
            "--log x.log",
        ],
    ),
    ("--batch --device reference", &["--threads 3"]),
    (
        "--batch --device gpu",
        &[
            "--adapter some",
            "--simulate-device-lost 2",
            "--simulate-out-of-memory 3",
            "--simulate-invalid-call 4",
            "--simulate-hang 5",
        ],
    ),
    ("--batch --device cpu,gpu", &["--threads 3", "--adapter some", "--simulate-device-lost 2"]),
    ("--list", &[]),
    ("--version", &["--verbose"]),
    (
        "bench",
        &[
            "--scene metals",
            "--scene metals --scene s.toml",
            "--scale 10..100",
            "--features",
            "--features --samples 5",
            "--size 20x10",
            "--samples 7",
            "--sampler independent",
            "--isa portable",
            "--threads 1000",
            "--adapter some",
            "--runs 2",
            "--run-limit .5",
            "--quick",
            "--quick --scale 10..100",
            "--features --quick",
            "--json j.json",
            "--json -",
            "--plot p.svg",
            "--progress on",
        ],
    ),
    (
        "plan --out d --parts 3",
        &[
            "--scene metals",
            "--scene s.toml --samples 6",
            "--stage metal",
            "--size 20x10",
            "--depth 7",
            "--sampler independent",
            "--seed 9",
            "--look-from 1,2,3",
            "--look-at 1,2,-3",
            "--vup 1,1,0",
            "--vfov 30",
            "--defocus-angle 2",
            "--focus-distance 3",
            "--samples 70",
            "--sample-range 8..64",
            "--estimate-error off",
            "--format slurm",
            "--format make",
            "--format parallel",
            "--program w",
            "--device cpu --threads 3",
            "--device reference",
            "--adapter some",
            "--simd 4 --isa avx2",
            "--every 5m",
            "--frames 0..9 --turntable=90",
            "--frames 0..9 --turntable=2deg --fps 24",
        ],
    ),
    ("plan --out d --parts 5", &["--frames 0..9 --turntable"]),
    (
        "compare portable reference",
        &[
            "--samples 9",
            "--scene metals",
            "--stage metal",
            "--size 8x4",
            "--depth 7",
            "--sampler independent",
            "--seed 3",
            "--look-from 1,2,3",
            "--look-at 1,2,-3",
            "--vup 1,1,0",
            "--vfov 30",
            "--defocus-angle 2",
            "--focus-distance 3",
        ],
    ),
    ("compare portable gpu", &["--adapter some"]),
    (
        "render-part p/plan.json --part 1 --device cpu",
        &[
            "--json j.json",
            "--progress off",
            "--threads 3",
            "--every 5m",
            "--simulate-panic 3",
            "--simd 1 --isa portable",
        ],
    ),
    ("render-part p/plan.json --part 1", &["--device gpu --adapter some", "--device reference"]),
    ("merge f.exr g.exr --out m.exr", &["--out m.png"]),
    ("merge p/plan.json --out m.exr", &["--out m.png", "--watch", "--watch --every 5s"]),
    ("merge p/plan.json --check", &[]),
    ("info f.exr", &["--json"]),
    (
        "diff --sides portable,reference --pixel 2,3",
        &[
            "--sample 5",
            "--scene metals",
            "--stage metal",
            "--size 20x10",
            "--seed 4",
            "--tolerance .5",
            "--json j.json",
            "--json -",
            "--depth 7",
            "--sampler independent",
            "--estimate-error off",
            "--look-from 1,2,3",
            "--look-at 1,2,-3",
            "--vup 1,1,0",
            "--vfov 30",
            "--defocus-angle 2",
            "--focus-distance 3",
        ],
    ),
    (
        "diff --pixel 2,3",
        &[
            "--sides cpu,portable",
            "--sides gpu,portable --adapter some",
            "--sides cpu,reference --isa portable",
        ],
    ),
    ("diff --sides portable,reference --find", &["--tolerance .5"]),
    ("diff --sides portable,reference --find=9", &["--tolerance .5"]),
    (
        "compare f.exr portable",
        &[
            "--samples 9",
            "--json j.json",
            "--heat-map h.png",
            "--encoding linear",
            "--encoding srgb",
            "--encoding gamma2",
            "--seed 3",
            "--size 8x4",
        ],
    ),
    (
        "report --out r --backends portable",
        &[
            "--scenes metals,s.toml",
            "--backends portable,reference",
            "--samplers sobol",
            "--size 20x10",
            "--seeds 3",
            "--time-limit 2",
            "--max-samples 64",
            "--reference-samples 256",
            "--calibration",
            "--estimate-error off",
            "--target .02",
            "--scenes three-spheres --reference f.exr",
            "--reference-backend portable",
            "--backends gpu --adapter some",
            "--progress on",
        ],
    ),
    (
        "stress --isa portable",
        &[
            "--filter copies",
            "--search 3",
            "--search 3 --seed 4",
            "--adapter some",
            "--out d",
            "--json j.json",
            "--progress on",
        ],
    ),
    ("companion --out d", &["--quick", "--source .", "--bench b.json", "--progress on"]),
    ("gallery --out d --device cpu", &["--quick", "--only metal,sky", "--progress on", "--threads 3"]),
    ("gallery --out d", &["--device reference", "--device gpu --adapter some"]),
    ("check p.png", &["--stage metal", "--json j.json", "--json -", "--out d"]),
];

/// A directory with the files that the command lines name. Relative paths lead there.
static PLACE: LazyLock<TempDir> = LazyLock::new(|| {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    for line in [
        "--save-scene s.toml --scene metals --size 8x4 --samples 2",
        "--batch --size 8x4 --samples 4 --device reference --out p.png --checkpoint f.exr",
        "--batch --size 8x4 --sample-range 4..8 --device reference --checkpoint g.exr --out q.png",
        "plan --size 8x4 --samples 4 --parts 2 --out p",
    ] {
        let told = told(here, line);
        assert!(!told.contains("[exit code"), "{told}");
    }
    let scene = std::fs::read_to_string(here.join("s.toml")).unwrap();
    let keyframe = |frame: u32, x: u32| {
        format!("[[keyframes]]\nframe = {frame}\nlook_from = [{x}, 1, 2]\nlook_at = [0, 0, 0]\n\n")
    };
    std::fs::write(here.join("k.toml"), format!("{scene}\n{}{}", keyframe(0, 3), keyframe(4, 5))).unwrap();
    std::env::set_current_dir(here).unwrap();
    directory
});

fn request(line: &str) -> Result<Request, String> {
    let words = shlex::split(&format!("weekender {line}")).unwrap();
    parse(words.into_iter().map(Into::into)).map_err(|failure| failure.to_string())
}

fn changes(base: &Request, request: &Request) -> String {
    let [before, after] =
        [base, request].map(|request| fields(request).into_iter().collect::<BTreeMap<_, _>>());
    let places: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
    let none = String::from("nothing");
    let mut lines = Vec::new();
    for place in places {
        let [old, new] = [&before, &after].map(|fields| fields.get(place).unwrap_or(&none));
        if old != new {
            lines.push(format!("    {place}: {new}\n"));
        }
    }
    if lines.len() > MOST {
        let all = lines.concat();
        lines.truncate(MOST);
        lines.push(format!("    and more, digest {}\n", digest_of(all.as_bytes())));
    }
    lines.concat()
}

#[test]
fn every_flag_changes_what_it_should() {
    let here = PLACE.path().to_str().unwrap().to_owned();
    let refused = Mutex::new(Vec::new());
    let refuse = |line: &str, message: String| refused.lock().unwrap().push(format!("{line}: {message}"));
    let texts = at_once(COMMANDS, |(base, additions)| {
        let mut text = format!("{base}\n");
        let before = match request(base) {
            Ok(before) => before,
            Err(message) => {
                refuse(base, message);
                return text;
            }
        };
        for addition in *additions {
            writeln!(text, "  {addition}").unwrap();
            match request(&format!("{base} {addition}")) {
                Ok(after) => text.push_str(&changes(&before, &after)),
                Err(message) => refuse(&format!("{base} {addition}"), message),
            }
        }
        text
    });
    assert_eq!(refused.into_inner().unwrap(), [""; 0], "what is refused shows nothing");
    check("flags", &texts.concat().replace(&here, "DIR"));
    assert!(names(PLACE.path()).contains(&"k.toml".to_owned()));
}

/// A new flag has to be listed above.
#[test]
fn every_flag_is_listed() {
    let lines = |command: &str| -> String {
        let own = COMMANDS.iter().filter(|(base, _)| match command {
            "weekender" => base.starts_with("--"),
            name => base.split(' ').next() == Some(name),
        });
        own.map(|(base, additions)| format!("{base} {} ", additions.join(" "))).collect()
    };
    let root = command();
    let mut missing = Vec::new();
    for command in std::iter::once(&root).chain(root.get_subcommands()) {
        let lines = lines(command.get_name());
        for argument in command.get_arguments().filter(|argument| !argument.is_global_set()) {
            let Some(flag) = argument.get_long() else { continue };
            // Faults are injected alike in all commands.
            let is_root = command.get_name() == root.get_name();
            if ["help", "log"].contains(&flag) || (!is_root && flag.starts_with("simulate-")) {
                continue;
            }
            if !lines.split([' ', '=']).any(|word| word.strip_prefix("--") == Some(flag)) {
                missing.push(format!("{} --{flag}", command.get_name()));
            }
        }
    }
    assert!(missing.is_empty(), "not listed: {missing:#?}");
}
