//! How to open and use an adapter, why there is none, and what was done with it.

use std::time::Duration;
use thiserror::Error;

/// What a dispatch should take when nobody waits for it.
pub const BATCH_TARGET: Duration = Duration::from_millis(50);

/// What a dispatch should take while someone interacts.
pub const INTERACTIVE_TARGET: Duration = Duration::from_millis(8);

/// Longer than any dispatch takes: a device that has not answered by then hangs.
pub const PATIENCE: Duration = Duration::from_secs(8);

/// The first dispatch of a kernel can wait for the driver to compile it, and gets so many times as long.
pub const COMPILING_PATIENCE: u32 = 6;

/// The hierarchy over a scene of many spheres. Both find the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HierarchyKind {
    /// Two children a node: that of the prepared scene, which the CPU has too.
    Bvh2,
    /// Eight children a node, with compressed boxes.
    #[default]
    Cwbvh,
}

/// What can go wrong with a device in the middle of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It is gone: unplugged, reset, or its driver was.
    Lost,
    /// It has no memory left.
    OutOfMemory,
    /// It was asked for something invalid: a mistake of this program or of the driver.
    Invalid,
    /// It does not answer for 10 s.
    Hang,
    /// It reports a dispatch as done and has left out all of it. Only at [`InjectionPoint::Dispatch`].
    Short,
    /// So it does from then on.
    AlwaysShort,
}

/// Where an injected fault can strike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InjectionPoint {
    /// Before a job is prepared.
    Prepare,
    /// Before a dispatch is sent off.
    #[default]
    Dispatch,
    /// Before a film is sent for.
    Fetch,
}

/// A fault that is brought about on purpose, to see that a render survives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultInjection {
    /// What goes wrong.
    pub fault: Fault,
    /// Where.
    pub point: InjectionPoint,
    /// After how many of these.
    pub after: u64,
}

/// How to open an adapter and use it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuOptions {
    /// Part of an adapter's name, backend or driver; by default the best there is.
    pub adapter: Option<String>,
    /// Whether a software adapter will do.
    pub allow_software: bool,
    /// What a dispatch should take.
    pub dispatch_target: Duration,
    /// Whether kernels carry only what the job needs; else all, to measure what that gains.
    pub specialise: bool,
    /// The hierarchy that scenes of many spheres get.
    pub hierarchy: HierarchyKind,
    /// Samples of a pixel in one dispatch, instead of as many as the target allows: to measure.
    pub samples_per_dispatch: Option<u64>,
    /// Turns of loops after which a thread puts its path aside, instead of as many as are safe: to test.
    pub turn_limit: Option<u32>,
    /// Most bytes of a film on the device at once; by default what the adapter can bind.
    pub film_limit: Option<u64>,
    /// How long the device is waited for before it is given up.
    pub patience: Duration,
    /// Breaks the device (fault injection).
    pub injection: Option<FaultInjection>,
}

impl Default for GpuOptions {
    fn default() -> Self {
        GpuOptions {
            adapter: None,
            allow_software: false,
            dispatch_target: BATCH_TARGET,
            specialise: true,
            hierarchy: HierarchyKind::default(),
            samples_per_dispatch: None,
            turn_limit: None,
            film_limit: None,
            patience: PATIENCE,
            injection: None,
        }
    }
}

impl GpuOptions {
    /// The adapter that `wanted` names, software too: whoever names it wants it. `None`: the best there is.
    pub fn of_adapter(wanted: Option<&str>) -> Self {
        GpuOptions {
            adapter: wanted.map(str::to_owned),
            allow_software: wanted.is_some(),
            ..GpuOptions::default()
        }
    }
}

/// Why there is no GPU to render on.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum GpuError {
    /// No adapter at all.
    #[error("no graphics adapter was found; install its Vulkan driver, or render on the CPU")]
    None,
    /// None of that name.
    #[error("no adapter matches \"{wanted}\"; there are: {}", available.join("; "))]
    NoMatch {
        /// Asked for.
        wanted: String,
        /// What there is.
        available: Vec<String>,
    },
    /// Only software.
    #[error("there is no GPU, only software adapters: {}; ask for one by name, or render on the CPU, which is faster", available.join("; "))]
    Software {
        /// What there is.
        available: Vec<String>,
    },
    /// Not able to run the kernel.
    #[error("{adapter} has {lacks}; choose another adapter, or render on the CPU")]
    Lacks {
        /// The adapter.
        adapter: String,
        /// What it lacks.
        lacks: String,
    },
    /// It would not open.
    #[error("{adapter} could not be opened: {reason}; choose another adapter, or render on the CPU")]
    Device {
        /// The adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
}

/// What the renderer did since it was made, for reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuReport {
    /// What the kernel in use contains.
    pub features: String,
    /// What compiling it took.
    pub compile_time: Duration,
    /// What building the hierarchy took.
    pub hierarchy_time: Duration,
    /// Dispatches so far.
    pub dispatches: u64,
    /// What they took together.
    pub dispatch_time: Duration,
    /// By what that was measured: "timestamp queries" or "wall clock".
    pub timer: &'static str,
    /// How often the film at hand was brought home.
    pub films: u64,
    /// What adding its sums took the host, all together.
    pub film_time: Duration,
}
