//! A backend under test: renders pictures and survives whatever goes wrong in one.

use crate::backends::{self, BackendChoice, BackendError};
use crate::film::Film;
use crate::recipe::Recipe;
use crate::render::{RenderError, RenderJob, Renderer};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time limit for one picture.
const TIME_LIMIT: Duration = Duration::from_secs(20);

/// How often the time limit and the user's interrupt are checked.
const GLANCE: Duration = Duration::from_millis(50);

/// A backend and its name in the tables.
pub struct Backend {
    /// Its name in the tables.
    pub name: String,
    choice: BackendChoice,
    /// `None` before the first picture, and after a picture that broke it.
    renderer: Option<Box<dyn Renderer>>,
}

/// A rendered picture, its time and its warnings.
#[derive(Clone)]
pub struct Traced {
    /// The film, with all samples of the recipe.
    pub film: Film,
    /// Wall time to prepare and trace, seconds.
    pub seconds: f64,
    /// What the backend warned about: parts of the scene that it cannot represent.
    pub warnings: Vec<String>,
}

impl Backend {
    /// A backend that starts when it is first used.
    pub fn new(name: impl Into<String>, choice: BackendChoice) -> Self {
        Backend { name: name.into(), choice, renderer: None }
    }

    /// Starts the backend unless it is already running.
    ///
    /// # Errors
    /// If the backend is not available.
    pub fn start(&mut self) -> Result<(), BackendError> {
        if self.renderer.is_none() {
            let mut renderer = backends::create(&self.choice)?;
            // Whoever named a software adapter knows that it is one; later messages are about scenes.
            drop(renderer.take_messages());
            self.renderer = Some(renderer);
        }
        Ok(())
    }

    /// Traces all samples of a picture.
    ///
    /// # Errors
    /// A sentence that says why there is no picture: it was refused, failed, panicked or took too long.
    pub fn trace(&mut self, recipe: &Recipe, interrupt: &AtomicBool) -> Result<Traced, String> {
        let job = recipe.job().map_err(|error| format!("refused: {error}"))?;
        self.start().map_err(|error| error.to_string())?;
        // Taken out, so that a renderer that panics is not used again.
        let Some(mut renderer) = self.renderer.take() else { return Err("it did not start".to_owned()) };
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            within_time(interrupt, |cancel| {
                accumulate(&mut *renderer, &job, recipe.samples_per_pixel, cancel)
            })
        }));
        let seconds = begin.elapsed().as_secs_f64();
        let film = match outcome {
            Ok(Ok(film)) => film,
            Ok(Err(RenderError::Cancelled)) if interrupt.load(Ordering::Relaxed) => {
                return Err("interrupted".to_owned());
            }
            Ok(Err(RenderError::Cancelled)) => {
                return Err(format!("took more than {} s", TIME_LIMIT.as_secs()));
            }
            Ok(Err(error)) => return Err(error.to_string()),
            Err(_) => return Err("the tracer panicked".to_owned()),
        };
        let warnings = renderer.take_messages();
        self.renderer = Some(renderer);
        let (held, wanted) = (film.sample_count(), recipe.samples_per_pixel);
        if held != wanted {
            return Err(format!("the film holds {held} samples per pixel instead of {wanted}"));
        }
        Ok(Traced { film, seconds, warnings })
    }
}

#[cfg(test)]
impl Backend {
    /// A backend that renders with `renderer` until that breaks, and then like the reference.
    pub(super) fn of_renderer(name: &str, renderer: Box<dyn Renderer>) -> Self {
        let choice = BackendChoice::Reference { threads: Some(1) };
        Backend { name: name.to_owned(), choice, renderer: Some(renderer) }
    }
}

fn accumulate(
    renderer: &mut dyn Renderer,
    job: &RenderJob,
    samples: u64,
    cancel: &AtomicBool,
) -> Result<Film, RenderError> {
    let mut film = job.new_film();
    renderer.accumulate(job, 0..samples, &mut film, cancel)?;
    Ok(film)
}

