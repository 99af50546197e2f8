//! Shows two paths side by side on a terminal.

use super::compare::{PathComparison, Quantity, amount, departure};
use super::words::Told;
use crate::record::PathRecord;
use std::ffi::OsString;
use std::fmt::Write;

/// Width of a line in characters.
const WIDTH: usize = 78;

/// Width of the label column in characters.
const LABEL: usize = 13;

/// Width of each side's column in characters.
const COLUMN: usize = 31;

/// Whether and how text is coloured.
#[derive(Clone, Copy, Debug)]
pub struct Paint {
    /// Whether colours are used.
    pub is_on: bool,
}

/// The meaning of a piece of text.
#[derive(Clone, Copy, Debug)]
pub enum Tone {
    /// A heading.
    Strong,
    /// Unimportant text.
    Faint,
    /// Agreement.
    Good,
    /// A difference.
    Bad,
}

impl Paint {
    /// Colours on a terminal, unless the variable `NO_COLOR` is set to some text (no-color.org).
    pub fn on(is_terminal: bool, no_color: Option<OsString>) -> Paint {
        Paint { is_on: is_terminal && no_color.is_none_or(|value| value.is_empty()) }
    }

    /// `text` in the colour of `tone`.
    pub fn paint(self, tone: Tone, text: &str) -> String {
        let code = match tone {
            Tone::Strong => "1",
            Tone::Faint => "2",
            Tone::Good => "32",
            Tone::Bad => "1;31",
        };
        if self.is_on && !text.is_empty() { format!("\x1b[{code}m{text}\x1b[0m") } else { text.to_owned() }
    }
}

/// All rays of both paths, with the first difference marked.
pub fn rays(told: &Told, comparison: &PathComparison, paint: Paint) -> String {
    let mut text = String::new();
    let [a, b] = told.names.map(|name| cut(name, COLUMN));
    line(&mut text, &paint.paint(Tone::Strong, format!("{:LABEL$}{a:COLUMN$}   {b}", "").trim_end()));
    let count = told.paths.iter().map(|path| path.rays.len()).max().unwrap_or(0);
    for index in 0..count {
        let from = if index == 0 { " from the camera" } else { "" };
        let heading = format!("ray {}{from} ", index + 1);
        let rule = "─".repeat(WIDTH.saturating_sub(heading.chars().count()));
        line(
            &mut text,
            &format!("{}{}", paint.paint(Tone::Strong, &heading), paint.paint(Tone::Faint, &rule)),
        );
        for quantity in Quantity::OF_RAY {
            row(&mut text, told, comparison, index, quantity, paint);
        }
    }
    text
}

/// A quantity on both sides; the first difference and the parting get a sentence below.
fn row(
    text: &mut String,
    told: &Told,
    comparison: &PathComparison,
    index: usize,
    quantity: Quantity,
    paint: Paint,
) {
    let values = told.paths.map(|path| value(told, path, index, quantity));
    if values.iter().all(Option::is_none) {
        return;
    }
    let label = match quantity {
        Quantity::Origin => "from",
        Quantity::Direction => "direction",
        Quantity::Throughput => "throughput",
        Quantity::Object => "meets",
        Quantity::Distance => "distance",
        Quantity::Departure => "then",
        Quantity::Radiance => "radiance",
    };
    // If a side has no value, the row of what it hit says why.
    let difference = amount(told.job, told.paths, index, quantity);
    let sign = if values.iter().all(Option::is_some) {
        sign(difference, told.tolerance, paint)
    } else {
        " ".to_owned()
    };
    let [a, b] = values.map(|value| cut(&value.unwrap_or_default(), COLUMN));
    let is = |found: Option<super::compare::Difference>| {
        found.filter(|found| (found.ray, found.quantity) == (index, quantity))
    };
    let marked = is(comparison.first).or(is(comparison.parting));
    let (mark, tone) = if marked.is_some() { ("▶ ", Tone::Bad) } else { ("  ", Tone::Faint) };
    line(
        text,
        &format!(
            "{}{}{a:COLUMN$} {sign} {b}",
            paint.paint(Tone::Bad, mark),
            paint.paint(tone, &format!("{label:width$}", width = LABEL - 2)),
        ),
    );
    if let Some(difference) = marked {
        for part in wrapped(&told.sentence(&difference), WIDTH - 4) {
            line(text, &format!("    {}", paint.paint(Tone::Bad, &part)));
        }
    }
}

