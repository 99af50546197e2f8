//! The shaders' text: constants that live in Rust, then the files in the order in which they use each other.

use super::layout::{ASIDE_STRIDE, ROOTS_MASK, UNDER_EYE, UNIFORM_ANCHORED, UNIFORM_SPHERES, WORKGROUP_SIZE};
use super::overrides::{Constant, Overrides};
use crate::film::{FIXED_POINT_MAX, FIXED_POINT_SCALE, RADIANCE_LIMIT};
use crate::sampling::{GOLDEN_RATIO, LENS_BLOCK, sine_coefficients};
use crate::stages::{DielectricLaws, Shading, Transfer};
use crate::tables::hierarchy::{self, COUNT_MASK, LEAST_COMPONENT, ROUNDING_UNITS};
use crate::tables::{EYE, NEAR_ZERO, NONE, Roots, cwbvh};
use std::fmt::Write;

/// Nodes that a traversal can have set aside: one a level.
pub const STACK_SIZE: usize = hierarchy::DEPTH_LIMIT;

/// The same for a compressed hierarchy.
pub const CWBVH_STACK_SIZE: usize = cwbvh::DEPTH_LIMIT;

/// Words of a probe's input and output.
pub const PROBE_STRIDE: usize = 16;

/// Words before the rays of a recorded path.
pub const RECORD_HEADER: usize = 4;

/// Words of a recorded ray.
pub const RECORD_STRIDE: usize = 12;

/// An entry point and what it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EntryPoint {
    /// Traces samples.
    PathTrace,
    /// Makes a picture of the film.
    Resolve,
    /// Runs small functions for tests.
    Probe,
    /// Traces one sample of one pixel and writes it down.
    PathRecord,
}

impl EntryPoint {
    /// All of them.
    pub const ALL: [EntryPoint; 4] =
        [EntryPoint::PathTrace, EntryPoint::Resolve, EntryPoint::Probe, EntryPoint::PathRecord];

    /// Its name in the shader.
    pub fn name(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => "path_trace",
            EntryPoint::Resolve => "resolve",
            EntryPoint::Probe => "probe",
            EntryPoint::PathRecord => "path_record",
        }
    }

    fn text(self) -> &'static str {
        match self {
            EntryPoint::PathTrace => include_str!("../../shaders/path_trace.wgsl"),
            EntryPoint::Resolve => include_str!("../../shaders/resolve.wgsl"),
            EntryPoint::Probe => include_str!("../../shaders/probe.wgsl"),
            EntryPoint::PathRecord => include_str!("../../shaders/path_record.wgsl"),
        }
    }
}

/// The functions and bindings that all entry points share.
const SHARED: [&str; 11] = [
    include_str!("../../shaders/lanes.wgsl"),
    include_str!("../../shaders/rng.wgsl"),
    include_str!("../../shaders/camera.wgsl"),
    include_str!("../../shaders/sphere.wgsl"),
    include_str!("../../shaders/bvh.wgsl"),
    include_str!("../../shaders/cwbvh.wgsl"),
    include_str!("../../shaders/bindings.wgsl"),
    include_str!("../../shaders/material.wgsl"),
    include_str!("../../shaders/path.wgsl"),
    include_str!("../../shaders/aside.wgsl"),
    include_str!("../../shaders/record.wgsl"),
];

/// The small functions that the probe can run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// `pcg4d`.
    Pcg4d,
    /// `pixel_key`, `stream_of`, `lens_stream_of` and `sobol_pair`.
    Sobol,
    /// `unit_float` and `sin_cos_turns`.
    SinCos,
    /// `near_root`, `nearest_root`, `book_root` and `signed_root`.
    Roots,
    /// `anchored_root` and `anchored_surface_point`.
    Anchored,
    /// `surface_point` and `speck_surface_point`.
    Surface,
    /// `scatter`, `reflectance` and `refracted`.
    Scatter,
    /// `screen`, `pinhole_ray` and `lens_ray`.
    Camera,
    /// `fixed_point` and `wide_sum`.
    FixedPoint,
}

