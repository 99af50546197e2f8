//! The text of the shaders: the declarations from Rust, then the files in order of use.

use crate::kernel::{self, tags};

/// An entry point of the shaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EntryPoint {
    /// Traces samples.
    PathTrace,
    /// Converts the film to a picture.
    Resolve,
    /// Runs small functions, for tests.
    Probe,
    /// Traces one sample of one pixel and records it.
    PathRecord,
}

impl EntryPoint {
    /// All entry points.
    pub const ALL: [EntryPoint; 4] =
        [EntryPoint::PathTrace, EntryPoint::Resolve, EntryPoint::Probe, EntryPoint::PathRecord];

    /// The entry point's name in the shader.
    pub fn name(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => "path_trace",
            EntryPoint::Resolve => "resolve",
            EntryPoint::Probe => "probe",
            EntryPoint::PathRecord => "path_record",
        }
    }

    /// The text that only this entry point has; [`shared`] comes before it.
    pub fn text(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => include_str!("../../shaders/path_trace.wgsl"),
            EntryPoint::Resolve => include_str!("../../shaders/resolve.wgsl"),
            EntryPoint::Probe => include_str!("../../shaders/probe.wgsl"),
            EntryPoint::PathRecord => include_str!("../../shaders/path_record.wgsl"),
        }
    }
}

/// The files with functions and bindings that all entry points share.
const SHARED: [&str; 10] = [
    include_str!("../../shaders/lanes.wgsl"),
    include_str!("../../shaders/rng.wgsl"),
    include_str!("../../shaders/camera.wgsl"),
    include_str!("../../shaders/sphere.wgsl"),
    include_str!("../../shaders/bvh.wgsl"),
    include_str!("../../shaders/bindings.wgsl"),
    include_str!("../../shaders/material.wgsl"),
    include_str!("../../shaders/path.wgsl"),
    include_str!("../../shaders/aside.wgsl"),
    include_str!("../../shaders/record.wgsl"),
];

/// The small functions that the probe can run for tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// `pcg4d`.
    Pcg4d,
    /// `pixel_key` and `numbers` of the Sobol sampler.
    Sobol,
    /// `unit_float` and `sin_cos_turns`.
    SinCos,
    /// `near_root`, `nearest_root`, `book_root`, `signed_root` and `chord_end`.
    Roots,
    /// `anchored_root` and `anchored_surface_point`.
    Anchored,
    /// `surface_point` and `speck_surface_point`.
    Surface,
    /// `scatter`, `reflectance` and `refracted`.
    Scatter,
    /// `screen`, `pinhole_ray` and `lens_ray`.
    Camera,
    /// `fixed_point`.
    FixedPoint,
    /// `incidence_of`, `incidence_of_sine2`, `hemisphere` and `strip_reflectance`.
    Incidence,
    /// `slabs_of`, `slope_of` and `hit_bits`.
    Box,
}

tags::tags!(Probe {
    Pcg4d = "PROBE_PCG4D",
    Sobol = "PROBE_SOBOL",
    SinCos = "PROBE_SIN_COS",
    Roots = "PROBE_ROOTS",
    Anchored = "PROBE_ANCHORED",
    Surface = "PROBE_SURFACE",
    Scatter = "PROBE_SCATTER",
    Camera = "PROBE_CAMERA",
    FixedPoint = "PROBE_FIXED_POINT",
    Incidence = "PROBE_INCIDENCE",
    Box = "PROBE_BOX",
});

/// The declarations from Rust, as WGSL.
pub fn prelude() -> String {
    let own = "override PROBE: u32 = 0u;\noverride RECORD: bool = false;\n";
    [kernel::wgsl(), tags::values::<Probe>(), own.to_owned()].join("\n")
}

/// The text that all entry points begin with: the declarations from Rust, functions and bindings.
pub fn shared() -> String {
    SHARED.into_iter().fold(prelude(), |text, part| text + "\n" + part) + "\n"
}

/// The complete text of a shader.
pub fn source(entry_point: EntryPoint) -> String {
    shared() + entry_point.text()
}
