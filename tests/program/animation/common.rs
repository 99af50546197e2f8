//! Renders of frames, and a scene with keyframes.

pub use crate::common::program::{ends, names, until, weekender};

use std::path::Path;

/// Keyframes of a scene file after its `[camera]`.
pub const SCENE: &str = "\
[camera]
look_from = [0.0, 1.0, 4.0]
look_at = [0.0, 0.0, 0.0]
vfov_degrees = 40.0

[[keyframes]]
frame = 0

[[keyframes]]
frame = 2
look_from = [3.0, 1.0, 3.0]
vfov_degrees = 60.0

[[keyframes]]
frame = 5
look_from = [4.0, 2.0, 0.0]
look_at = [0.0, 0.5, 0.0]
defocus_angle_degrees = 2.0
focus_distance = 3.0

[materials.ground]
kind = \"lambertian\"
albedo = [0.8, 0.3, 0.1]

[[spheres]]
center = [0.0, 0.0, 0.0]
radius = 1.0
material = \"ground\"
";

/// A directory with the scene.
pub fn temp() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), SCENE).unwrap();
    directory
}

/// Renders frames, which must succeed, and returns the figures.
pub fn render(directory: &Path, arguments: &[&str]) -> serde_json::Value {
    let small = ["--batch", "--size", "24x14", "--threads", "2", "--json", "-"];
    let samples = if arguments.contains(&"--samples") { &[][..] } else { &["--samples", "4"] };
    crate::common::program::json(directory, &[&small, samples, arguments].concat())
}