/// Both radiances, their difference and the verdict.
pub fn closing(told: &Told, comparison: &PathComparison, paint: Paint) -> String {
    let mut text = String::new();
    line(&mut text, &paint.paint(Tone::Faint, &"─".repeat(WIDTH)));
    let [a, b] = told.paths.map(|path| vector(path.radiance));
    let sign = sign(comparison.radiance, told.tolerance, paint);
    let label = paint.paint(Tone::Strong, &format!("{:LABEL$}", "radiance"));
    line(&mut text, &format!("{label}{a:COLUMN$} {sign} {b}"));
    let [a, b] = told.paths.map(|path| path.radiance);
    let by = vector([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
    let share = match comparison.radiance {
        0.0 => "0 of the larger".to_owned(),
        share if share < 1e-3 => format!("{share:.1e} of the larger"),
        share => format!("{:.1} % of the larger", 100.0 * share),
    };
    line(&mut text, &format!("{:LABEL$}{by:COLUMN$}   {share}", "difference"));
    let tone = if comparison.first.is_some() { Tone::Bad } else { Tone::Good };
    for (index, part) in wrapped(&told.verdict(comparison), WIDTH - LABEL).iter().enumerate() {
        let label = if index == 0 { "verdict" } else { "" };
        let label = paint.paint(Tone::Strong, &format!("{label:LABEL$}"));
        line(&mut text, &format!("{label}{}", paint.paint(tone, part)));
    }
    text
}

/// A sign for equal to the bit, equal within the tolerance, or different.
fn sign(difference: f64, tolerance: f64, paint: Paint) -> String {
    if difference == 0.0 {
        paint.paint(Tone::Good, "=")
    } else if difference <= tolerance {
        paint.paint(Tone::Faint, "≈")
    } else {
        paint.paint(Tone::Bad, "≠")
    }
}

fn value(told: &Told, path: &PathRecord, index: usize, quantity: Quantity) -> Option<String> {
    let ray = path.rays.get(index)?;
    match quantity {
        Quantity::Origin => Some(vector(ray.origin)),
        Quantity::Direction => Some(vector(ray.direction)),
        Quantity::Throughput => Some(vector(ray.throughput)),
        Quantity::Object => Some(match ray.hit {
            None => "the sky".to_owned(),
            Some(hit) => match told.material(hit.sphere) {
                Some((name, kind)) => format!("#{} {name} ({kind})", hit.sphere),
                None => format!("#{}", hit.sphere),
            },
        }),
        Quantity::Distance => ray.hit.map(|hit| number(hit.distance).trim_start().to_owned()),
        Quantity::Departure => departure(told.job, path, index).map(|departure| departure.word().to_owned()),
        Quantity::Radiance => Some(vector(path.radiance)),
    }
}

fn vector(v: [f64; 3]) -> String {
    v.map(number).join(" ")
}

/// Nine characters, with as many digits as fit.
fn number(x: f64) -> String {
    let text = match x.abs() {
        0.0 => "0".to_owned(),
        size if !(1e-4..1e5).contains(&size) => format!("{x:.2e}"),
        size => format!("{x:.*}", 6 - (size.log10().floor().max(0.0) as usize).min(4)),
    };
    format!("{text:>9}")
}

fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    text.chars().take(width - 1).chain(['…']).collect()
}

/// Lines of at most `width` characters, broken between words.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(last) if last.is_empty() => last.push_str(word),
            Some(last) if last.chars().count() + 1 + word.chars().count() <= width => {
                last.push(' ');
                last.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn line(text: &mut String, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", content.trim_end());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diff::compare;
    use crate::recipe::Recipe;
    use crate::record::RecordedRay;

    #[test]
    fn numbers_have_nine_characters() {
        for x in [0.0, 1.0, -1.0, 0.5, -13.25, 999.999_99, -99_999.0, 1e5, -1e300, 1e-5, -1e-17, 0.000_123] {
            assert_eq!(number(x).chars().count(), 9, "{}", number(x));
        }
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1.000000"),
            (-13.25, "-13.25000"),
            (123.456_78, "123.4568"),
            (99_999.0, "99999.00"),
            (1e5, "1.00e5"),
            (0.000_123, "0.000123"),
            (1e-4, "0.000100"),
            (9.876e-5, "9.88e-5"),
        ] {
            assert_eq!(number(x).trim(), text);
        }
    }

    #[test]
    fn colours_are_for_terminals_and_can_be_switched_off() {
        let is_on =
            |is_terminal, no_color: Option<&str>| Paint::on(is_terminal, no_color.map(Into::into)).is_on;
        assert!(is_on(true, None) && is_on(true, Some("")));
        assert!(!is_on(true, Some("1")) && !is_on(false, None));
        let [on, off] = [true, false].map(|is_on| Paint { is_on });
        assert_eq!(on.paint(Tone::Good, "="), "\x1b[32m=\x1b[0m");
        assert_eq!((on.paint(Tone::Good, ""), off.paint(Tone::Good, "=")), (String::new(), "=".to_owned()));
    }

    #[test]
    fn the_verdict_is_green_if_the_paths_agree_and_red_if_not() {
        let job = Recipe::find("three-spheres").unwrap().job().unwrap();
        let path = |z: f64| {
            let (direction, throughput) = ([0.0, 0.0, -1.0], [1.0; 3]);
            let ray = RecordedRay { origin: [0.0, 0.0, z], direction, throughput, hit: None };
            PathRecord { rays: vec![ray], radiance: [0.5; 3] }
        };
        let [here, there] = [path(1.0), path(2.0)];
        for (other, code) in [(&here, "\x1b[32m"), (&there, "\x1b[1;31m")] {
            let paths = [&here, other];
            let told = Told { job: &job, names: ["cpu", "reference"], paths, tolerance: 1e-3 };
            let text = closing(&told, &compare(&job, paths, 1e-3), Paint { is_on: true });
            let verdict = text.lines().find(|line| line.contains("verdict")).unwrap();
            assert!(verdict.contains(code), "{verdict:?}");
        }
    }

    #[test]
    fn lines_break_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(cut("sphere 7", 5), "sphe…");
    }

    #[test]
    fn rays_that_only_one_path_has_are_shown_with_the_difference_that_they_make() {
        let job = Recipe::find("three-spheres").unwrap().job().unwrap();
        let ray = |z: f64| {
            let (direction, throughput) = ([0.0, 0.0, -1.0], [1.0; 3]);
            RecordedRay { origin: [0.0, 0.0, z], direction, throughput, hit: None }
        };
        let path = |rays: &[RecordedRay]| PathRecord { rays: rays.to_vec(), radiance: [0.5; 3] };
        let (short, long) = (path(&[ray(1.0)]), path(&[ray(1.0), ray(2.0)]));
        for paths in [[&short, &long], [&long, &short]] {
            let told = Told { job: &job, names: ["cpu", "reference"], paths, tolerance: 1e-3 };
            let text = rays(&told, &compare(&job, paths, 1e-3), Paint { is_on: false });
            let (both, one) = text.split_once("ray 2 ").unwrap();
            assert!(both.contains("ray 1 from the camera") && !both.contains('▶'), "{text}");
            let row = |label: &str| one.lines().find(|line| line.contains(label)).unwrap();
            assert!(row("▶ from").contains("2.000000"), "{text}");
            assert!(row("direction ").contains("-1.000000"), "{text}");
            assert!(row("meets").contains("the sky"), "{text}");
            assert!(
                one.contains("ray 2: the origins of the rays differ") && !text.contains("ray 3"),
                "{text}"
            );
        }
    }
}
