//! Runs cases on the backends and judges the results.

use super::super::{Candidate, Traced};
use super::case::{Case, Expected};
use super::judge::{Difference, Level, Verdict, judge};
use super::report::{BookMeasured, CaseReport, Measured};
use crate::film::Film;
use crate::job::recipe::Recipe;
use crate::stages::{Rules, SurfaceRule};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time limit of one picture, and the interval at which it is checked.
const TIME_LIMIT: Duration = Duration::from_secs(20);
const GLANCE: Duration = Duration::from_millis(20);

/// The recipe with the book's own arithmetic.
pub fn by_the_book(recipe: &Recipe) -> Recipe {
    Recipe { rules: Rules { surface: SurfaceRule::Book, ..recipe.rules }, ..recipe.clone() }
}

/// Traces all samples of a picture. The error is a sentence: it was refused, failed, panicked or took too long.
pub fn trace(tracer: &mut Candidate, recipe: &Recipe, interrupt: &AtomicBool) -> Result<Traced, String> {
    let job = recipe.job().map_err(|error| format!("refused: {error}"))?;
    within_time(interrupt, TIME_LIMIT, |cancel| {
        let traced = tracer.trace(&job, recipe.samples_per_pixel, cancel);
        traced.map_err(|error| match cancel.load(Ordering::Relaxed) && !interrupt.load(Ordering::Relaxed) {
            true => format!("took more than {} s", TIME_LIMIT.as_secs()),
            false => format!("{error:#}"),
        })
    })
}

/// Runs `work` with a flag that is set when `limit` is over or when the user interrupts.
fn within_time<T>(interrupt: &AtomicBool, limit: Duration, work: impl FnOnce(&AtomicBool) -> T) -> T {
    let (cancel, begin) = (AtomicBool::new(false), Instant::now());
    std::thread::scope(|scope| {
        let (done, is_done) = channel::<()>();
        let cancel = &cancel;
        scope.spawn(move || {
            while is_done.recv_timeout(GLANCE) == Err(RecvTimeoutError::Timeout) {
                cancel.store(interrupt.load(Ordering::Relaxed) || begin.elapsed() > limit, Ordering::Relaxed);
            }
        });
        // Dropped when the work ends, even by a panic.
        let _done = done;
        work(cancel)
    })
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
    pub fn run(&mut self, case: &Case, interrupt: &AtomicBool) -> CaseReport {
        let reference = self.tracers.len() - 1;
        let names = self.names();
        let mut on_all = |recipe: &Recipe| -> Vec<Result<Traced, String>> {
            self.tracers.iter_mut().map(|tracer| trace(tracer, recipe, interrupt)).collect()
        };
        let forms: Vec<_> = case.forms().iter().map(|(form, recipe)| (*form, on_all(recipe))).collect();
        let same = match &case.expected {
            Expected::Same(other) => on_all(other),
            _ => Vec::new(),
        };
        // Films that must be equal are compared with that of the same backend, others with the reference's plain form.
        let other = |tracer: usize| same.get(tracer).unwrap_or(&forms[0].1[reference]);
        let measured = forms.iter().flat_map(|(form, traced)| {
            let exact = traced[reference].as_ref().ok();
            traced.iter().enumerate().map(move |(tracer, traced)| (form, exact, tracer, traced))
        });
        let measured = measured.map(|(form, exact, tracer, traced)| {
            let measured = Measured { backend: names[tracer].clone(), form, ..Measured::default() };
            let traced = match traced {
                Ok(traced) => traced,
                Err(reason) => return Measured { verdict: Verdict::None(reason.clone()), ..measured },
            };
            let (level, offset, verdict) = judged(case, &traced.film, other(tracer));
            let exact = exact.filter(|_| tracer != reference);
            Measured {
                mean: Some(level.grey()),
                offset,
                deviation: Some(level.deviation),
                rounding: exact.map(|exact| Difference::of(&traced.film, &exact.film)),
                seconds: Some(traced.seconds),
                verdict: verdict.given(&traced.warnings),
                ..measured
            }
        });
        let measured = measured.collect();
        // The book's picture of another scene may be wrong, too, so it is compared with our own.
        let recipe = by_the_book(&case.recipe);
        let book = [("f32", 0), ("f64", reference)].map(|(precision, tracer)| {
            let (mean, offset, verdict) = match trace(&mut self.tracers[tracer], &recipe, interrupt) {
                Ok(traced) => {
                    let (level, offset, verdict) = judged(case, &traced.film, other(reference));
                    (Some(level.grey()), offset, verdict)
                }
                Err(reason) => (None, None, Verdict::None(reason)),
            };
            BookMeasured { precision, mean, offset, verdict }
        });
        CaseReport {
            id: case.id.clone(),
            family: case.family.title,
            stiff: case.stiff.clone(),
            expected: case.expected.to_string(),
            why: case.why,
            tolerance: case.tolerance,
            spheres: case.recipe.scene.spheres.len(),
            measured,
            book: book.into(),
        }
    }
}

