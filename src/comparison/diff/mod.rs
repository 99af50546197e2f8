//! `weekender diff`: shows one path as two backends trace it, side by side, and where they diverge.

mod paths;
mod side;
mod text;

pub use paths::{Difference, Pair, PathComparison};

use super::answer::{Verdict, deliver};
use crate::batch::aligned;
use crate::cli::DiffOptions;
use crate::job::render::{RenderError, RenderJob, RenderSettings};
use anyhow::Result;
use paths::radiance_amount;
use serde_json::json;
use side::Side;
use std::process::ExitCode;

/// Compares a path and prints it. Exit code 0 means that the sides agree within the tolerance and 1 that they do not,
/// so every failure, even of a backend midway, is an error of the request.
pub fn run(options: &DiffOptions) -> Result<ExitCode> {
    let DiffOptions { tolerance, json, .. } = options;
    options.check()?;
    let (scene, job) = options.job()?;
    let [a, b] = options.sides()?;
    let mut sides = [Side::open(&a)?, Side::open(&b)?];
    if sides[0].name == sides[1].name {
        sides[0].name.push_str(" (left)");
        sides[1].name.push_str(" (right)");
    }
    let found = match options.find {
        Some(samples) => find(&job, &mut sides, samples, *tolerance)?,
        None => Found { pixel: options.pixel(&job)?, sample: options.sample, searched: 0, differing: 0 },
    };
    let mut record = |side: usize| sides[side].record(&job, found.pixel, found.sample);
    let paths = [&record(0)?, &record(1)?];
    let names = [sides[0].name.as_str(), sides[1].name.as_str()];
    let pair = Pair { job: &job, names, paths, tolerance: *tolerance };
    let comparison = pair.compare();

    let text = opening(&scene, &pair, &sides, found) + "\n" + &text::text(&pair, &comparison);
    let side = |side: usize| json!({ "name": names[side], "about": sides[side].about, "path": paths[side] });
    let figures = json!({
        "scene": scene,
        "width": job.settings().width,
        "height": job.settings().height,
        "pixel": found.pixel,
        "sample": found.sample,
        "tolerance": tolerance,
        "sides": [side(0), side(1)],
        "first": comparison.first,
        "parting": comparison.parting,
        "largest": comparison.largest,
        "radiance": comparison.radiance,
        "verdict": pair.verdict(&comparison),
    });
    deliver(json.as_deref(), &text, 3, &figures)?;
    let verdict = if comparison.first.is_some() { Verdict::Different } else { Verdict::Same };
    Ok(verdict.exit_code())
}

fn opening(scene: &str, pair: &Pair, sides: &[Side; 2], found: Found) -> String {
    let RenderSettings { width, height, max_depth, sampler, seed, .. } = *pair.job.settings();
    let Found { pixel: [x, y], sample, searched, differing } = found;
    let sampler = sampler.name();
    let mut text =
        vec![("scene", format!("{scene}, {width}x{height}, depth {max_depth}, {sampler}, seed {seed}"))];
    if searched > 0 {
        let all = u64::from(width) * u64::from(height) * searched;
        let tolerance = pair.tolerance;
        text.push(("search", format!("{differing} of {all} samples differ by more than {tolerance:.0e}")));
        text.push(("again", format!("--size {width}x{height} --pixel {x},{y} --sample {sample}")));
    }
    text.push(("path", format!("pixel {x},{y}, sample {sample}")));
    text.push(("left", sides[0].about.clone()));
    text.push(("right", sides[1].about.clone()));
    aligned(&text)
}

/// The path to compare, with the result of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    /// Column and row.
    pixel: [u32; 2],
    sample: u64,
    /// Samples per pixel searched.
    searched: u64,
    /// Samples, over all pixels, that differ by more than the tolerance.
    differing: u64,
}

/// Searches samples `0 .. samples` of all pixels for the one whose radiance differs most.
fn find(job: &RenderJob, sides: &mut [Side; 2], samples: u64, tolerance: f64) -> Result<Found, RenderError> {
    let mut found = Found { pixel: [0, 0], sample: 0, searched: samples, differing: 0 };
    let mut most = 0.0;
    for sample in 0..samples {
        let [a, b] = sides;
        let films = [a.film(job, sample)?, b.film(job, sample)?];
        let width = films[0].width() as usize;
        for pixel in 0..width * films[0].height() as usize {
            let [a, b] = [0, 1].map(|side| films[side].pixel_sum(pixel).radiance());
            found.differing += u64::from(radiance_amount(a, b) > tolerance);
            let by = (0..3).map(|channel| (a[channel] - b[channel]).abs()).fold(0.0, f64::max);
            if by > most {
                most = by;
                (found.pixel, found.sample) = ([(pixel % width) as u32, (pixel / width) as u32], sample);
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests;
