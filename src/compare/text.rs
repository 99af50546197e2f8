//! A comparison in words.

use super::paired::PARTED;
use super::side::Side;
use super::verdict::{Comparison, Evidence};
use crate::statistics::blocks::SUM_DEVIATIONS;

/// The full text of a comparison.
pub fn told(sides: &[Side; 2], comparison: &Comparison) -> String {
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
    for reason in comparison.reasons.iter().chain(&comparison.unclear) {
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
        _ if comparison.unclear.is_some() => "cannot tell",
        (true, true) => "equal to the bit",
        (true, false) => "equal: they differ only by noise and rounding",
        (false, _) => "different",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{PairedSamples, compare};
    use crate::film::Film;

    #[test]
    fn every_figure_has_its_place() {
        let film = || {
            let mut film = Film::new(8, 8, 2);
            film.record(0..2, 0).unwrap();
            film
        };
        let sides = ["a", "b"].map(|name| Side::of_film(name.to_owned(), format!("film {name}"), film()));
        let mut comparison = compare(&sides[0], &sides[1], None);
        comparison.is_same = false;
        (comparison.rms, comparison.noise) = (0.03, Some(0.02));
        (comparison.bias, comparison.bias_deviation) = (-0.004, Some(0.005));
        comparison.paired = Some(PairedSamples { count: 1000, parted: 2, rms: 6e-6, bias: 7e-7 });
        comparison.test.excess = [1.0, 2.5, 0.0];
        (comparison.test.largest, comparison.test.largest_limit) = (3.25, 4.5);
        comparison.test.blocks[0].z = [0.5, -3.25, 1.0];
        comparison.notes = vec!["a note".to_owned()];
        comparison.reasons = vec!["a reason".to_owned()];
        let text = told(&sides, &comparison);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "first       a: film a",
                "second      b: film b",
                "difference  1.50 x noise (3.00e-2 RMS; noise of both 2.00e-2), -4.0e-3 ± 5.0e-3 on average",
                "samples     2 of 1000 (2.0e-3) differ by more than 1e-3: a different path; the others by 6.0e-6 RMS, \
                 +7.0e-7 on average",
                "blocks      1 of about 8x8 pixels: sum of z^2 +2.5 deviations from that of noise (at most +4), \
                 largest |z| 3.25 (at most 4.50)",
                "worst at    0,0 (3.2)",
                "note        a note",
                "because     a reason",
                "verdict     different",
            ]
        );
    }
}