/// A film's level, how far it is off, and the verdict. `other` is the film that it may have to be equal to.
fn judged(case: &Case, film: &Film, other: &Result<Traced, String>) -> (Level, Option<f64>, Verdict) {
    let level = Level::of(film);
    let difference = match (&case.expected, other) {
        (Expected::Every(value), _) => Difference::from_every(&level, *value),
        (Expected::Mean(value), _) => Difference::from_mean(&level, *value),
        (Expected::Same(_) | Expected::Reference, Ok(other)) => Difference::of(film, &other.film),
        (Expected::Same(_) | Expected::Reference, Err(reason)) => {
            return (level, None, Verdict::None(reason.clone()));
        }
    };
    let verdict = judge(&level, &difference, case.tolerance, film.rejected());
    (level, Some(difference.bias), verdict)
}

#[cfg(test)]
mod tests {
    use super::super::families::build::{one_ball, sized, tame};
    use super::super::families::{FAMILIES, cases};
    use super::*;
    use crate::backends::BackendChoice;
    use crate::film::fixed_point;
    use crate::job::render::{BackendInfo, Control, Outcome, RenderError, RenderJob, Renderer, Stats};
    use crate::render_cpu::{CpuOptions, Isa};
    use std::ops::Range;

    fn real() -> Suite {
        let options = CpuOptions { threads: Some(1), ..CpuOptions::default() };
        Suite::new(vec![
            Candidate::backend("cpu", BackendChoice::Cpu(options)),
            Candidate::backend("f64", BackendChoice::Reference { threads: Some(1) }),
        ])
    }

