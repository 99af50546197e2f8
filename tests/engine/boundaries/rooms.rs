//! Which room may use which.

/// Each room with the rooms that it may use, one row per room. Lower layers come first.
pub const ROOMS: &str = "\
excerpt:
system:
numbers:
scene:
stages: system scene
film: system stages
denoise: system film
job: system scene stages film
kernel: scene stages film job
prepared: scene stages film job kernel
render_cpu: system stages film job kernel prepared
render_gpu: system stages film job kernel prepared
backends: system scene stages film job kernel render_cpu render_gpu
progressive: system numbers scene stages film denoise job backends
cli: system scene stages film job render_cpu render_gpu backends progressive
batch: system scene stages film denoise job backends progressive cli
comparison: system numbers scene stages film job kernel render_cpu render_gpu backends cli
measure: system numbers scene stages film denoise job kernel render_cpu render_gpu backends cli comparison
app: system numbers scene stages film denoise job render_cpu render_gpu backends progressive cli batch comparison measure excerpt";

/// Crates that only some rooms may use.
pub const CRATES: &[(&str, &[&str])] = &[
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("egui_plot", &["app"]),
    ("rfd", &["app"]),
    ("wgpu", &["render_gpu"]),
    (
        "rayon",
        &["system", "denoise", "prepared", "render_cpu", "render_gpu", "backends", "comparison", "measure"],
    ),
    ("fearless_simd", &["denoise", "render_cpu"]),
    ("obvhs", &["prepared"]),
    ("libm", &["numbers", "scene"]),
    ("image", &["job", "comparison", "app"]),
    ("indicatif", &["system", "cli", "measure"]),
    ("plotters", &["numbers"]),
    ("clap", &["system", "job", "cli"]),
    ("env_filter", &["system"]),
    ("signal_hook", &["system"]),
];
