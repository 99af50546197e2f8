//! Logarithmic axes: ticks and their labels.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// A logarithmic axis; values must be above 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Smallest and largest value. If they span no range, as in a chart without points, the axis gets an arbitrary one.
    pub limits: [f64; 2],
}

/// Approximate number of ticks per axis.
const TICKS: f64 = 6.0;

/// A laid-out axis; a position is the logarithm of a value.
#[derive(Clone)]
pub(super) struct Ruler {
    /// Positions of the ends.
    pub range: Range<f64>,
    /// Positions of labelled ticks.
    ticks: Vec<f64>,
    /// Positions of the fine grid lines.
    fine_ticks: Vec<f64>,
}

impl Axis {
    pub(super) fn ruler(&self) -> Ruler {
        let range = match self.limits.map(position) {
            [Some(low), Some(high)] if low < high => low..high,
            _ => 0.0..1.0,
        };
        let (ticks, fine_ticks) = log_ticks(&range);
        Ruler { range, ticks, fine_ticks }
    }
}

impl Ranged for Ruler {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, position: &f64, (low, high): (i32, i32)) -> i32 {
        let share = (position - self.range.start) / (self.range.end - self.range.start);
        low + (share * f64::from(high - low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { self.fine_ticks.clone() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Ruler {
    fn format_ext(&self, position: &f64) -> String {
        label(10_f64.powf(*position))
    }
}

/// Position of a value; `None` if the axis cannot show it.
pub(super) fn position(value: f64) -> Option<f64> {
    Some(value.log10()).filter(|position| position.is_finite())
}

/// Ticks at powers of ten and, if these are few, at 2 and 5 times them; fine ticks at every digit.
fn log_ticks(range: &Range<f64>) -> (Vec<f64>, Vec<f64>) {
    let at = |digits: &[u32]| -> Vec<f64> {
        (range.start.floor() as i32..=range.end.ceil() as i32)
            .flat_map(|power| digits.iter().map(move |digit| f64::from(power) + f64::from(*digit).log10()))
            .filter(|position| (range.start - 1e-9..=range.end + 1e-9).contains(position))
            .collect()
    };
    let powers = at(&[1]);
    let ticks = match powers.len() {
        0 | 1 => at(&[1, 2, 3, 5, 7]),
        2 => at(&[1, 2, 5]),
        count if count as f64 > 2.0 * TICKS => powers.into_iter().step_by(2).collect(),
        _ => powers,
    };
    let fine = if range.end - range.start > 8.0 { Vec::new() } else { at(&[2, 3, 4, 5, 6, 7, 8, 9]) };
    (ticks, fine)
}

/// At most seven digits, without trailing zeros.
pub(super) fn label(value: f64) -> String {
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}
