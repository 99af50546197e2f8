//! The small functions of the shaders that the tests run: see probe.wgsl.

use crate::common::gpu::program::{Program, Programs};
use weekender::job::render::RenderJob;
use weekender::kernel::{Features, GpuDispatch, WORKGROUP_SIZE};

/// Words of a probe's input and output.
pub const PROBE_STRIDE: usize = 18;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// `pcg4d`.
    Pcg4d,
    /// `pixel_key` and `numbers`.
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

/// The probes' names in the shader, in order.
const NAMES: [&str; 11] = [
    "PCG4D",
    "SOBOL",
    "SIN_COS",
    "ROOTS",
    "ANCHORED",
    "SURFACE",
    "SCATTER",
    "CAMERA",
    "FIXED_POINT",
    "INCIDENCE",
    "BOX",
];

/// Runs a probe on inputs of [`PROBE_STRIDE`] words each. Returns as many words of output.
pub fn run(programs: &Programs, job: &RenderJob, probe: Probe, words: &[u32]) -> Vec<u32> {
    let mut text = format!("override PROBE: u32 = 0u;\nconst PROBE_STRIDE = {PROBE_STRIDE}u;\n");
    for (number, name) in NAMES.iter().enumerate() {
        text += &format!("const PROBE_{name} = {number}u;\n");
    }
    text += include_str!("probe.wgsl");
    let features = Features { dielectric_laws: job.rules().dielectric, ..Features::default() };
    let mut overrides = features.overrides();
    overrides.push(("PROBE".to_owned(), f64::from(probe as u32)));
    let workgroups = (words.len() / PROBE_STRIDE).div_ceil(WORKGROUP_SIZE as usize) as u32;
    let program = Program { text: &text, entry_point: "probe", overrides };
    programs.run(job, &program, GpuDispatch::default(), &[0; 3], words, workgroups)
}
