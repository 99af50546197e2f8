//! What a run of the suite found, as data.

use super::figures::Paired;
use super::verdict::Verdict;
use serde::Serialize;

/// Version of the JSON: it grows when a key changes its meaning or goes away.
pub const SCHEMA: u32 = 1;

/// A run.
#[derive(Debug, Serialize)]
pub struct StressReport {
    /// See [`SCHEMA`].
    pub schema: u32,
    /// The program's.
    pub version: &'static str,
    /// Who was tested.
    pub backends: Vec<String>,
    /// Wall time of the run, seconds.
    pub seconds: f64,
    /// Whether the user ended it.
    pub interrupted: bool,
    /// The cases, in the table's order.
    pub cases: Vec<CaseReport>,
}

/// A case.
#[derive(Debug, Serialize)]
pub struct CaseReport {
    /// Its id.
    pub id: String,
    /// Its family's title.
    pub family: &'static str,
    /// What is stiff about it.
    pub stiff: String,
    /// What it must give, in short.
    pub expected: String,
    /// The derivation.
    pub why: &'static str,
    /// What the mean may be off by, linear radiance.
    pub tolerance: f64,
    /// Spheres of the scene.
    pub spheres: usize,
    /// Each backend, in each form.
    pub measured: Vec<Measured>,
    /// Rays from the eye, checked one by one; `None` with a lens, or with too many spheres to check.
    pub first_hits: Option<FirstHits>,
    /// The book's own arithmetic.
    pub book: Vec<BookMeasured>,
}

/// Rays from the eye that meet in `f32` what they meet in numbers of 106 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct FirstHits {
    /// Rays that were checked.
    pub rays: usize,
    /// Those that agree in whether there is a hit and in its distance.
    pub agree: usize,
}

impl FirstHits {
    /// Whether so few disagree that they may have grazed a rim.
    pub fn is_right(self) -> bool {
        20 * (self.rays - self.agree) <= self.rays
    }
}

/// A case on a backend.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// The backend.
    pub backend: String,
    /// "plain" or "+40": with 40 distant spheres, which switch the hierarchy on.
    pub form: &'static str,
    /// Mean over pixels and channels; `None` without a picture.
    pub mean: Option<f64>,
    /// What it is off by.
    pub offset: Option<f64>,
    /// Standard error of the mean by itself.
    pub deviation: Option<f64>,
    /// Against `f64` in the same form; `None` for `f64` itself.
    pub rounding: Option<Paired>,
    /// Seconds of preparing and tracing.
    pub seconds: Option<f64>,
    /// The same of the tame twin.
    pub tame_seconds: Option<f64>,
    /// What came of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// The book's arithmetic on a case.
#[derive(Debug, Serialize)]
pub struct BookMeasured {
    /// "f32" or "f64".
    pub precision: &'static str,
    /// Mean over pixels and channels; `None` without a picture.
    pub mean: Option<f64>,
    /// What it is off by.
    pub offset: Option<f64>,
    /// What would be said of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

impl CaseReport {
    /// Whether all backends have it right.
    pub fn is_right(&self) -> bool {
        self.first_hits.is_none_or(FirstHits::is_right)
            && self.measured.iter().all(|measured| measured.verdict.is_right())
    }

    /// The measurement that is farthest off, of those with a picture.
    pub fn worst(&self) -> Option<&Measured> {
        let size = |measured: &&Measured| measured.offset.map_or(-1.0, f64::abs);
        self.measured.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The largest rounding, by its bias.
    pub fn rounding(&self) -> Option<Paired> {
        let all = self.measured.iter().filter_map(|measured| measured.rounding);
        all.max_by(|a, b| a.bias.abs().total_cmp(&b.bias.abs()))
    }

    /// The largest ratio of the time to the tame twin's, and what it is on the first backend.
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
