//! A shader file and its twin have the same functions in the same order, except those that are listed here because one
//! side alone has them.

use std::path::Path;

struct Twins {
    /// In `shaders`.
    shader: &'static str,
    /// In `src/render_cpu`.
    rust: &'static [&'static str],
    only_in_shader: &'static str,
    only_in_rust: &'static str,
}

const TWINS: [Twins; 8] = [
    Twins {
        shader: "path",
        rust: &[
            "path/schedule",
            "path/intersect",
            "path/shade",
            "path/draw",
            "path/scatter",
            "path/packet",
            "path/records",
        ],
        only_in_shader: "take_block iterations_over_lists",
        only_in_rust: "continue_paths nothing next_sample with_length2_or idle is_small load is_permuted number \
                       vector",
    },
    Twins { shader: "rules", rust: &["path/rules"], only_in_shader: "", only_in_rust: "book_hit_point" },
    Twins { shader: "camera", rust: &["camera"], only_in_shader: "", only_in_rust: "" },
    Twins { shader: "material", rust: &["material"], only_in_shader: "", only_in_rust: "unused" },
    Twins {
        shader: "sphere",
        rust: &["sphere"],
        only_in_shader: "smaller_key chord_end",
        only_in_rust: "splat load new key settle distance near_end nearest_end",
    },
    Twins {
        shader: "bvh",
        rust: &["bvh"],
        only_in_shader: "slope_of hit_bits planes_at four_hits hits_of in_order",
        only_in_rust: "misses_box near_children",
    },
    Twins { shader: "rng", rust: &["rng"], only_in_shader: "pixel_key", only_in_rust: "" },
    Twins {
        shader: "lanes",
        rust: &["lanes/mod"],
        only_in_shader: "dot3 mul_add3 neg_mul_add3 normalized",
        only_in_rust: "select bits mul_add mul_sub neg_mul_add sqrt abs min max lt is_negative eq is_wide is_idle \
                       splat splat_u constant load mask load_u expand store_u store keep fill negate_where key \
                       from_key exclude float_of permute gather rows_of polynomial_sin_cos_turns",
    },
];

/// Names of all functions except tests, in order.
fn functions(path: &str) -> Vec<String> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let declared = code.lines().filter_map(|line| {
        let (qualifiers, rest) = line.split_once("fn ")?;
        let is_declaration =
            qualifiers.split_whitespace().all(|word| ["pub", "pub(super)", "const"].contains(&word));
        let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
        is_declaration.then(|| name.to_owned())
    });
    declared.collect()
}

/// The functions without those that are listed, and those that are listed without need.
fn except(functions: &[String], listed: &str) -> (Vec<String>, Vec<String>) {
    let listed: Vec<&str> = listed.split_whitespace().collect();
    let others = functions.iter().filter(|name| !listed.contains(&name.as_str()));
    let missing = listed.iter().filter(|name| !functions.iter().any(|function| function == *name));
    (others.cloned().collect(), missing.map(|name| (*name).to_owned()).collect())
}

#[test]
fn twins_have_same_functions_in_order() {
    for Twins { shader, rust, only_in_shader, only_in_rust } in TWINS {
        let twin: Vec<String> =
            rust.iter().flat_map(|file| functions(&format!("src/render_cpu/{file}.rs"))).collect();
        let (own, missing) = except(&functions(&format!("shaders/{shader}.wgsl")), only_in_shader);
        assert_eq!(missing, Vec::<String>::new(), "listed here, but not in shaders/{shader}.wgsl");
        let (twin, missing) = except(&twin, only_in_rust);
        assert_eq!(missing, Vec::<String>::new(), "listed here, but not in {rust:?}");
        assert_eq!(own, twin, "shaders/{shader}.wgsl and {rust:?}");
    }
}
