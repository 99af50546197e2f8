//! Runs cases on the backends, judges the results, and shows them as JSON and as a table.

use super::super::table::{counted, or_dash, text_row};
use super::super::{Candidate, Traced};
use super::case::{Case, Claim, Expected};
use super::judge::{Difference, Level, Verdict, judge};
use crate::job::recipe::Recipe;
use crate::stages::{Rules, SurfaceRule};
use serde::Serialize;
use std::sync::atomic::AtomicBool;

/// The recipe with the book's own arithmetic.
pub fn by_the_book(recipe: &Recipe) -> Recipe {
    Recipe { rules: Rules { surface: SurfaceRule::Book, ..recipe.rules }, ..recipe.clone() }
}

/// Traces all samples of a picture. The error is a sentence: it was refused, failed or panicked.
pub fn trace(tracer: &mut Candidate, recipe: &Recipe, cancel: &AtomicBool) -> Result<Traced, String> {
    let job = recipe.job().map_err(|error| format!("refused: {error}"))?;
    tracer.trace(&job, recipe.samples_per_pixel, cancel).map_err(|error| format!("{error:#}"))
}

/// The backends under test, which are compared with the last one, the `f64` reference. The first also renders the
/// book's arithmetic in `f32`.
pub struct Suite {
    tracers: Vec<Candidate>,
}

impl Suite {
    /// At least one backend and the reference, which is last.
    pub fn new(tracers: Vec<Candidate>) -> Self {
        Suite { tracers }
    }

    /// The reference is last.
    pub fn names(&self) -> Vec<String> {
        self.tracers.iter().map(|tracer| tracer.name.clone()).collect()
    }

    /// Runs a case in all its forms on all backends, and with the book's arithmetic.
    pub fn run(&mut self, case: &Case, cancel: &AtomicBool) -> CaseReport {
        let (names, reference) = (self.names(), self.tracers.len() - 1);
        let mut on_all = |recipe: &Recipe| -> Vec<Result<Traced, String>> {
            self.tracers.iter_mut().map(|tracer| trace(tracer, recipe, cancel)).collect()
        };
        let forms: Vec<_> = case.forms().iter().map(|(form, recipe)| (*form, on_all(recipe))).collect();
        let twins = case.twin.as_ref().map(on_all).unwrap_or_default();
        // Films that must be equal are compared with that of the same backend, others with the reference's plain form.
        let other = |tracer: usize| twins.get(tracer).unwrap_or(&forms[0].1[reference]);
        let measured = forms.iter().flat_map(|(form, traced)| {
            let of = |tracer: usize| Measured::of(case, form, &names[tracer], &traced[tracer], other(tracer));
            (0..=reference).map(of).collect::<Vec<_>>()
        });
        let measured = measured.collect();
        // The book's picture of another scene may be wrong, too, so it is compared with our own.
        let recipe = by_the_book(&case.recipe);
        let book = [("f32", 0), ("f64", reference)].map(|(precision, tracer)| {
            let traced = trace(&mut self.tracers[tracer], &recipe, cancel);
            Measured::of(case, BOOK, precision, &traced, other(reference))
        });
        CaseReport {
            id: case.id.clone(),
            family: &case.family.title,
            claim: case.claim.clone(),
            spheres: case.recipe.scene.spheres.len(),
            measured,
            book: book.into(),
        }
    }
}

/// Form of the pictures with the book's arithmetic.
const BOOK: &str = "book";