/// Runs `work` with a flag that is set when the time limit has passed or the user interrupts.
fn within_time<T>(interrupt: &AtomicBool, work: impl FnOnce(&AtomicBool) -> T) -> T {
    let cancel = AtomicBool::new(false);
    let begin = Instant::now();
    std::thread::scope(|scope| {
        let (done, is_done) = channel::<()>();
        let cancel = &cancel;
        scope.spawn(move || {
            while is_done.recv_timeout(GLANCE) == Err(RecvTimeoutError::Timeout) {
                if interrupt.load(Ordering::Relaxed) || begin.elapsed() > TIME_LIMIT {
                    cancel.store(true, Ordering::Relaxed);
                }
            }
        });
        // Dropped when the work ends, even by a panic.
        let _done = done;
        work(cancel)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::families::build::{one_ball, sized};
    use crate::stress::painted::{fill, painted};

    #[test]
    fn what_cannot_be_traced_is_said_and_the_next_picture_is_traced() {
        let go_on = AtomicBool::new(false);
        let mut backend = Backend::new("reference", BackendChoice::Reference { threads: Some(1) });
        let mut refused = one_ball();
        refused.camera.look_at = refused.camera.look_from;
        let reason = backend.trace(&refused, &go_on).err().unwrap();
        assert!(reason.starts_with("refused: look_from and look_at are both"), "{reason}");
        let traced = backend.trace(&sized(one_ball(), [2, 2], 2), &go_on).unwrap();
        assert_eq!((traced.film.sample_count(), traced.film.mean(3)), (2, [0.5; 3]));
    }

    #[test]
    fn a_renderer_that_broke_is_said_to_and_not_used_again() {
        let small = sized(one_ball(), [2, 2], 4);
        let cancelled = || Err(RenderError::Cancelled);
        let failed = || Err(RenderError::Backend { backend: "cpu", reason: "it is gone".to_owned() });
        let broken: [(Backend, bool, &str); 4] = [
            (painted("a", |_, _, _| panic!("on purpose")), false, "the tracer panicked"),
            (painted("b", move |_, _, _| cancelled()), false, "took more than 20 s"),
            (painted("c", move |_, _, _| cancelled()), true, "interrupted"),
            (painted("d", move |_, _, _| failed()), false, "cpu failed: it is gone"),
        ];
        for (mut backend, is_interrupted, expected) in broken {
            let reason = backend.trace(&small, &AtomicBool::new(is_interrupted)).err();
            assert_eq!(reason.as_deref(), Some(expected));
            // The reference takes its place.
            let traced = backend.trace(&small, &AtomicBool::new(false)).unwrap();
            assert_eq!((traced.film.sample_count(), traced.film.mean(3)), (4, [0.5; 3]), "{expected}");
        }
    }

    #[test]
    fn a_film_must_hold_all_samples_and_warnings_belong_to_their_picture() {
        let go_on = AtomicBool::new(false);
        let mut backend = painted("some", |job, samples, film| {
            // The last sample is left out if paths are short.
            fill(film, if job.settings().max_depth < 9 { 0..samples.end - 1 } else { samples }, 0.25)?;
            Ok(if job.settings().max_depth > 50 { vec!["deep".to_owned()] } else { Vec::new() })
        });
        let mut traced = |max_depth: u32| {
            let mut recipe = sized(one_ball(), [2, 2], 6);
            recipe.settings.max_depth = max_depth;
            backend.trace(&recipe, &go_on)
        };
        let deep = traced(60).unwrap();
        assert_eq!((deep.warnings, deep.film.mean(0)), (vec!["deep".to_owned()], [0.25; 3]));
        assert_eq!(traced(50).unwrap().warnings, [""; 0]);
        let told = traced(8).err();
        assert_eq!(told.as_deref(), Some("the film holds 5 samples per pixel instead of 6"));
        assert!(traced(9).is_ok());
    }

    #[test]
    fn the_flag_is_set_when_an_end_is_wanted() {
        let interrupt = AtomicBool::new(true);
        let was_set = within_time(&interrupt, |cancel| {
            let begin = Instant::now();
            while !cancel.load(Ordering::Relaxed) && begin.elapsed() < Duration::from_secs(10) {
                std::thread::sleep(Duration::from_millis(5));
            }
            cancel.load(Ordering::Relaxed)
        });
        assert!(was_set);
    }
}
