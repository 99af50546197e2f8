//! Runs cases on the backends and judges the results.

use super::backend::{Backend, Traced};
use super::case::{Case, Expected, Form};
use super::exact::first_hit;
use super::figures::{Level, Paired};
use super::report::{BookMeasured, CaseReport, FirstHits, Measured};
use super::verdict::{Against, Verdict, judge, judge_time, offset};
use crate::film::Film;
use crate::recipe::Recipe;
use crate::render_cpu::{Isa, PathRecorder};
use crate::scene::Scene;
use crate::stages::{Rules, SurfaceRule};
use glam::DVec3;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;

/// The recipe with the book's own arithmetic.
pub fn by_the_book(recipe: &Recipe) -> Recipe {
    Recipe { rules: Rules { surface: SurfaceRule::Book, ..recipe.rules }, ..recipe.clone() }
}

/// How often a case and its tame twin are timed; the fastest of each counts.
const TURNS: usize = 5;

/// Time limit for these repetitions, seconds.
const TURNS_TIME: f64 = 0.6;

/// Larger scenes are not checked ray by ray, because each ray is tested against all spheres.
const CHECKED_SPHERES: usize = 5000;

/// Number of pixels per axis whose first ray is checked.
const CHECKED_PIXELS: u32 = 8;

/// Allowed error of the distance of a hit, relative to that distance and to the distance of focus.
const DISTANCE_TOLERANCE: f64 = 1e-5;

/// Checks rays from the eye with 106-bit arithmetic.
fn first_hits(recipe: &Recipe) -> Option<FirstHits> {
    let job = recipe.job().ok()?;
    let has_lens = recipe.camera.defocus_angle_degrees > 0.0;
    if has_lens || recipe.scene.spheres.len() > CHECKED_SPHERES {
        return None;
    }
    let isa = *Isa::available().last()?;
    let [width, height] = [job.settings().width, job.settings().height];
    let eye = outside(&recipe.scene, recipe.camera.look_from);
    let margin = DISTANCE_TOLERANCE * recipe.camera.effective_focus_distance();
    let mut found = FirstHits { rays: 0, agree: 0 };
    // If the tracer panics, its pictures have already shown that.
    let recorder = catch_unwind(|| PathRecorder::new(&job, isa, None)).ok()?;
    for step in 0..CHECKED_PIXELS * CHECKED_PIXELS {
        let share = |step: u32, pixels: u32| step * pixels / CHECKED_PIXELS;
        let pixel = [share(step % CHECKED_PIXELS, width), share(step / CHECKED_PIXELS, height)];
        let record = catch_unwind(AssertUnwindSafe(|| recorder.record(pixel, 0))).ok()?;
        let Some(ray) = record.rays.first() else { continue };
        let exact = first_hit(&recipe.scene, eye, DVec3::from_array(ray.direction));
        found.rays += 1;
        let hit = ray.hit.map(|hit| hit.distance);
        found.agree += usize::from(agrees(hit, exact.map(|(_, distance)| distance), margin));
    }
    Some(found)
}

/// Whether the distance of a hit is the exact one, or both rays hit nothing.
fn agrees(hit: Option<f64>, exact: Option<f64>, margin: f64) -> bool {
    match (hit, exact) {
        (Some(hit), Some(exact)) => (hit - exact).abs() <= DISTANCE_TOLERANCE * exact + margin,
        (hit, exact) => hit.is_none() && exact.is_none(),
    }
}

/// The eye; if `f64` cannot tell it from a surface, it is moved outside by the smallest distance that `f64` can tell.
fn outside(scene: &Scene, eye: DVec3) -> DVec3 {
    let mut outside = eye;
    for sphere in &scene.spheres {
        let away = eye - sphere.center;
        let digits =
            f64::EPSILON * (eye.abs().max_element() + sphere.center.abs().max_element() + sphere.radius);
        if (away.length() - sphere.radius).abs() <= 4.0 * digits {
            outside = sphere.center + (sphere.radius + 8.0 * digits) * away.normalize();
        }
    }
    outside
}

