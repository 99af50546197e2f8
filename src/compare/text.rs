//! A comparison in words.

use super::paired::PARTED;
use super::side::Side;
use super::verdict::{Comparison, Evidence};
use crate::statistics::blocks::SUM_DEVIATIONS;

/// The full text of a comparison.
pub(super) fn told(sides: &[Side; 2], comparison: &Comparison) -> String {
    let mut text = String::new();
    let mut line = |label: &str, content: &str| text.push_str(&format!("{label:<11} {content}\n"));
    line("first", &format!("{}: {}", sides[0].name, sides[0].about));
    line("second", &format!("{}: {}", sides[1].name, sides[1].about));
    line("difference", &difference(comparison));
    if let Some(paired) = &comparison.paired {
        line(
            "samples",
            &format!(
                "{} of {} ({:.1e}) differ by more than {PARTED:.0e}: a different path; the others by {:.1e} RMS, {:+.1e} on average",
                paired.parted,
                paired.count,
                paired.parted_share(),
                paired.rms,
                paired.bias
            ),
        );
    }
    let test = &comparison.test;
    line(
        "blocks",
        &format!(
            "{} of about 8x8 pixels: sum of z^2 {:+.1} deviations from that of noise (at most {SUM_DEVIATIONS:+.0}), largest |z| {:.2} (at most {:.2})",
            test.blocks.len(),
            test.largest_excess(),
            test.largest,
            test.largest_limit
        ),
    );
    if !comparison.is_same {
        let worst: Vec<String> = test
            .worst(super::NAMED_BLOCKS)
            .iter()
            .map(|b| format!("{},{} ({:.1})", b.x.start, b.y.start, b.largest()))
            .collect();
        line("worst at", &worst.join("  "));
    }
    for note in &comparison.notes {
        line("note", note);
    }
    for reason in &comparison.reasons {
        line("because", reason);
    }
    line("verdict", verdict(comparison));
    text
}

fn difference(comparison: &Comparison) -> String {
    let of = match comparison.evidence {
        Evidence::Halves => "noise",
        Evidence::Spread => "noise, in blocks",
    };
    let noise = comparison.noise.map_or_else(String::new, |noise| format!("; noise of both {noise:.2e}"));
    let deviation = comparison.bias_deviation.map_or_else(String::new, |x| format!(" ± {x:.1e}"));
    format!(
        "{:.2} x {of} ({:.2e} RMS{noise}), {:+.1e}{deviation} on average",
        comparison.times_noise(),
        comparison.rms,
        comparison.bias
    )
}

fn verdict(comparison: &Comparison) -> &'static str {
    match (comparison.is_equal(), comparison.is_same) {
        (true, true) => "equal to the bit",
        (true, false) => "equal: they differ only by noise and rounding",
        (false, _) => "different",
    }
}
