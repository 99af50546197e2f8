//! `weekender compare`: whether two pictures are the same except for noise.

mod bounds;
mod heat_map;
mod non_finite;
mod paired;
mod side;
mod sparse;
#[cfg(test)]
mod tests;
mod text;
mod variances;
mod verdict;

pub use non_finite::NonFinite;
pub use paired::{PairedSamples, PairedSums};
pub use side::Side;
pub use text::told;
pub use verdict::{Comparison, Evidence, ROUNDING_BIAS, compare};

use crate::cli::{CompareOptions, JsonTarget};
use crate::failure::{BAD_INPUT, Failure};
use crate::files::{check_writable, replace_file};
use crate::recipe::Recipe;
use crate::render::RenderSettings;
use crate::terminal::{print_beside, write_json};
use anyhow::{Result, bail};
use serde::Serialize;
use side::{OpenedSide, Rendering, check_memory, new_film};
use std::process::ExitCode;

/// Version of the JSON. It grows when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// Number of blocks that the output names.
const NAMED_BLOCKS: usize = 5;

#[derive(Serialize)]
struct ComparisonJson {
    schema: u32,
    version: &'static str,
    sides: [SideJson; 2],
    width: u32,
    height: u32,
    is_equal: bool,
    is_same: bool,
    times_noise: f64,
    rms: f64,
    bias: f64,
    bias_deviation: Option<f64>,
    noise: Option<f64>,
    evidence: Evidence,
    blocks: usize,
    known_blocks: [usize; 3],
    sums_of_squares: [f64; 3],
    excess: [f64; 3],
    largest: f64,
    largest_limit: f64,
    left_out: usize,
    non_finite: NonFinite,
    worst_blocks: Vec<BlockJson>,
    paired_samples: Option<PairedSamples>,
    reasons: Vec<String>,
    unclear: Option<String>,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct SideJson {
    name: String,
    about: String,
}

#[derive(Serialize)]
struct BlockJson {
    x: [u32; 2],
    y: [u32; 2],
    z: [f64; 3],
    mean_difference: [f64; 3],
}

/// Compares two pictures and prints how they differ. The exit code is 0 if they differ only by noise, 1 if by more, and 2
/// if that cannot be told.
///
/// # Errors
/// [`Failure::Input`] if they cannot be compared, because exit code 1 means that they differ.
pub fn run(options: &CompareOptions) -> Result<ExitCode, Failure> {
    compared(options).map_err(Failure::Input)
}

fn compared(options: &CompareOptions) -> Result<ExitCode> {
    let json = match &options.json {
        Some(JsonTarget::File(path)) => Some(path),
        _ => None,
    };
    for path in [json, options.heat_map.as_ref()].into_iter().flatten() {
        check_writable(path)?;
    }
    let (sides, paired) = sides(options)?;
    let comparison = compare_sides(&sides, paired)?;
    let text = text::told(&sides, &comparison);
    print_beside(options.json.as_ref(), &text)?;
    let [a, b] = &sides;
    if let Some(path) = &options.heat_map {
        replace_file(path, |writer| heat_map::write(a, b, &comparison.test, writer))?;
    }
    if let Some(target) = &options.json {
        write_json(&comparison_json(&sides, &comparison), target)?;
    }
    Ok(match (comparison.is_equal(), &comparison.unclear) {
        (true, _) => ExitCode::SUCCESS,
        (false, None) => ExitCode::FAILURE,
        (false, Some(_)) => ExitCode::from(BAD_INPUT),
    })
}

/// Compares two pictures, with a note on their jobs if that explains the result.
///
/// # Errors
/// If their sizes differ.
pub fn compare_sides(sides: &[Side; 2], paired: Option<PairedSamples>) -> Result<Comparison> {
    let [a, b] = sides;
    if (a.width, a.height) != (b.width, b.height) {
        bail!(
            "{} has {}x{} pixels and {} has {}x{}; render both at the same size",
            a.name,
            a.width,
            a.height,
            b.name,
            b.width,
            b.height
        );
    }
    let mut comparison = compare(a, b, paired);
    comparison.notes.extend(note_on_jobs(a, b));
    Ok(comparison)
}

/// Both sides. If backends render both, also their comparison sample by sample.
fn sides(options: &CompareOptions) -> Result<([Side; 2], Option<PairedSamples>)> {
    let [first, second] = &options.sides;
    let open = |side| OpenedSide::open(side, options.encoding);
    Ok(match (open(first)?, open(second)?) {
        (OpenedSide::Read(a), OpenedSide::Read(b)) => ([*a, *b], None),
        (OpenedSide::Read(a), OpenedSide::Backend(mut b)) => {
            let b = beside(options, &a, &mut b)?;
            ([*a, b], None)
        }
        (OpenedSide::Backend(mut a), OpenedSide::Read(b)) => {
            let a = beside(options, &b, &mut a)?;
            ([a, *b], None)
        }
        (OpenedSide::Backend(mut a), OpenedSide::Backend(mut b)) => {
            let recipe = options.recipe.clone();
            let (sides, paired) =
                both(&recipe, options.samples.unwrap_or(recipe.samples_per_pixel), &mut a, &mut b)?;
            (sides, Some(paired))
        }
    })
}

/// Renders the counterpart of `read` at its size, and with the same samples if `read` is a film of the same job.
fn beside(options: &CompareOptions, read: &Side, rendering: &mut Rendering) -> Result<Side> {
    let mut recipe = options.recipe.clone();
    (recipe.settings.width, recipe.settings.height) = (read.width, read.height);
    let job = recipe.job()?;
    job.check_memory(2)?;
    check_memory(read.width, read.height, 2)?;
    match (&read.film, &read.job) {
        (Some(film), Some(other)) if *other == job && options.samples.is_none() => {
            rendering.render(&recipe, &job, film.samples().iter())
        }
        _ => {
            let of_film = read.film.as_ref().map(|film| film.sample_count());
            let samples = options.samples.or(of_film).unwrap_or(recipe.samples_per_pixel);
            rendering.render(&recipe, &job, std::iter::once(0..samples))
        }
    }
}

/// Renders the same samples with both backends.
fn both(
    recipe: &Recipe,
    samples: u64,
    a: &mut Rendering,
    b: &mut Rendering,
) -> Result<([Side; 2], PairedSamples)> {
    let job = recipe.job()?;
    let RenderSettings { width, height, .. } = *job.settings();
    // Two films of all samples, and two of the last sample.
    job.check_memory(4)?;
    check_memory(width, height, 4)?;
    let (mut film_a, mut film_b) = (new_film(&job)?, new_film(&job)?);
    let mut sums = PairedSums::default();
    for index in 0..samples {
        let (sample_a, sample_b) = (a.sample(&job, index)?, b.sample(&job, index)?);
        sums.add(&sample_a, &sample_b);
        film_a.merge(&sample_a)?;
        film_b.merge(&sample_b)?;
    }
    let mut sides = [a.side(recipe, &job, film_a), b.side(recipe, &job, film_b)];
    if sides[0].name == sides[1].name {
        sides[0].name.push_str(" (first)");
        sides[1].name.push_str(" (second)");
    }
    Ok((sides, sums.finish()))
}

/// A note on the jobs of the pictures, if they explain the result.
fn note_on_jobs(a: &Side, b: &Side) -> Option<String> {
    let (job_a, job_b) = (a.job.as_ref()?, b.job.as_ref()?);
    let (film_a, film_b) = (a.film.as_ref()?, b.film.as_ref()?);
    if job_a == job_b {
        let is_paired = film_a.samples() == film_b.samples();
        return is_paired
            .then(|| "both hold the same samples, so they can differ only by rounding".to_owned());
    }
    let is_other_picture =
        job_a.scene() != job_b.scene() || job_a.camera() != job_b.camera() || job_a.rules() != job_b.rules();
    is_other_picture.then(|| {
        "the recipes differ in scene, camera or rules: these should be different pictures".to_owned()
    })
}

fn comparison_json(sides: &[Side; 2], comparison: &Comparison) -> ComparisonJson {
    let side = |side: &Side| SideJson { name: side.name.clone(), about: side.about.clone() };
    let test = &comparison.test;
    ComparisonJson {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION"),
        sides: [side(&sides[0]), side(&sides[1])],
        width: sides[0].width,
        height: sides[0].height,
        is_equal: comparison.is_equal(),
        is_same: comparison.is_same,
        times_noise: comparison.times_noise(),
        rms: comparison.rms,
        bias: comparison.bias,
        bias_deviation: comparison.bias_deviation,
        noise: comparison.noise,
        evidence: comparison.evidence,
        blocks: test.blocks.len(),
        known_blocks: test.counts,
        sums_of_squares: test.sums,
        excess: test.excess,
        largest: test.largest,
        largest_limit: test.largest_limit,
        left_out: comparison.left_out,
        non_finite: comparison.non_finite,
        worst_blocks: test
            .worst(NAMED_BLOCKS)
            .into_iter()
            .map(|block| BlockJson {
                x: [block.x.start, block.x.end],
                y: [block.y.start, block.y.end],
                z: block.z,
                mean_difference: block.means,
            })
            .collect(),
        paired_samples: comparison.paired,
        reasons: comparison.reasons.clone(),
        unclear: comparison.unclear.clone(),
        notes: comparison.notes.clone(),
    }
}
