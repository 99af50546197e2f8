//! Which room may use which.

/// Each room with the rooms that it may use, one row a room. Lower layers come first.
pub const ROOMS: &str = "\
memory:
console:
files: memory console
suggest:
number:
threads:
shell:
scene: number
stages: scene suggest
animation: scene
film: memory files number threads stages
render: memory scene stages film
record:
heat:
recipe: animation memory files scene stages film render suggest
output: memory files stages film
saved: files stages film render recipe output
plan: animation files film output render recipe stages shell
chart: files
sampling: render
kernel: scene stages film render sampling
prepared: scene stages film render kernel
render_cpu: memory stages film render record sampling kernel prepared
render_gpu: stages film render record sampling kernel prepared
explain: scene stages render record sampling
layers: scene render record render_cpu
web: scene stages render kernel render_gpu
backends: threads film render render_cpu render_gpu
progressive: stages film render heat backends
describe: scene stages film render recipe progressive
baseline: scene render
environment:
failure: console
journal: files console failure
interrupt: console failure
statistics:
cli: animation memory number scene stages film render recipe output saved chart render_cpu render_gpu backends progressive failure files plan shell
terminal: console failure cli files
about: film render_cpu render_gpu terminal
batch: scene stages film render recipe output saved render_cpu backends progressive describe console failure interrupt journal cli terminal files memory plan shell
merge: files stages film recipe output saved plan progressive describe console failure interrupt cli terminal shell
info: memory console files film recipe output saved plan describe failure cli terminal
gallery: files suggest stages film render recipe output render_cpu backends progressive describe console failure interrupt cli terminal
check: files scene stages render heat recipe sampling render_cpu failure statistics cli terminal
bench: scene film render recipe chart prepared render_cpu render_gpu backends baseline failure interrupt statistics cli terminal files
report: files stages film render recipe output saved chart backends progressive baseline console failure interrupt statistics cli terminal
compare: memory film render heat recipe output saved backends failure statistics cli terminal files
diff: scene stages film render record render_cpu render_gpu console failure cli terminal files
stress: scene stages film render recipe output sampling render_cpu backends failure interrupt cli terminal files
companion: files stages explain render_cpu chart web console failure interrupt cli terminal gallery bench report
app: memory scene stages animation film render heat recipe output saved prepared render_cpu render_gpu explain layers backends progressive describe console statistics shell cli companion gallery check compare stress files interrupt";

/// Crates that only some rooms may use.
pub const CRATES: &[(&str, &[&str])] = &[
    ("base64", &["web"]),
    ("egui", &["app"]),
    ("eframe", &["app"]),
    ("egui_plot", &["app"]),
    ("rfd", &["app"]),
    ("wgpu", &["render_gpu"]),
    ("rayon", &["prepared", "render_cpu", "render_gpu", "layers", "check"]),
    ("fearless_simd", &["render_cpu"]),
    ("obvhs", &["prepared"]),
    ("libm", &["animation", "statistics"]),
    ("image", &["output", "compare", "check"]),
    ("indicatif", &["terminal", "report"]),
    ("maud", &["gallery", "companion"]),
    ("plotters", &["chart"]),
    ("clap", &["cli", "failure"]),
    ("env_filter", &["journal"]),
    ("ctrlc", &["interrupt"]),
    ("signal_hook", &["interrupt"]),
    ("pulldown_cmark", &["companion"]),
    ("syntect", &["companion"]),
    ("math_core", &["companion"]),
];