/// The backends under test and the reference to compare them with.
pub struct Suite {
    backends: Vec<Backend>,
    reference: Backend,
    /// Films of scenes that several cases share, by backend index (`None`: the reference) and name.
    shared: HashMap<(Option<usize>, String), Result<Film, String>>,
}

impl Suite {
    /// The reference is tested like the others. The first backend also renders the book's arithmetic in `f32`.
    pub fn new(backends: Vec<Backend>, reference: Backend) -> Self {
        Suite { backends, reference, shared: HashMap::new() }
    }

    /// Names of the backends under test, the reference last.
    pub fn names(&self) -> Vec<String> {
        self.backends.iter().chain([&self.reference]).map(|backend| backend.name.clone()).collect()
    }

    /// Runs a case in all its forms on all backends, and with the book's arithmetic.
    pub fn run(&mut self, case: &Case, interrupt: &AtomicBool) -> CaseReport {
        let mut measured = Vec::new();
        let mut oracle: Result<Film, String> = Err("the f64 reference has no picture".to_owned());
        for form in case.forms() {
            let recipe = case.recipe_in(*form);
            let exact = self.reference.trace(&recipe, interrupt);
            if let (Form::Plain, Ok(exact)) = (form, &exact) {
                oracle = Ok(exact.film.clone());
            }
            for index in 0..self.backends.len() {
                let traced = self.backends[index].trace(&recipe, interrupt);
                let found =
                    self.measure(case, Some(index), *form, &traced, &oracle, exact.as_ref().ok(), interrupt);
                measured.push(found);
            }
            measured.push(self.measure(case, None, *form, &exact, &oracle, None, interrupt));
        }
        CaseReport {
            id: case.id.clone(),
            family: case.family.title,
            stiff: case.stiff.clone(),
            expected: case.expected.to_string(),
            why: case.expected.why(),
            tolerance: case.tolerance,
            spheres: case.recipe.scene.spheres.len(),
            first_hits: first_hits(&case.recipe),
            book: self.book(case, &oracle, interrupt),
            measured,
        }
    }

    /// Measures a film of `backend`; `None` stands for the reference.
    fn measure(
        &mut self,
        case: &Case,
        backend: Option<usize>,
        form: Form,
        traced: &Result<Traced, String>,
        oracle: &Result<Film, String>,
        exact: Option<&Traced>,
        interrupt: &AtomicBool,
    ) -> Measured {
        let name = match backend {
            Some(index) => self.backends[index].name.clone(),
            None => self.reference.name.clone(),
        };
        let mut measured = Measured {
            backend: name,
            form: form.name(),
            mean: None,
            offset: None,
            deviation: None,
            rounding: None,
            seconds: None,
            tame_seconds: None,
            verdict: Verdict::Right,
        };
        let traced = match traced {
            Ok(traced) => traced,
            Err(reason) => {
                measured.verdict = Verdict::None(reason.clone());
                return measured;
            }
        };
        let level = Level::of(&traced.film);
        measured.mean = Some(level.grey());
        measured.deviation = Some(level.deviation);
        measured.seconds = Some(traced.seconds);
        measured.rounding = exact.map(|exact| Paired::of(&traced.film, &exact.film));
        if let (Some(tame), Form::Plain) = (&case.tame, form) {
            let (seconds, tame) = self.times(backend, [&case.recipe, tame], traced.seconds, interrupt);
            measured.seconds = Some(seconds);
            measured.tame_seconds = tame;
        }
        match self.against(case, backend, &traced.film, oracle, interrupt) {
            Ok(against) => {
                measured.offset = Some(offset(&level, against));
                let verdict = judge(&level, against, case.tolerance, traced.film.rejected());
                let seconds = measured.seconds.unwrap_or(traced.seconds);
                measured.verdict =
                    judge_time(verdict, seconds, measured.tame_seconds).given(&traced.warnings);
            }
            Err(reason) => measured.verdict = Verdict::None(reason),
        }
        measured
    }

