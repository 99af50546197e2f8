//! Which room may use which.

/// Each room with the rooms that it may use, one row per room. Lower layers come first.
pub const ROOMS: &str = "\
excerpt:
system:
numbers:
scene:
stages: scene
film: system stages
denoise: system film
job: system scene stages film
kernel: scene stages film job
prepared: scene stages film job kernel
render_cpu: system stages film job kernel prepared
render_gpu: system stages film job kernel prepared
backends: scene stages film job kernel render_cpu render_gpu
progressive: system numbers scene stages film denoise job backends
batch: system scene stages film denoise job backends progressive
cli: system scene stages film job render_cpu render_gpu backends progressive batch
comparison: system numbers scene stages film job kernel render_cpu batch cli
measure: system numbers scene stages film denoise job render_cpu backends cli comparison
app: excerpt system numbers scene stages film denoise job render_cpu render_gpu backends progressive batch cli comparison measure";

/// Crates that only some rooms may use.
pub const CRATES: &[(&str, &[&str])] = &[
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("egui_plot", &["app"]),
    ("rfd", &["app"]),
    ("wgpu", &["render_gpu"]),
    ("rayon", &["system", "denoise", "prepared", "render_cpu", "render_gpu", "backends", "comparison"]),
    ("fearless_simd", &["denoise", "render_cpu"]),
    ("obvhs", &["prepared"]),
    ("libm", &["scene"]),
    ("image", &["job", "comparison", "app"]),
    ("indicatif", &["system", "measure"]),
    ("plotters", &["numbers"]),
    ("clap", &["system", "job", "cli", "batch"]),
    ("env_filter", &["system"]),
    ("signal_hook", &["system"]),
];
