//! What commands print and write, one after another in one directory.

use crate::common::{at_once, check, digest_of, settled, told};
use crate::program_common::names;
use std::path::Path;

/// A line begins with `cat`, `digest` or `ls`, or is a command line of the program.
const SESSIONS: &[(&str, &[&str])] = &[
    (
        "batch",
        &[
            "--batch --device cpu --isa portable --threads 1 --size 16x9 --samples 6",
            "info three-spheres.png",
            "--batch --device reference --threads 1 --size 16x9 --samples 4 --stage glass-tir --out g.ppm --ppm ascii --checkpoint g.exr --json j.json",
            "cat j.json",
            "info g.exr",
            "info g.ppm",
            "info g.exr --json",
            "info three-spheres.png --json",
            "--batch --isa portable --threads 1 --resume g.exr --checkpoint g.exr --samples 10 --out g.png",
            "info g.exr",
            "--batch --isa portable --threads 1 --resume g.exr --samples 10 --out g.png",
            "--batch --isa portable --threads 1 --size 16x9 --estimate-error off --samples 3 --scene metals --out m.exr --json -",
            "info m.exr",
            "--batch --isa portable --threads 1 --size 16x9 --sample-range 8..16 --scene book --out b.png --checkpoint b.exr",
            "info b.exr",
            "--save-scene s.toml --scene close-up --seed 4 --vfov 33 --sampler independent",
            "cat s.toml",
            "info s.toml",
            "info s.toml --json",
            "--save-scene t.toml --stage gamut --look-from 1,2,3 --defocus-angle 2 --focus-distance 3 --estimate-error off",
            "cat t.toml",
            "ls .",
        ],
    ),
    (
        "film_files",
        &[
            "--batch --isa portable --threads 1 --size 16x9 --sample-range 0..4 --out a.exr",
            "--batch --isa portable --threads 1 --size 16x9 --sample-range 4..8 --out b.exr",
            "--batch --isa portable --threads 1 --size 16x9 --sample-range 12..16 --out c.exr",
            "--batch --isa portable --threads 1 --size 16x9 --samples 4 --seed 1 --out seed.exr",
            "merge a.exr b.exr --out ab.exr",
            "merge a.exr b.exr c.exr --out abc.exr",
            "info abc.exr",
            "merge a.exr a.exr --out aa.exr",
            "merge a.exr seed.exr --out no.exr",
            "compare a.exr a.exr",
            "compare a.exr b.exr",
            "compare a.exr seed.exr --heat-map h.png --json -",
            "compare a.exr portable",
            "compare ab.exr reference --json -",
            "digest h.png",
            "diff --sides portable,reference --pixel 3,5 --sample 2 --size 16x9",
            "diff --sides portable,reference --pixel 3,5 --sample 2 --size 16x9 --tolerance 1e-9",
            "diff --sides portable,reference --pixel 7,4 --stage glass-schlick --size 16x9 --json -",
            "diff --sides portable,portable --find=4 --size 8x5",
            "ls .",
        ],
    ),
    (
        "plans",
        &[
            "plan --size 16x9 --samples 8 --parts 3 --out p --isa portable --threads 1 --program weekender",
            "cat p/plan.json",
            "merge p/plan.json --check",
            "render-part p/plan.json --part 1 --isa portable --threads 1",
            "render-part p/plan.json --part 1 --isa portable --threads 1",
            "render-part p/plan.json --part 3 --isa portable --threads 1",
            "merge p/plan.json --check",
            "merge p/plan.json --out some.exr",
            "render-part p/plan.json --part 0 --isa portable --threads 1",
            "render-part p/plan.json --part 2 --isa portable --threads 1",
            "merge p/plan.json --check",
            "merge p/plan.json --out p/picture.exr --out p/picture.png",
            "info p/picture.exr",
            "info p/plan.json",
            "info p/plan.json --json",
            "plan --size 16x9 --samples 8 --parts 2 --out slurm --format slurm --program weekender",
            "plan --size 16x9 --samples 8 --parts 2 --out make --format make --program weekender",
            "plan --size 16x9 --samples 8 --parts 2 --out parallel --format parallel --program weekender",
            "ls slurm",
            "ls make",
            "ls parallel",
            "cat slurm/*",
            "cat make/*",
            "cat parallel/*",
            "plan --size 8x5 --samples 2 --frames 0..5 --turntable 60 --parts 2 --out f --program weekender",
            "cat f/plan.json",
            "info f/plan.json",
            "render-part f/plan.json --part 0 --isa portable --threads 1",
            "merge f/plan.json --check",
            "merge f/plan.json --out f/animation.png",
            "render-part f/plan.json --part 1 --isa portable --threads 1",
            "merge f/plan.json --out f/animation.png",
            "ls f",
            "info f/animation.png",
            "--batch --isa portable --threads 1 --size 8x5 --samples 2 --frames 2..5 --turntable=-9deg --out t-###.png",
            "--batch --isa portable --threads 1 --size 8x5 --samples 2 --frames 2..6 --turntable=-9deg --out t-###.png",
            "info t-002.png",
            "ls .",
        ],
    ),
    (
        "check",
        &[
            "--batch --isa portable --threads 1 --size 48x27 --samples 8 --stage normals --out normals.png",
            "check normals.png",
            "check normals.png --stage normals --json -",
            "--batch --isa portable --threads 1 --size 48x27 --samples 8 --stage red-sphere --out red.png",
            "check red.png --stage normals",
            "check red.png --stage sky --out seen",
            "ls seen",
        ],
    ),
];

fn step(here: &Path, line: &str) -> String {
    let Some((word, name)) = line.split_once(' ').filter(|(word, _)| ["cat", "digest", "ls"].contains(word))
    else {
        return told(here, line);
    };
    let said = match word {
        "ls" if !here.join(name).is_dir() => "no directory\n".to_owned(),
        "ls" => names(&here.join(name)).join("\n") + "\n",
        "digest" => digest_of(&std::fs::read(here.join(name)).unwrap_or_default()) + "\n",
        _ => match name.strip_suffix("/*") {
            Some(folder) if !here.join(folder).is_dir() => "no directory\n".to_owned(),
            Some(folder) => {
                let files = names(&here.join(folder)).into_iter();
                let files = files.filter(|name| !name.ends_with(".toml") && !name.ends_with(".json"));
                let read = |name: String| {
                    let text = std::fs::read_to_string(here.join(folder).join(&name)).unwrap();
                    format!("== {name}\n{}", settled(&text, here))
                };
                files.map(read).collect()
            }
            None => settled(
                &std::fs::read_to_string(here.join(name)).unwrap_or_else(|error| format!("{error}\n")),
                here,
            ),
        },
    };
    format!("$ {line}\n{said}")
}

#[test]
fn sessions_are_as_kept() {
    let texts = at_once(SESSIONS, |(_, lines)| {
        let directory = tempfile::tempdir().unwrap();
        lines.iter().map(|line| step(directory.path(), line)).collect::<String>()
    });
    for ((name, _), text) in SESSIONS.iter().zip(texts) {
        check(name, &text);
    }
}