/// The result of a case on one backend, in one form.
#[derive(Debug, Default, Serialize)]
pub struct Measured {
    /// For the book's arithmetic, its precision: "f32" or "f64".
    pub backend: String,
    /// "plain", "+40" with 40 distant spheres, which switch the hierarchy on, or "book" for the book's arithmetic.
    pub form: String,
    /// Mean over pixels and channels; `None` without a picture.
    pub mean: Option<f64>,
    /// From the expected result; `None` if one of the two is missing.
    pub difference: Option<Difference>,
    /// Time to prepare and trace.
    pub seconds: Option<f64>,
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl Measured {
    /// Judges a picture. `other` is the one that it may have to be equal to.
    fn of(
        case: &Case,
        form: &str,
        backend: &str,
        traced: &Result<Traced, String>,
        other: &Result<Traced, String>,
    ) -> Self {
        let measured = Measured { backend: backend.to_owned(), form: form.to_owned(), ..Measured::default() };
        let Traced { film, seconds, warnings, .. } = match traced {
            Ok(traced) => traced,
            Err(reason) => return Measured { verdict: Verdict::None(reason.clone()), ..measured },
        };
        let level = Level::of(film);
        let difference = match (&case.claim.expected, other) {
            (Expected::Every(value), _) => Ok(Difference::from_every(&level, *value)),
            (Expected::Mean(value), _) => Ok(Difference::from_mean(&level, *value)),
            (_, Ok(other)) => Ok(Difference::of(film, &other.film)),
            (_, Err(reason)) => Err(reason.clone()),
        };
        let warning = warnings.first().filter(|_| form != BOOK);
        let verdict = match &difference {
            Ok(difference) => judge(&level, difference, case.claim.tolerance, film.rejected()).given(warning),
            Err(reason) => Verdict::None(reason.clone()),
        };
        let (mean, difference, seconds) = (Some(level.grey()), difference.ok(), Some(*seconds));
        Measured { mean, difference, seconds, verdict, ..measured }
    }

    /// Distance of the mean from the expected one.
    fn offset(&self) -> Option<f64> {
        Some(self.difference?.bias)
    }
}

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
    #[serde(flatten)]
    pub claim: Claim,
    /// Number of spheres in the scene.
    pub spheres: usize,
    /// One entry per form and backend.
    pub measured: Vec<Measured>,
    /// Results of the book's own arithmetic.
    pub book: Vec<Measured>,
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
        let size = |measured: &&Measured| measured.offset().map_or(-1.0, f64::abs);
        let worst = self.measured.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        let seconds = self.measured.iter().filter_map(|measured| measured.seconds).max_by(f64::total_cmp);
        let complaints = || self.measured.iter().filter(|measured| measured.verdict != Verdict::Right);
        let complaint = complaints().find(|measured| !measured.verdict.is_right()).or(complaints().next());
        let book: Vec<String> = self.book.iter().map(|book| or_dash(book.offset(), brief)).collect();
        let cells = [
            self.id.clone(),
            self.claim.expected.to_string(),
            or_dash(worst.and_then(|worst| worst.mean), |mean| format!("{mean:.6}")),
            or_dash(worst.and_then(Measured::offset), brief),
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
        let [single, double] = [0, 1].map(|precision| {
            self.cases.iter().filter(|case| case.book[precision].verdict.is_right()).count()
        });
        let mut text = format!(
            "\n{right} of {} right on {} in {:.0} s; with the book's arithmetic, {single} in f32 and {double} in f64\n",
            counted(count, "case"),
            self.backends.join(", "),
            self.seconds,
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
    use super::super::{cases, with_far_spheres};
    use super::*;
    use crate::film::fixed_point;
    use crate::job::render::RenderJob;
    use crate::job::render::tests::Scripted;

    /// A small case of one ball.
    fn small(expected: Expected) -> Case {
        let mut case = cases().iter().find(|case| case.id == "shells/1").unwrap().clone();
        (case.recipe.settings.width, case.recipe.settings.height) = (4, 3);
        case.recipe.samples_per_pixel = 4;
        case.twin = matches!(expected, Expected::Same(_)).then(|| with_far_spheres(&case.recipe, 1.0));
        case.claim.expected = expected;
        case
    }

    fn is_far(job: &RenderJob) -> bool {
        job.scene().spheres.len() > 40
    }

    fn is_by_the_book(job: &RenderJob) -> bool {
        job.rules().surface == SurfaceRule::Book
    }

    /// Fills pictures with the radiance that the job determines, and warns of scenes with many spheres.
    fn painter(name: &str, radiance: fn(&RenderJob) -> f64) -> Candidate {
        let painter = Scripted::boxed(move |job, samples, film, messages| {
            let radiance = radiance(job);
            film.record(samples, 0)?;
            for half in 0..2 {
                let sum = film.half_sample_count(half) as f64 * radiance;
                film.halves_mut()[half].fill(fixed_point([sum; 3]).unwrap());
            }
            messages.extend(is_far(job).then(|| "too far".to_owned()));
            Ok(())
        });
        Candidate::of_renderer(name, painter)
    }

    /// Form, offset and verdict of each measurement.
    fn figures(tracers: Vec<Candidate>, expected: Expected) -> Vec<(String, f64, &'static str)> {
        let report = Suite::new(tracers).run(&small(expected), &AtomicBool::new(false));
        let rounded = |x: Option<f64>| (1000.0 * x.unwrap_or(f64::NAN)).round() / 1000.0;
        let all = report.measured.iter().chain(&report.book);
        all.map(|m| (m.form.clone(), rounded(m.offset()), m.verdict.name())).collect()
    }

    fn rows(rows: [(&str, f64, &'static str); 6]) -> Vec<(String, f64, &'static str)> {
        rows.map(|(form, offset, verdict)| (form.to_owned(), offset, verdict)).into()
    }

    #[test]
    fn same_samples_compare_per_backend() {
        let cpu = painter("cpu", |job| if is_by_the_book(job) { 0.875 } else { 0.75 });
        let exact = painter("f64", |job| if is_by_the_book(job) { 0.625 } else { 0.5 });
        let own = ["plain", "plain", "+40", "+40"].map(|form| (form, 0.0, "right"));
        let [a, b, c, d] = own;
        let expected = rows([a, b, c, d, ("book", 0.375, "WRONG"), ("book", 0.125, "WRONG")]);
        assert_eq!(figures(vec![cpu, exact], Expected::Same("another".to_owned())), expected);
    }

    #[test]
    fn forms_compare_with_plain_reference() {
        let cpu = painter("cpu", |_| 0.25);
        let exact = painter("f64", |job| if is_far(job) { 0.25 } else { 0.5 });
        let expected = rows([
            ("plain", -0.25, "WRONG"),
            ("plain", 0.0, "right"),
            ("+40", -0.25, "warned"),
            ("+40", -0.25, "warned"),
            ("book", -0.25, "WRONG"),
            ("book", 0.0, "right"),
        ]);
        assert_eq!(figures(vec![cpu, exact], Expected::Reference), expected);
    }

    #[test]
    fn failed_renderer_is_replaced_and_its_picture_is_not_right() {
        let mut suite = Suite::new(vec![painter("cpu", |_| panic!("on purpose")), painter("f64", |_| 0.5)]);
        let mut run = || suite.run(&small(Expected::Every(0.5)), &AtomicBool::new(false));
        let report = run();
        let verdict = &report.measured[0].verdict;
        assert!(verdict.name() == "NONE" && verdict.reason() == "the tracer panicked", "{report:#?}");
        assert!(report.measured[1].verdict.is_right() && !report.is_right());
        // The reference takes its place.
        assert!(run().is_right());
        let mut refused = small(Expected::Reference).recipe;
        refused.camera.look_at = refused.camera.look_from;
        let reason = trace(&mut painter("cpu", |_| 0.5), &refused, &AtomicBool::new(false)).err().unwrap();
        assert!(reason.starts_with("refused: look_from and look_at are both"), "{reason}");
    }
}
