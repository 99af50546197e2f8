//! Compares the functions of each shader file with its twin's: same names, same order.

use std::collections::BTreeSet;
use std::path::Path;

/// A shader file and its twin in `src/render_cpu`, as one or more files in order.
struct Pair {
    shader: &'static str,
    twins: &'static [&'static str],
    /// Functions that only the shader has, and why.
    shader_alone: &'static [(&'static str, &'static str)],
    /// Functions that only the twin has, and why.
    twin_alone: &'static [(&'static str, &'static str)],
}

const PAIRS: &[Pair] = &[
    Pair {
        shader: "path.wgsl",
        twins: &["path/mod.rs", "path/collect.rs", "path/arrive.rs", "path/draw.rs", "path/send.rs"],
        shader_alone: &[
            ("next_item", "threads share a list of blocks, packets a list of pixels"),
            ("turns_over_lists", "no loop of the CPU is cut off"),
        ],
        twin_alone: &[
            ("idle", "a packet before its first work; the shader's path is made in `trace`"),
            ("shade", "packets take turns, a thread has one path"),
            ("next_stream", "a lane counts its stream up, a thread has its bounce"),
            ("last_stream", "a lane counts its stream up, a thread has its bounce"),
            ("with_length2_or", "a thread tests for short directions in `scatter_path`"),
            ("nothing", "the state before `collect`; a thread keeps none"),
            ("nowhere", "one lane leaves out the bounce of an ended path, as a thread does"),
        ],
    },
    Pair { shader: "camera.wgsl", twins: &["camera.rs"], shader_alone: &[], twin_alone: &[] },
    Pair { shader: "material.wgsl", twins: &["material.rs"], shader_alone: &[], twin_alone: &[] },
    Pair {
        shader: "sphere.wgsl",
        twins: &["sphere.rs"],
        shader_alone: &[
            ("smaller_key", "`Lanes::min_key`"),
            ("chord_end", "a thread tests the glass that it is inside of before the hierarchy"),
        ],
        twin_alone: &[
            ("splat", "a sphere for all lanes"),
            ("load", "a sphere for all lanes"),
            ("new", "a sphere for all lanes"),
            ("key", "of a candidate; a thread excludes by a negative distance"),
            ("near_end", "a packet jumps to one of two ends, a thread computes both in `signed_root`"),
            ("nearest_end", "a packet jumps to one of two ends, a thread computes both in `signed_root`"),
            ("settle", "a tie of some lanes, in `take_in_any_order`"),
            ("distance", "of a key, a bitcast"),
        ],
    },
    Pair {
        shader: "bvh.wgsl",
        twins: &["bvh.rs"],
        shader_alone: &[
            ("slope_of", "a thread knows in which direction its ray goes; the rays of a packet differ"),
            ("hit_bits", "`misses_box` for four boxes"),
            ("planes_at", "eight children"),
            ("four_hits", "eight children"),
            ("hits_of", "eight children"),
            ("in_order", "the order of eight children"),
        ],
        twin_alone: &[
            ("misses_box", "one box for all lanes"),
            ("near_children", "the order of two children for a packet"),
        ],
    },
    Pair {
        shader: "rng.wgsl",
        twins: &["rng.rs"],
        shader_alone: &[
            ("stream_of", "a lane counts its stream up"),
            ("pixel_key", "made when a lane is refilled with a block: `sampling::pixel_key`"),
        ],
        twin_alone: &[],
    },
];

/// Names of all functions except tests.
fn functions(text: &str) -> Vec<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let declared = code.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = line.strip_prefix("pub(super) ").or(line.strip_prefix("pub ")).unwrap_or(line);
        let name = line.strip_prefix("fn ")?;
        Some(name.split(|c: char| !c.is_alphanumeric() && c != '_').next()?.to_owned())
    });
    declared.collect()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

/// The differences between two lists of names.
fn faults(pair: &Pair, shader: &[String], twin: &[String]) -> Vec<String> {
    let mut faults = Vec::new();
    let sides = [(shader, twin, pair.shader_alone), (twin, shader, pair.twin_alone)];
    for (own, other, alone) in sides {
        for name in own.iter().filter(|name| !other.contains(name)) {
            if alone.iter().all(|(known, _)| known != name) {
                faults.push(format!("{} and {:?}: one side alone has {name}", pair.shader, pair.twins));
            }
        }
        for (name, _) in alone {
            if !own.iter().any(|own| own == name) || other.iter().any(|other| other == name) {
                faults.push(format!("{}: {name} is not on one side alone", pair.shader));
            }
        }
    }
    let common = |own: &[String], other: &[String]| -> Vec<String> {
        own.iter().filter(|name| other.contains(name)).cloned().collect()
    };
    let (in_shader, in_twin) = (common(shader, twin), common(twin, shader));
    if in_shader != in_twin {
        faults.push(format!("{}: {in_shader:?} are in another order in {in_twin:?}", pair.shader));
    }
    faults
}

#[test]
fn twins_have_same_functions_in_order() {
    for pair in PAIRS {
        let shader = functions(&read(&format!("shaders/{}", pair.shader)));
        let twin: Vec<String> =
            pair.twins.iter().flat_map(|file| functions(&read(&format!("src/render_cpu/{file}")))).collect();
        assert!(shader.len() > 2 && twin.len() > 2, "{}: no functions were found", pair.shader);
        let faults = faults(pair, &shader, &twin);
        assert!(faults.is_empty(), "{faults:#?}");
    }
}

/// Every arithmetic function of the shaders has a CPU twin of the same name; the rest of the arithmetic is in
/// [`weekender::render_cpu::lanes::Lanes`].
#[test]
fn arithmetic_has_twins() {
    let shader = functions(&read("shaders/lanes.wgsl"));
    let twins: BTreeSet<String> = ["mod", "vector"]
        .iter()
        .flat_map(|file| functions(&read(&format!("src/render_cpu/lanes/{file}.rs"))))
        .collect();
    // WGSL has its own `dot`, and packets normalise their directions when the rays are sent.
    let other_names =
        [("dot3", "dot"), ("mul_add3", "mul_add"), ("neg_mul_add3", "neg_mul_add"), ("normalized", "sqrt")];
    for name in shader {
        let twin =
            other_names.iter().find(|(other, _)| *other == name).map_or(name.as_str(), |(_, twin)| twin);
        assert!(twins.contains(twin), "{name} has no twin");
    }
}

/// The check itself finds differences.
#[test]
fn missing_twin_is_found() {
    let pair = Pair { shader: "a", twins: &["b"], shader_alone: &[("x", "")], twin_alone: &[] };
    let names = |list: &str| list.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert!(faults(&pair, &names("f x g"), &names("f g")).is_empty());
    assert_eq!(faults(&pair, &names("f x g h"), &names("f g")).len(), 1);
    assert_eq!(faults(&pair, &names("f x g"), &names("f h g")).len(), 1);
    assert_eq!(faults(&pair, &names("f x g"), &names("g f")).len(), 1);
    assert_eq!(faults(&pair, &names("f g"), &names("f g")).len(), 1);
}
