//! Options for opening and using an adapter, errors if none can be used, and the renderer's report.

use std::time::Duration;
use thiserror::Error;

/// Target time of a dispatch in batch rendering.
pub const BATCH_TARGET: Duration = Duration::from_millis(50);

/// Target time of a dispatch while someone interacts.
pub const INTERACTIVE_TARGET: Duration = Duration::from_millis(8);

/// How long to wait for a device before it counts as hung. No dispatch takes this long.
pub const PATIENCE: Duration = Duration::from_secs(8);

/// Factor for the wait at a kernel's first dispatch, when the driver may have to compile it.
pub const COMPILING_PATIENCE: u32 = 6;

/// Options for opening and using an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuOptions {
    /// Part of an adapter's name, backend or driver; by default the best adapter is used.
    pub adapter: Option<String>,
    /// Whether a software adapter is acceptable.
    pub allow_software: bool,
    /// Target time of a dispatch on a GPU. On a software adapter, dispatches last ten times as long.
    pub dispatch_target: Duration,
    /// Whether kernels contain only what the job needs. Turned off to measure the gain.
    pub specialise: bool,
    /// Samples per pixel in a dispatch, for measurements; by default as many as the target time allows.
    pub samples_per_dispatch: Option<u64>,
    /// Loop iterations after which a thread suspends its path, for tests; by default as many as are safe.
    pub iteration_limit: Option<u32>,
    /// Maximum number of bytes of a film on the device at once; by default the adapter's binding limit.
    pub film_limit: Option<u64>,
    /// How long to wait for the device before giving it up.
    pub patience: Duration,
}

impl Default for GpuOptions {
    fn default() -> Self {
        GpuOptions {
            adapter: None,
            allow_software: false,
            dispatch_target: BATCH_TARGET,
            specialise: true,
            samples_per_dispatch: None,
            iteration_limit: None,
            film_limit: None,
            patience: PATIENCE,
        }
    }
}

impl GpuOptions {
    /// Options for the adapter named `wanted`, which may be a software adapter; `None` means the best adapter.
    pub fn of_adapter(wanted: Option<&str>) -> Self {
        GpuOptions {
            adapter: wanted.map(str::to_owned),
            allow_software: wanted.is_some(),
            ..GpuOptions::default()
        }
    }
}

/// The graphics interfaces that `WGPU_BACKEND` names, if it names any.
pub(super) fn variable() -> Option<String> {
    std::env::var("WGPU_BACKEND").ok().filter(|names| !names.is_empty())
}

/// Restriction of the search for adapters by the environment.
fn restriction() -> String {
    let restriction = |backends| format!(" (WGPU_BACKEND allows only \"{backends}\")");
    variable().map_or(String::new(), restriction)
}

/// Why no GPU is available for rendering.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum GpuError {
    /// The machine has no adapter.
    #[error(
        "no graphics adapter was found{}; install its Vulkan driver, or render on the CPU",
        restriction()
    )]
    None,
    /// No adapter matches the name.
    #[error("no adapter matches \"{wanted}\"; available adapters: {}", available.join("; "))]
    NoMatch { wanted: String, available: Vec<String> },
    /// Only software adapters were found.
    #[error("there is no GPU, only software adapters: {}; choose one by name, or render on the CPU, which is faster", available.join("; "))]
    Software { available: Vec<String> },
    /// The adapter cannot run the kernel.
    #[error("{adapter} has {lacks}; choose another adapter, or render on the CPU")]
    Lacks { adapter: String, lacks: String },
    /// The adapter could not be opened.
    #[error("{adapter} could not be opened: {reason}; choose another adapter, or render on the CPU")]
    Device { adapter: String, reason: String },
}

/// Figures of a renderer since it was created, for reports.
#[derive(Clone, Copy, Debug)]
pub struct GpuReport {
    /// Number of dispatches so far.
    pub dispatches: u64,
    /// Total time of the dispatches.
    pub dispatch_time: Duration,
    /// The clock that measured them: "timestamp queries" or "wall clock".
    pub timer: &'static str,
    /// Readbacks of films that were requested.
    pub films: u64,
    /// Total time that the host spent adding the sums of the current film.
    pub film_time: Duration,
}
