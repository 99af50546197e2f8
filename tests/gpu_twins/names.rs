//! The functions that a shader file shares with its twin are in the same order.

use std::path::Path;

/// Shader files and their twins in `src/render_cpu`.
const PAIRS: [(&str, &[&str]); 6] = [
    ("path", &["path/mod", "path/collect", "path/arrive", "path/draw", "path/send"]),
    ("camera", &["camera"]),
    ("material", &["material"]),
    ("sphere", &["sphere"]),
    ("bvh", &["bvh"]),
    ("rng", &["rng"]),
];

/// Names of all functions except tests.
fn functions(path: &str) -> Vec<String> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let declared = code.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = line.strip_prefix("pub(super) ").or(line.strip_prefix("pub ")).unwrap_or(line);
        let name = line.strip_prefix("fn ")?;
        Some(name.split(|c: char| !c.is_alphanumeric() && c != '_').next()?.to_owned())
    });
    declared.collect()
}

#[test]
fn twins_have_same_functions_in_order() {
    for (shader, twins) in PAIRS {
        let own = functions(&format!("shaders/{shader}.wgsl"));
        let twin: Vec<String> =
            twins.iter().flat_map(|file| functions(&format!("src/render_cpu/{file}.rs"))).collect();
        let common: Vec<&String> = own.iter().filter(|name| twin.contains(name)).collect();
        let in_twin: Vec<&String> = twin.iter().filter(|name| own.contains(name)).collect();
        assert_eq!(common, in_twin, "{shader}");
        assert!(common.len() > 2, "{shader}: of {own:?} only {common:?} have a twin");
    }
}
