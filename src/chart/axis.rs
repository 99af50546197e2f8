//! Axes: scales, ticks and their labels.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// How values are spaced along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences have equal distances.
    Linear,
    /// Equal ratios have equal distances; values must be above 0.
    Log,
}

/// An axis of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What the axis shows, with the unit.
    pub label: String,
    /// How values are spaced.
    pub scale: Scale,
    /// Smallest and largest value; with `None`, the points determine them.
    pub limits: Option<[f64; 2]>,
}

/// Margin beyond the outermost points, as a fraction of the axis.
const MARGIN: f64 = 0.04;

/// Approximate number of ticks per axis.
const TICKS: f64 = 6.0;

/// An axis laid out: it maps values to positions on a linear scale.
#[derive(Clone)]
pub(super) struct Ruler {
    scale: Scale,
    /// Positions of the two ends.
    pub range: Range<f64>,
    /// Positions of ticks with labels.
    pub ticks: Vec<f64>,
    /// Positions of the fine grid lines.
    fine_ticks: Vec<f64>,
}

impl Axis {
    /// An axis whose limits the points determine.
    pub fn new(label: impl Into<String>, scale: Scale) -> Self {
        Axis { label: label.into(), scale, limits: None }
    }

    /// Lays the axis out for these values.
    pub(super) fn ruler(&self, values: impl Iterator<Item = f64>) -> Ruler {
        let place = |value: f64| position(self.scale, value);
        let ends = match self.limits {
            Some(limits) => limits.map(place).into_iter().flatten().collect(),
            None => values.filter_map(place).collect::<Vec<f64>>(),
        };
        let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let range = match (self.limits, low < high) {
            (Some(_), true) => low..high,
            (None, true) => low - MARGIN * (high - low)..high + MARGIN * (high - low),
            _ if low.is_finite() => low - 0.5..low + 0.5,
            _ => 0.0..1.0,
        };
        let (ticks, fine_ticks) = match self.scale {
            Scale::Linear => (linear_ticks(&range), Vec::new()),
            Scale::Log => log_ticks(&range),
        };
        Ruler { scale: self.scale, range, ticks, fine_ticks }
    }
}

impl Ruler {
    /// Position of a value; `None` if the axis cannot show it.
    pub fn position(&self, value: f64) -> Option<f64> {
        position(self.scale, value)
    }

    /// The label of a position.
    pub fn text(&self, position: f64) -> String {
        match self.scale {
            Scale::Linear => plain_text(position),
            Scale::Log => power_text(position),
        }
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
        self.text(*position)
    }
}

fn position(scale: Scale, value: f64) -> Option<f64> {
    let position = match scale {
        Scale::Linear => value,
        Scale::Log => value.log10(),
    };
    position.is_finite().then_some(position)
}

fn linear_ticks(range: &Range<f64>) -> Vec<f64> {
    let rough = (range.end - range.start) / TICKS;
    let unit = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * unit).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(10.0 * unit);
    let numbers = (range.start / step).ceil() as i64..=(range.end / step).floor() as i64;
    numbers.map(|number| number as f64 * step).collect()
}

/// Ticks at powers of ten or, if there are few of these, also at 2 and 5 times them; fine ticks at every digit.
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

