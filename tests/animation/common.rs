//! Renders of frames, and a scene with keyframes.

pub use crate::program_common::{names, weekender};

use std::path::Path;
use std::process::Output;

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

pub fn run(directory: &Path, arguments: &[&str]) -> Output {
    weekender(directory, arguments).output().unwrap()
}

/// Renders frames, which must succeed, and returns the figures.
pub fn render(directory: &Path, arguments: &[&str]) -> serde_json::Value {
    let small = ["--batch", "--size", "24x14", "--threads", "2", "--json", "-"];
    let samples = if arguments.contains(&"--samples") { &[][..] } else { &["--samples", "4"] };
    let output = run(directory, &[&small, samples, arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The bytes of a picture's pixels.
pub fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}