    fn find(id: &str) -> &'static Case {
        cases().iter().find(|case| case.id == id).unwrap()
    }

    #[test]
    fn case_covers_all_backends_and_forms() {
        let (mut suite, go_on) = (real(), AtomicBool::new(false));
        let report = suite.run(find("shells/1"), &go_on);
        let who: Vec<_> = report.measured.iter().map(|m| (m.backend.as_str(), m.form)).collect();
        assert_eq!(who, [("cpu", "plain"), ("f64", "plain"), ("cpu", "+40"), ("f64", "+40")]);
        assert!(report.is_right(), "{report:#?}");
        assert_eq!(report.measured[0].mean, Some(0.5));
        assert!(report.measured[0].rounding.is_some() && report.measured[1].rounding.is_none());
        assert_eq!(report.book.iter().map(|book| book.precision).collect::<Vec<_>>(), ["f32", "f64"]);
        let wrong = Case { expected: Expected::Mean(0.6), ..find("shells/1").clone() };
        let report = suite.run(&wrong, &go_on);
        assert!(report.measured.iter().all(|measured| !measured.verdict.is_right()), "{report:#?}");
    }

    #[test]
    fn missing_picture_is_not_right() {
        let no_kernel = CpuOptions { isa: Some(Isa::Portable), lanes: Some(3), ..CpuOptions::default() };
        let go_on = AtomicBool::new(false);
        let mut suite = real();
        suite.tracers[0] = Candidate::backend("cpu", BackendChoice::Cpu(no_kernel));
        let report = suite.run(find("shells/1"), &go_on);
        let [cpu, reference, ..] = report.measured.as_slice() else { panic!("{report:#?}") };
        assert!(cpu.verdict.reason().contains("for 3 lanes") && cpu.mean.is_none(), "{cpu:?}");
        assert!(reference.verdict.is_right() && !report.is_right(), "{report:#?}");
        let mut refused = one_ball();
        refused.camera.look_at = refused.camera.look_from;
        let reason = trace(&mut real().tracers[0], &refused, &go_on).err().unwrap();
        assert!(reason.starts_with("refused: look_from and look_at are both"), "{reason}");
    }

    /// Fills pictures with the radiance that the job determines, and warns of scenes with many spheres.
    struct Painter(fn(&RenderJob) -> f64, Vec<String>);

    impl Renderer for Painter {
        fn info(&self) -> BackendInfo {
            BackendInfo { name: "painter", device: String::new(), lanes: 1, threads: 1 }
        }

        fn take_messages(&mut self) -> Vec<String> {
            std::mem::take(&mut self.1)
        }

        fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
            Ok(())
        }

        fn advance(
            &mut self,
            job: &RenderJob,
            samples: Range<u64>,
            film: &mut Film,
            _: &Control,
        ) -> Result<Outcome, RenderError> {
            let radiance = (self.0)(job);
            film.record(samples, 0)?;
            for half in 0..2 {
                let sum = film.half_sample_count(half) as f64 * radiance;
                film.halves_mut()[half].fill(fixed_point([sum; 3]).unwrap());
            }
            self.1.extend(is_far(job).then(|| "too far".to_owned()));
            Ok(Stats::default().into())
        }
    }

    fn is_far(job: &RenderJob) -> bool {
        job.scene().spheres.len() > 40
    }

    fn painter(name: &str, radiance: fn(&RenderJob) -> f64) -> Candidate {
        Candidate::of_renderer(name, Box::new(Painter(radiance, Vec::new())))
    }

    /// Form, mean, offset and verdict of each measurement of a small picture.
    fn figures(tracers: Vec<Candidate>, expected: Expected) -> Vec<(&'static str, f64, f64, &'static str)> {
        let case = Case::new(&FAMILIES[0], "made-up", "nothing", sized(one_ball(), [4, 3], 4));
        let mut suite = Suite::new(tracers);
        let report = suite.run(&case.expect(expected, "it is", 1e-6), &AtomicBool::new(false));
        let rounded = |x: Option<f64>| (1000.0 * x.unwrap_or(f64::NAN)).round() / 1000.0;
        let book = report.book.iter().map(|m| ("book", rounded(m.mean), rounded(m.offset), m.verdict.name()));
        let own = report.measured.iter();
        own.map(|m| (m.form, rounded(m.mean), rounded(m.offset), m.verdict.name())).chain(book).collect()
    }

    #[test]
    fn same_samples_compare_per_backend() {
        let cpu = painter("cpu", |job| if job.rules().surface == SurfaceRule::Book { 0.875 } else { 0.75 });
        let exact = painter("f64", |job| if job.rules().surface == SurfaceRule::Book { 0.625 } else { 0.5 });
        assert_eq!(
            figures(vec![cpu, exact], Expected::Same(Box::new(sized(tame(), [4, 3], 4)))),
            [
                ("plain", 0.75, 0.0, "right"),
                ("plain", 0.5, 0.0, "right"),
                ("+40", 0.75, 0.0, "right"),
                ("+40", 0.5, 0.0, "right"),
                ("book", 0.875, 0.375, "WRONG"),
                ("book", 0.625, 0.125, "WRONG"),
            ]
        );
    }

    #[test]
    fn forms_compare_with_plain_reference() {
        let cpu = painter("cpu", |_| 0.25);
        let exact = painter("f64", |job| if is_far(job) { 0.25 } else { 0.5 });
        assert_eq!(
            figures(vec![cpu, exact], Expected::Reference),
            [
                ("plain", 0.25, -0.25, "WRONG"),
                ("plain", 0.5, 0.0, "right"),
                ("+40", 0.25, -0.25, "warned"),
                ("+40", 0.25, -0.25, "warned"),
                ("book", 0.25, -0.25, "WRONG"),
                ("book", 0.5, 0.0, "right"),
            ]
        );
    }

    #[test]
    fn panicking_renderer_is_replaced() {
        let go_on = AtomicBool::new(false);
        let small = sized(one_ball(), [2, 2], 4);
        let mut broken = painter("cpu", |_| panic!("on purpose"));
        assert_eq!(trace(&mut broken, &small, &go_on).err().as_deref(), Some("the tracer panicked"));
        // The reference takes its place.
        let traced = trace(&mut broken, &small, &go_on).unwrap();
        assert_eq!((traced.film.sample_count(), traced.film.mean(3)), (4, [0.5; 3]));
    }

    #[test]
    fn pictures_end_at_the_limit_or_an_interrupt() {
        for (is_interrupted, limit) in [(false, Duration::ZERO), (true, TIME_LIMIT)] {
            let was_set = within_time(&AtomicBool::new(is_interrupted), limit, |cancel| {
                let begin = Instant::now();
                while !cancel.load(Ordering::Relaxed) && begin.elapsed() < Duration::from_secs(10) {
                    std::thread::sleep(Duration::from_millis(5));
                }
                cancel.load(Ordering::Relaxed)
            });
            assert!(was_set);
        }
    }
}
