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
