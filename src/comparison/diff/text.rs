//! Two paths side by side.

use super::paths::{Difference, Pair, PathComparison, Row, vector};

const WIDTH: usize = 78;

const LABEL: usize = 13;

const COLUMN: usize = 31;

/// All rays of both paths with the first difference marked, both radiances, their difference, and the verdict.
pub fn text(pair: &Pair, comparison: &PathComparison) -> String {
    let [a, b] = pair.names.map(|name| cut(name, COLUMN));
    let mut lines = vec![format!("{:LABEL$}{a:COLUMN$}   {b}", "")];
    for index in 0..pair.rays() {
        let from = if index == 0 { " from the camera" } else { "" };
        lines.push(format!("{:─<WIDTH$}", format!("ray {}{from} ", index + 1)));
        lines.extend(pair.rows(index).iter().flat_map(|row| lines_of(row, index, pair, comparison)));
    }
    lines.extend(closing(pair, comparison));
    lines.iter().map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// A quantity on both sides, followed by a sentence at the first difference and where the paths diverge.
fn lines_of(row: &Row, index: usize, pair: &Pair, comparison: &PathComparison) -> Vec<String> {
    let sign = match &row.values {
        [None, None] => return Vec::new(),
        [Some(_), Some(_)] => sign(row.amount, pair.tolerance),
        // The other side's object row explains the missing value.
        _ => " ",
    };
    let is_here = |found: &Difference| (found.ray, found.quantity) == (index, row.label);
    let marked = [comparison.first, comparison.parting].into_iter().flatten().find(is_here);
    let mark = if marked.is_some() { "▶" } else { " " };
    let [a, b] = row.values.each_ref().map(|value| cut(value.as_deref().unwrap_or_default(), COLUMN));
    let line = format!("{mark} {:width$}{a:COLUMN$} {sign} {b}", row.label, width = LABEL - 2);
    let sentence = marked.map(|difference| format!("    {}", pair.sentence(&difference)));
    std::iter::once(line).chain(sentence).collect()
}

fn closing(pair: &Pair, comparison: &PathComparison) -> Vec<String> {
    let [a, b] = pair.paths.map(|path| path.radiance);
    let by = vector([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
    let sign = sign(comparison.radiance, pair.tolerance);
    let share = match comparison.radiance {
        0.0 => "0 of the larger".to_owned(),
        share if share < 1e-3 => format!("{share:.1e} of the larger"),
        share => format!("{:.1} % of the larger", 100.0 * share),
    };
    vec![
        "─".repeat(WIDTH),
        format!("{:LABEL$}{:COLUMN$} {sign} {}", "radiance", vector(a), vector(b)),
        format!("{:LABEL$}{by:COLUMN$}   {share}", "difference"),
        format!("{:LABEL$}{}", "verdict", pair.verdict(comparison)),
    ]
}

/// A mark for bit-identical, within tolerance, or different.
fn sign(difference: f64, tolerance: f64) -> &'static str {
    match difference {
        0.0 => "=",
        difference if difference <= tolerance => "≈",
        _ => "≠",
    }
}

fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    text.chars().take(width - 1).chain(['…']).collect()
}
