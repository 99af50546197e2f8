//! `weekender compare`: whether two pictures differ by more than noise.

mod hints;
mod verdict;

pub use verdict::{Comparison, ROUNDING_BIAS, compare, half_differences};

use super::answer::{Verdict, deliver, extended};
use super::picture::Picture;
use crate::batch::{Line, aligned, lines};
use crate::cli::{CompareOptions, check_outputs};
use crate::numbers::statistics::blocks::Block;
use anyhow::{Result, bail};
use serde_json::{Value, json};
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
    let figures = figures(&sides, &comparison);
    deliver(json, &text(&comparison, &figures), 2, &figures)?;
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

const LINES: [Line; 4] = [
    ("first", &["{sides/0/name}: {sides/0/about}"]),
    ("second", &["{sides/1/name}: {sides/1/about}"]),
    (
        "difference",
        &[
            "{times_noise} x noise, from the {evidence} ({rms} RMS",
            "; noise of both {noise}",
            "), {bias}",
            " ± {bias_deviation}",
            " on average",
        ],
    ),
    (
        "blocks",
        &["{blocks} of about 8x8 pixels: sum of z^2 {excess} deviations from that of noise in R, G and B, \
           largest |z| {largest} (at most {largest_limit})"],
    ),
];

fn text(comparison: &Comparison, figures: &Value) -> String {
    let mut text = lines(figures, &LINES);
    if !comparison.is_same {
        let name = |block: &Block| format!("{},{} ({:.1})", block.x.start, block.y.start, block.largest());
        let worst: Vec<String> = comparison.test.worst(NAMED_BLOCKS).into_iter().map(name).collect();
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
fn figures(sides: &[Picture; 2], comparison: &Comparison) -> Value {
    let test = &comparison.test;
    let block = |block: &Block| {
        json!({
            "x": [block.x.start, block.x.end],
            "y": [block.y.start, block.y.end],
            "z": block.z,
            "mean_difference": block.means,
        })
    };
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
    extended(comparison, more)
}

#[cfg(test)]
mod tests;
