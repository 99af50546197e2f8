//! The results of a run, as JSON and as a table.

use super::super::table::{counted, or_dash, text_row};
use super::judge::{Difference, Verdict};
use serde::Serialize;

#[derive(Default, Serialize)]
pub struct StressReport {
    /// Names of the tested backends.
    pub backends: Vec<String>,
    /// Wall time of the run.
    pub seconds: f64,
    pub interrupted: bool,
    /// In the table's order.
    pub cases: Vec<CaseReport>,
}

/// The results of a case. Radiance is linear.
#[derive(Debug, Serialize)]
pub struct CaseReport {
    pub id: String,
    /// The family's title.
    pub family: &'static str,
    /// Why it is hard.
    pub stiff: String,
    /// The expected result, as in the table.
    pub expected: String,
    /// How the expected result is derived.
    pub why: &'static str,
    /// Allowed difference of the mean.
    pub tolerance: f64,
    /// Number of spheres in the scene.
    pub spheres: usize,
    /// One entry per backend and form.
    pub measured: Vec<Measured>,
    /// Results of the book's own arithmetic.
    pub book: Vec<BookMeasured>,
}

/// The result of a case on one backend, in one form.
#[derive(Debug, Default, Serialize)]
pub struct Measured {
    pub backend: String,
    /// "plain", or "+40" with 40 distant spheres, which switch the hierarchy on.
    pub form: &'static str,
    /// Mean over pixels and channels; `None` without a picture.
    pub mean: Option<f64>,
    /// Distance of the mean from the expected one.
    pub offset: Option<f64>,
    /// Standard error of the mean.
    pub deviation: Option<f64>,
    /// Difference from `f64` in the same form; `None` for `f64` itself.
    pub rounding: Option<Difference>,
    /// Time to prepare and trace.
    pub seconds: Option<f64>,
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// The result of the book's arithmetic on a case.
#[derive(Debug, Serialize)]
pub struct BookMeasured {
    /// "f32" or "f64".
    pub precision: &'static str,
    /// Mean over pixels and channels; `None` without a picture.
    pub mean: Option<f64>,
    /// Distance of the mean from the expected one.
    pub offset: Option<f64>,
    /// The verdict that a backend would get for it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

const WIDTHS: [i32; 7] = [-30, -12, -12, -9, -7, -7, -18];

pub fn head() -> String {
    let heads = ["case", "expected", "measured", "off by", "time", "verdict", "book's f32, f64"];
    text_row(&WIDTHS, &heads)
}

impl CaseReport {
    /// Whether the result is right on every backend.
    pub fn is_right(&self) -> bool {
        self.measured.iter().all(|measured| measured.verdict.is_right())
    }

    /// One line, and one more for each backend that is not right.
    pub fn text(&self) -> String {
        let size = |measured: &&Measured| measured.offset.map_or(-1.0, f64::abs);
        let worst = self.measured.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        let seconds = self.measured.iter().filter_map(|measured| measured.seconds).max_by(f64::total_cmp);
        let complaints = || self.measured.iter().filter(|measured| measured.verdict != Verdict::Right);
        let complaint = complaints().find(|measured| !measured.verdict.is_right()).or(complaints().next());
        let book: Vec<String> = self.book.iter().map(|book| or_dash(book.offset, brief)).collect();
        let cells = [
            self.id.clone(),
            self.expected.clone(),
            or_dash(worst.and_then(|worst| worst.mean), |mean| format!("{mean:.6}")),
            or_dash(worst.and_then(|worst| worst.offset), brief),
            or_dash(seconds, |seconds| format!("{seconds:.2} s")),
            complaint.map_or("right", |measured| measured.verdict.name()).to_owned(),
            book.join(", "),
        ];
        let mut text = text_row(&WIDTHS, &cells);
        for Measured { backend, form, verdict, .. } in complaints() {
            text += &format!("    {backend}, {form}: {}\n", verdict.reason());
        }
        text
    }
}

/// A small number with its sign; zero as a plain 0.
fn brief(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:+.1e}") }
}

impl StressReport {
    /// Whether every case is right on every backend.
    pub fn is_right(&self) -> bool {
        self.cases.iter().all(CaseReport::is_right)
    }

    /// Sums up the run of `chosen` cases in one line.
    pub fn summary(&self, chosen: usize) -> String {
        let count = self.cases.len();
        let right = self.cases.iter().filter(|case| case.is_right()).count();
        let by_the_book = |precision: &str| {
            let is_right = |case: &&CaseReport| {
                case.book.iter().all(|book| book.precision != precision || book.verdict.is_right())
            };
            self.cases.iter().filter(is_right).count()
        };
        let mut text = format!(
            "\n{right} of {} right on {} in {:.0} s; with the book's arithmetic, {} in f32 and {} in f64\n",
            counted(count, "case"),
            self.backends.join(", "),
            self.seconds,
            by_the_book("f32"),
            by_the_book("f64"),
        );
        if self.interrupted {
            let missing = chosen.saturating_sub(count);
            text += &format!("interrupted: {} not run\n", counted(missing, "case"));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(offset: Option<f64>, seconds: f64) -> Measured {
        Measured {
            backend: "cpu".to_owned(),
            form: "plain",
            offset,
            rounding: offset.map(|bias| Difference { bias, ..Difference::default() }),
            seconds: Some(seconds),
            ..Measured::default()
        }
    }

    fn case(measured: Vec<Measured>) -> CaseReport {
        CaseReport {
            id: "a".to_owned(),
            family: "A family",
            stiff: String::new(),
            expected: "1".to_owned(),
            why: "",
            tolerance: 0.0,
            spheres: 1,
            measured,
            book: Vec::new(),
        }
    }

    #[test]
    fn row_shows_worst_backend() {
        let offsets = [(Some(0.1), 3.0), (Some(-0.5), 8.0), (None, 2.0)];
        let mut found = case(offsets.map(|(offset, seconds)| measured(offset, seconds)).into());
        let words = |case: &CaseReport| case.text().split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words(&found).starts_with("a 1 - -5.0e-1 8.00 s right"), "{}", words(&found));
        assert_eq!(words(&case(Vec::new())), "a 1 - - - right");
        found.measured[0].verdict = Verdict::Warned("thin".to_owned());
        found.measured[1].verdict = Verdict::Wrong("off".to_owned());
        let text = found.text();
        assert!(text.contains(" WRONG\n    cpu, plain: thin\n    cpu, plain: off\n"), "{text}");
        let report = StressReport { interrupted: true, ..StressReport::default() };
        assert!(report.summary(2).contains("interrupted: 2 cases not run"));
    }

    #[test]
    fn run_is_right_if_all_cases_are() {
        let right = || case(vec![measured(Some(0.0), 1.0)]);
        let mut wrong = right();
        wrong.measured[0].verdict = Verdict::Wrong("off".to_owned());
        assert!(right().is_right() && !wrong.is_right());
    }
}
