//! `weekender compare`: whether two pictures differ by more than noise.

mod hints;
mod verdict;

pub use verdict::{Comparison, ROUNDING_BIAS, compare, half_differences};

use super::answer::{Verdict, deliver};
use super::picture::Picture;
use crate::batch::aligned;
use crate::cli::{CompareOptions, check_outputs};
use crate::numbers::statistics::blocks::{Block, SUM_DEVIATIONS};
use anyhow::{Result, bail};
use serde_json::json;
use std::process::ExitCode;

/// Number of blocks named in the output.
const NAMED_BLOCKS: usize = 5;

/// Compares two pictures and prints how they differ. Exit code 0 means equal except for noise, 1 different, and 2
/// undecided or not comparable.
pub fn run(options: &CompareOptions) -> Result<ExitCode> {
    let json = options.json.as_deref();
    check_outputs([options.first.as_path(), &options.second], json)?;
    let sides =
        [Picture::read(&options.first, options.encoding)?, Picture::read(&options.second, options.encoding)?];
    let comparison = compare_sides(&sides)?;
    deliver(json, &text(&sides, &comparison), 2, &figures(&sides, &comparison))?;
    Ok(comparison.verdict().exit_code())
}

/// Compares two pictures. Fails if their sizes differ.
pub fn compare_sides(sides: &[Picture; 2]) -> Result<Comparison> {
    let [a, b] = sides;
    if (a.width, a.height) != (b.width, b.height) {
        let [a, b] = [a, b].map(|side| format!("{} has {}x{} pixels", side.name, side.width, side.height));
        bail!("{a} and {b}; render both at the same size");
    }
    let mut comparison = compare(a, b);
    let of_files =
        sides.iter().flat_map(|side| side.notes.iter().map(|note| format!("{}: {note}", side.name)));
    comparison.notes.extend(of_files);
    if comparison.verdict() == Verdict::Different {
        comparison.notes.extend(hints::hint(a, b));
    }
    Ok(comparison)
}

pub fn text(sides: &[Picture; 2], comparison: &Comparison) -> String {
    let Comparison { test, rms, bias, .. } = comparison;
    let side = |side: &Picture| format!("{}: {}", side.name, side.about);
    let mut text = vec![("first", side(&sides[0])), ("second", side(&sides[1]))];
    let measure = if comparison.noise.is_some() { "noise" } else { "noise, in blocks" };
    let noise = comparison.noise.map_or_else(String::new, |noise| format!("; noise of both {noise:.2e}"));
    let deviation = comparison.bias_deviation.map_or_else(String::new, |x| format!(" ± {x:.1e}"));
    let times = comparison.times_noise();
    text.push((
        "difference",
        format!("{times:.2} x {measure} ({rms:.2e} RMS{noise}), {bias:+.1e}{deviation} on average"),
    ));
    let blocks = format!(
        "{} of about 8x8 pixels: sum of z^2 {:+.1} deviations from that of noise (at most {SUM_DEVIATIONS:+.0}), largest |z| \
         {:.2} (at most {:.2})",
        test.blocks.len(),
        test.largest_excess(),
        test.largest,
        test.largest_limit
    );
    text.push(("blocks", blocks));
    if !comparison.is_same {
        let name = |block: &Block| format!("{},{} ({:.1})", block.x.start, block.y.start, block.largest());
        let worst: Vec<String> = test.worst(NAMED_BLOCKS).into_iter().map(name).collect();
        text.push(("worst at", worst.join("  ")));
    }
    text.extend(comparison.notes.iter().map(|note| ("note", note.clone())));
    text.extend(comparison.reasons.iter().chain(&comparison.unclear).map(|why| ("because", why.clone())));
    let verdict = match comparison.verdict() {
        Verdict::Same if comparison.is_same => "equal to the bit",
        Verdict::Same => "equal: they differ only by noise and rounding",
        Verdict::Different => "different",
        Verdict::Unclear => "cannot tell",
    };
    text.push(("verdict", verdict.to_owned()));
    aligned(&text)
}

/// The comparison as JSON.
fn figures(sides: &[Picture; 2], comparison: &Comparison) -> serde_json::Value {
    let test = &comparison.test;
    let block = |block: &Block| {
        json!({
            "x": [block.x.start, block.x.end],
            "y": [block.y.start, block.y.end],
            "z": block.z,
            "mean_difference": block.means,
        })
    };
    let mut figures = json!(comparison);
    let more = json!({
        "sides": sides.each_ref().map(|side| json!({ "name": side.name, "about": side.about })),
        "width": sides[0].width,
        "height": sides[0].height,
        "is_equal": comparison.is_equal(),
        "times_noise": comparison.times_noise(),
        "evidence": if comparison.noise.is_some() { "halves" } else { "spread" },
        "blocks": test.blocks.len(),
        "known_blocks": test.counts,
        "sums_of_squares": test.sums,
        "excess": test.excess,
        "largest": test.largest,
        "largest_limit": test.largest_limit,
        "worst_blocks": test.worst(NAMED_BLOCKS).into_iter().map(block).collect::<Vec<_>>(),
    });
    if let (Some(figures), serde_json::Value::Object(more)) = (figures.as_object_mut(), more) {
        figures.extend(more);
    }
    figures
}

#[cfg(test)]
mod tests;