/// A number without trailing zeros.
fn plain_text(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e7).contains(&size) => {
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", power_text(size.log10()))
        }
        _ => {
            let text = format!("{value:.6}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

/// `10^position` as a label: 1e-5, 0.01, 50, 10⁶, 2·10⁶. The font has no superscript minus.
fn power_text(position: f64) -> String {
    let power = (position + 1e-9).floor();
    let digit = 10_f64.powf(position - power).round();
    if (-3.0..4.0).contains(&power) {
        return plain_text(digit * 10_f64.powf(power));
    }
    if power < 0.0 {
        return format!("{digit}e{power:.0}");
    }
    let exponent: String = format!("{power:.0}").chars().map(superscript).collect();
    if digit == 1.0 { format!("10{exponent}") } else { format!("{digit}·10{exponent}") }
}

fn superscript(c: char) -> char {
    match c {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => digit.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(digit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, limits: [f64; 2]) -> Vec<String> {
        let ruler = Axis { limits: Some(limits), ..Axis::new("", scale) }.ruler(std::iter::empty());
        ruler.ticks.iter().map(|tick| ruler.text(*tick)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_within_the_axis() {
        assert_eq!(labels(Scale::Linear, [0.0, 137.0]), ["0", "50", "100"]);
        assert_eq!(labels(Scale::Linear, [-0.1, 0.31]), ["-0.1", "0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(Scale::Log, [1e3, 1e7]), ["1000", "10⁴", "10⁵", "10⁶", "10⁷"]);
        assert_eq!(labels(Scale::Log, [3.0, 60.0]), ["3", "5", "7", "10", "20", "30", "50"]);
        assert_eq!(labels(Scale::Log, [1e-5, 0.1]), ["1e-5", "1e-4", "0.001", "0.01", "0.1"]);
        assert_eq!(labels(Scale::Log, [1e5, 1e6]), ["10⁵", "2·10⁵", "5·10⁵", "10⁶"]);
    }

    #[test]
    fn fine_lines_stand_at_every_digit_unless_there_would_be_too_many() {
        let fine = |scale, limits| {
            let axis = Axis { limits: Some(limits), ..Axis::new("", scale) };
            axis.ruler(std::iter::empty()).fine_ticks.len()
        };
        assert_eq!(fine(Scale::Log, [1.0, 100.0]), 2 * 8);
        assert_eq!([fine(Scale::Log, [1.0, 1e9]), fine(Scale::Linear, [1.0, 100.0])], [0, 0]);
    }

    #[test]
    fn an_axis_holds_its_values_whatever_they_are() {
        for values in [vec![], vec![3.0], vec![f64::NAN, 1.0, 1e9], vec![0.0, -1.0], vec![5.0, 5.0]] {
            for scale in [Scale::Linear, Scale::Log] {
                let ruler = Axis::new("", scale).ruler(values.iter().copied());
                assert!(ruler.range.start < ruler.range.end);
                let shown = values.iter().filter_map(|value| ruler.position(*value));
                assert!(shown.into_iter().all(|position| ruler.range.contains(&position)), "{values:?}");
            }
        }
    }

    #[test]
    fn an_axis_is_a_little_longer_than_its_values_unless_it_has_limits() {
        for (scale, limits, values, expected) in [
            (Scale::Linear, None, &[100.0, 0.0, f64::NAN, 50.0][..], [-4.0, 104.0]),
            (Scale::Log, None, &[1e3, 10.0, -5.0], [1.0 - 0.08, 3.0 + 0.08]),
            (Scale::Linear, None, &[3.0, 3.0], [2.5, 3.5]),
            (Scale::Log, None, &[0.0], [0.0, 1.0]),
            (Scale::Linear, Some([2.0, 8.0]), &[100.0], [2.0, 8.0]),
            (Scale::Log, Some([10.0, 1e4]), &[], [1.0, 4.0]),
        ] {
            let ruler = Axis { limits, ..Axis::new("", scale) }.ruler(values.iter().copied());
            let [start, end] = expected;
            let is_so = (ruler.range.start - start).abs() < 1e-9 && (ruler.range.end - end).abs() < 1e-9;
            assert!(is_so, "{values:?}: {:?}", ruler.range);
        }
    }

    #[test]
    fn of_many_powers_of_ten_every_second_has_a_label() {
        assert_eq!(labels(Scale::Log, [1.0, 1e11]).len(), 12);
        let labels = labels(Scale::Log, [1.0, 1e12]);
        assert_eq!(labels, ["1", "100", "10⁴", "10⁶", "10⁸", "10¹⁰", "10¹²"]);
    }

    #[test]
    fn a_position_is_a_share_of_the_pixels() {
        let ruler =
            Axis { limits: Some([0.0, 10.0]), ..Axis::new("", Scale::Linear) }.ruler(std::iter::empty());
        assert_eq!([0.0, 2.5, 10.0].map(|position| ruler.map(&position, (20, 120))), [20, 45, 120]);
        // Pixels are counted from above.
        assert_eq!([0.0, 2.5, 10.0].map(|position| ruler.map(&position, (100, 0))), [100, 75, 0]);
    }

    #[test]
    fn large_and_small_numbers_have_powers_of_ten() {
        let numbers = [0.0, 0.5, -1.25, 1e-4, 5e-5, 9_999_999.0, 1e7, -2e7, 3e-6];
        let texts = ["0", "0.5", "-1.25", "0.0001", "5e-5", "9999999", "10⁷", "-2·10⁷", "3e-6"];
        assert_eq!(numbers.map(plain_text), texts);
        let powers = [-4.0, -3.0, 3.0, 4.0, 13.0, 20.0].map(power_text);
        assert_eq!(powers, ["1e-4", "0.001", "1000", "10⁴", "10¹³", "10²⁰"]);
    }
}