    /// Shortest times of a picture and its tame twin, taken in turns: other load on the machine can only add time.
    fn times(
        &mut self,
        backend: Option<usize>,
        [recipe, tame]: [&Recipe; 2],
        first: f64,
        interrupt: &AtomicBool,
    ) -> (f64, Option<f64>) {
        let tracer = match backend {
            Some(index) => &mut self.backends[index],
            None => &mut self.reference,
        };
        // The first picture may have had to wait for a kernel.
        let (mut least, mut least_tame, mut spent) = (first, None::<f64>, 0.0);
        for _ in 0..TURNS {
            let Ok(of_tame) = tracer.trace(tame, interrupt) else { break };
            least_tame = Some(least_tame.map_or(of_tame.seconds, |least| least.min(of_tame.seconds)));
            spent += of_tame.seconds;
            let Ok(again) = tracer.trace(recipe, interrupt) else { break };
            least = least.min(again.seconds);
            spent += again.seconds;
            if spent > TURNS_TIME {
                break;
            }
        }
        (least, least_tame)
    }

    /// What the film of a backend is compared with.
    fn against(
        &mut self,
        case: &Case,
        backend: Option<usize>,
        film: &Film,
        oracle: &Result<Film, String>,
        interrupt: &AtomicBool,
    ) -> Result<Against, String> {
        Ok(match &case.expected {
            Expected::Every { value, .. } => Against::Every(*value),
            Expected::Mean { value, .. } => Against::Mean(*value),
            Expected::Same { other, .. } => {
                let other = self.shared(backend, other, interrupt)?;
                Against::Picture(Paired::of(film, &other))
            }
            Expected::Reference { .. } => {
                Against::Picture(Paired::of(film, oracle.as_ref().map_err(Clone::clone)?))
            }
        })
    }

    /// The picture of a scene that several cases share, rendered once.
    fn shared(
        &mut self,
        backend: Option<usize>,
        recipe: &Recipe,
        interrupt: &AtomicBool,
    ) -> Result<Film, String> {
        let key = (backend, recipe.name.clone());
        if let Some(known) = self.shared.get(&key) {
            return known.clone();
        }
        let tracer = match backend {
            Some(index) => &mut self.backends[index],
            None => &mut self.reference,
        };
        let found = tracer.trace(recipe, interrupt).map(|traced| traced.film);
        self.shared.insert(key, found.clone());
        found
    }

    /// The book's own arithmetic, in `f32` on the first backend and in `f64`.
    fn book(
        &mut self,
        case: &Case,
        oracle: &Result<Film, String>,
        interrupt: &AtomicBool,
    ) -> Vec<BookMeasured> {
        let recipe = by_the_book(&case.recipe);
        let mut traced = Vec::new();
        if let Some(first) = self.backends.first_mut() {
            traced.push(("f32", first.trace(&recipe, interrupt)));
        }
        traced.push(("f64", self.reference.trace(&recipe, interrupt)));
        let measure = |(precision, traced): (&'static str, Result<Traced, String>)| {
            let (mean, offset, verdict) = match traced {
                Ok(traced) => {
                    let level = Level::of(&traced.film);
                    // Compared with our own picture of the other scene, which is right, not with the book's.
                    match self.against(case, None, &traced.film, oracle, interrupt) {
                        Ok(against) => {
                            let rejected = traced.film.rejected();
                            let verdict = judge(&level, against, case.tolerance, rejected);
                            (Some(level.grey()), Some(offset(&level, against)), verdict)
                        }
                        Err(reason) => (Some(level.grey()), None, Verdict::None(reason)),
                    }
                }
                Err(reason) => (None, None, Verdict::None(reason)),
            };
            BookMeasured { precision, mean, offset, verdict }
        };
        traced.into_iter().map(measure).collect()
    }
}

#[cfg(test)]
mod tests;
