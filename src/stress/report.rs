//! The results of a run, as data.

use super::figures::Paired;
use super::verdict::Verdict;
use serde::Serialize;

/// Version of the JSON. It is raised when a key changes its meaning or is removed.
pub const SCHEMA: u32 = 1;

/// The results of a run.
#[derive(Debug, Serialize)]
pub struct StressReport {
    /// See `SCHEMA`.
    pub schema: u32,
    /// Version of the program.
    pub version: &'static str,
    /// Names of the backends that were tested.
    pub backends: Vec<String>,
    /// Wall time of the run, seconds.
    pub seconds: f64,
    /// Number of cases that were to be run.
    #[serde(skip)]
    pub chosen: usize,
    /// Whether the user interrupted the run.
    pub interrupted: bool,
    /// The cases, in the table's order.
    pub cases: Vec<CaseReport>,
}

/// The results of a case.
#[derive(Debug, Serialize)]
pub struct CaseReport {
    /// The case's id.
    pub id: String,
    /// The family's title.
    pub family: &'static str,
    /// What is stiff about it.
    pub stiff: String,
    /// The expected result, as in the table.
    pub expected: String,
    /// Its derivation.
    pub why: &'static str,
    /// By how much the mean may differ, linear radiance.
    pub tolerance: f64,
    /// Number of spheres in the scene.
    pub spheres: usize,
    /// One entry per backend and form.
    pub measured: Vec<Measured>,
    /// Rays from the eye, checked one by one; `None` if there is a lens or too many spheres.
    pub first_hits: Option<FirstHits>,
    /// The results of the book's own arithmetic.
    pub book: Vec<BookMeasured>,
}

/// How many rays from the eye hit the same surface in `f32` as in 106-bit arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct FirstHits {
    /// Rays checked.
    pub rays: usize,
    /// Rays for which both agree on whether there is a hit, and on its distance.
    pub agree: usize,
}

impl FirstHits {
    /// Whether few enough disagree that they may just have grazed an edge.
    pub fn is_right(self) -> bool {
        20 * (self.rays - self.agree) <= self.rays
    }
}

/// The result of a case on one backend, in one form.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// Name of the backend.
    pub backend: String,
    /// "plain", or "+40" with 40 distant spheres, which switch the hierarchy on.
    pub form: &'static str,
    /// Mean over pixels and channels, linear radiance; `None` if there is no picture.
    pub mean: Option<f64>,
    /// Distance of the mean from the expected one, linear radiance.
    pub offset: Option<f64>,
    /// Standard error of the mean.
    pub deviation: Option<f64>,
    /// Difference from `f64` in the same form; `None` for `f64` itself.
    pub rounding: Option<Paired>,
    /// Time to prepare and trace, seconds.
    pub seconds: Option<f64>,
    /// The same for the tame twin.
    pub tame_seconds: Option<f64>,
    /// The verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// The result of the book's arithmetic on a case.
#[derive(Debug, Serialize)]
pub struct BookMeasured {
    /// "f32" or "f64".
    pub precision: &'static str,
    /// Mean over pixels and channels, linear radiance; `None` if there is no picture.
    pub mean: Option<f64>,
    /// Distance of the mean from the expected one, linear radiance.
    pub offset: Option<f64>,
    /// The verdict that a backend would get for it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl CaseReport {
    /// Whether the result is right on every backend.
    pub fn is_right(&self) -> bool {
        self.first_hits.is_none_or(FirstHits::is_right)
            && self.measured.iter().all(|measured| measured.verdict.is_right())
    }

    /// The measurement that is farthest off, among those with a picture.
    pub fn worst(&self) -> Option<&Measured> {
        let size = |measured: &&Measured| measured.offset.map_or(-1.0, f64::abs);
        self.measured.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The rounding with the largest bias.
    pub fn rounding(&self) -> Option<Paired> {
        let all = self.measured.iter().filter_map(|measured| measured.rounding);
        all.max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))
    }

    /// The largest ratio of the time to that of the tame twin.
    pub fn time_ratio(&self) -> Option<f64> {
        let ratios = self.measured.iter().filter_map(|m| Some(m.seconds? / m.tame_seconds?.max(1e-6)));
        ratios.max_by(f64::total_cmp)
    }
}

impl StressReport {
    /// Whether every case is right on every backend.
    pub fn is_right(&self) -> bool {
        self.cases.iter().all(CaseReport::is_right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ratio_of_times_is_that_of_the_slowest_backend() {
        let measured = [(3.0, Some(2.0)), (8.0, Some(2.0)), (1.0, Some(2.0)), (9.0, None)]
            .map(|(seconds, tame)| Measured { seconds: Some(seconds), tame_seconds: tame, ..measured(None) });
        let report = CaseReport { measured: measured.into(), ..report(&[]) };
        assert_eq!(report.time_ratio(), Some(4.0));
    }

    #[test]
    fn one_first_hit_in_twenty_may_differ() {
        let is_right = |agree| FirstHits { rays: 40, agree }.is_right();
        assert!(is_right(40) && is_right(38) && !is_right(37));
    }

    fn measured(offset: Option<f64>) -> Measured {
        Measured {
            backend: "cpu".to_owned(),
            form: "plain",
            mean: None,
            offset,
            deviation: None,
            rounding: offset.map(|bias| Paired { bias, ..Paired::default() }),
            seconds: None,
            tame_seconds: None,
            verdict: Verdict::Right,
        }
    }

    fn report(offsets: &[Option<f64>]) -> CaseReport {
        CaseReport {
            id: "a".to_owned(),
            family: "A",
            stiff: String::new(),
            expected: String::new(),
            why: "",
            tolerance: 0.0,
            spheres: 1,
            measured: offsets.iter().map(|offset| measured(*offset)).collect(),
            first_hits: None,
            book: Vec::new(),
        }
    }

    #[test]
    fn the_worst_is_farthest_off_on_either_side() {
        let worst = |offsets: &[Option<f64>]| report(offsets).worst().and_then(|worst| worst.offset);
        assert_eq!(worst(&[Some(0.1), Some(-0.5), None, Some(0.4)]), Some(-0.5));
        assert_eq!(worst(&[None, Some(0.0)]), Some(0.0), "a picture counts for more than none");
        assert_eq!(
            report(&[Some(0.1), Some(-0.5), Some(0.4)]).rounding().map(|paired| paired.bias),
            Some(-0.5)
        );
        assert_eq!(
            (worst(&[]), report(&[None]).rounding(), report(&[None]).time_ratio()),
            (None, None, None)
        );
    }

    #[test]
    fn a_run_is_right_if_every_case_is_right_on_every_backend() {
        let right = || report(&[Some(0.0), Some(0.0)]);
        let mut wrong = right();
        wrong.measured[1].verdict = Verdict::Wrong("off".to_owned());
        let mut missed = right();
        missed.first_hits = Some(FirstHits { rays: 64, agree: 32 });
        let is_right = |cases: Vec<CaseReport>| {
            let (version, backends, chosen) = ("", Vec::new(), cases.len());
            StressReport { schema: 1, version, backends, seconds: 0.0, chosen, interrupted: false, cases }
                .is_right()
        };
        assert!(is_right(vec![right(), right()]));
        assert!(!is_right(vec![right(), wrong]) && !is_right(vec![missed, right()]));
    }
}