impl Probe {
    const ALL: [(&'static str, Probe); 9] = [
        ("PROBE_PCG4D", Probe::Pcg4d),
        ("PROBE_SOBOL", Probe::Sobol),
        ("PROBE_SIN_COS", Probe::SinCos),
        ("PROBE_ROOTS", Probe::Roots),
        ("PROBE_ANCHORED", Probe::Anchored),
        ("PROBE_SURFACE", Probe::Surface),
        ("PROBE_SCATTER", Probe::Scatter),
        ("PROBE_CAMERA", Probe::Camera),
        ("PROBE_FIXED_POINT", Probe::FixedPoint),
    ];
}

/// What the shader calls a way of shading.
pub fn shading_tag(shading: Shading) -> u32 {
    shading as u32
}

/// What the shader calls the laws of glass.
pub fn laws_tag(laws: DielectricLaws) -> u32 {
    laws as u32
}

/// What the shader calls a transfer.
pub fn transfer_tag(transfer: Transfer) -> u32 {
    transfer as u32
}

/// Constants, tags and overrides as WGSL.
pub fn prelude() -> String {
    let mut text = String::new();
    let mut unsigned = |name: &str, value: u32| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "const {name} = {value:#x}u;");
    };
    unsigned("WORKGROUP_SIZE", WORKGROUP_SIZE);
    unsigned("UNIFORM_SPHERES", UNIFORM_SPHERES as u32);
    unsigned("UNIFORM_ANCHORED", UNIFORM_ANCHORED as u32);
    unsigned("STACK_SIZE", STACK_SIZE as u32);
    unsigned("CWBVH_STACK_SIZE", CWBVH_STACK_SIZE as u32);
    unsigned("ASIDE_STRIDE", ASIDE_STRIDE);
    unsigned("PROBE_STRIDE", PROBE_STRIDE as u32);
    unsigned("RECORD_HEADER", RECORD_HEADER as u32);
    unsigned("RECORD_STRIDE", RECORD_STRIDE as u32);
    unsigned("NONE", NONE);
    unsigned("EYE", EYE);
    unsigned("ROOTS_NEARER", Roots::Nearer as u32);
    unsigned("ROOTS_FARTHER", Roots::Farther as u32);
    unsigned("ROOTS_MASK", ROOTS_MASK);
    unsigned("UNDER_EYE", UNDER_EYE);
    unsigned("COUNT_MASK", COUNT_MASK);
    unsigned("GOLDEN_RATIO", GOLDEN_RATIO);
    unsigned("LENS_BLOCK", LENS_BLOCK);
    unsigned("INFINITE_KEY", f32::INFINITY.to_bits());
    unsigned("MISS_KEY", u32::MAX);
    unsigned("NEGATIVE_ZERO_BITS", (-0.0_f32).to_bits());
    unsigned("RADIANCE_TOTAL_LIMIT_BITS", ((3.0 * RADIANCE_LIMIT * FIXED_POINT_SCALE) as f32).to_bits());
    for shading in [Shading::ImageGradient, Shading::FirstHitRed, Shading::Normals, Shading::Path] {
        let name = match shading {
            Shading::ImageGradient => "SHADING_IMAGE_GRADIENT",
            Shading::FirstHitRed => "SHADING_FIRST_HIT_RED",
            Shading::Normals => "SHADING_NORMALS",
            Shading::Path => "SHADING_PATH",
        };
        unsigned(name, shading_tag(shading));
    }
    unsigned("LAWS_REFRACT_ONLY", laws_tag(DielectricLaws::RefractOnly));
    unsigned("LAWS_SCHLICK", laws_tag(DielectricLaws::Schlick));
    unsigned("TRANSFER_GAMMA2", transfer_tag(Transfer::Gamma2));
    unsigned("TRANSFER_LINEAR_ABOVE_GAMMA2", transfer_tag(Transfer::LinearAboveGamma2));
    for (name, probe) in Probe::ALL {
        unsigned(name, probe as u32);
    }
    let mut float = |name: &str, value: f64| {
        let _ = writeln!(text, "const {name} = {:?}f;", value as f32);
    };
    float("UNIT_FLOAT_SCALE", 1.0 / 16_777_216.0);
    float("FIXED_POINT_SCALE", FIXED_POINT_SCALE);
    float("FIXED_POINT_MAX", f64::from(FIXED_POINT_MAX));
    float("NEAR_ZERO", NEAR_ZERO);
    float("LEAST_COMPONENT", LEAST_COMPONENT);
    float("BOX_MARGIN", ROUNDING_UNITS * f64::from(f32::EPSILON) / 2.0);
    float("CWBVH_MARGIN", cwbvh::ROUNDING_UNITS * f64::from(f32::EPSILON) / 2.0);
    float("BOX_WIDENING", 1.0 + 4.0 * f64::from(f32::EPSILON));
    for (index, coefficient) in sine_coefficients().into_iter().enumerate() {
        float(&format!("SINE_{index}"), coefficient);
    }
    for (name, value) in Overrides::default().constants() {
        let _ = match value {
            Constant::Flag(flag) => writeln!(text, "override {name}: bool = {flag};"),
            Constant::Number(number) => writeln!(text, "override {name}: u32 = {number}u;"),
            Constant::Real(real) => writeln!(text, "override {name}: f32 = {real:?}f;"),
        };
    }
    text.push_str("override PROBE: u32 = 0u;\noverride RECORD: bool = false;\n");
    text
}

/// The whole text of a shader.
pub fn source(entry_point: EntryPoint) -> String {
    let mut text = prelude();
    for part in SHARED.into_iter().chain([entry_point.text()]) {
        text.push('\n');
        text.push_str(part);
    }
    text
}
