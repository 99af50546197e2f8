//! A candidate: a backend or the plain C program. It survives the failure of a picture.

use super::baseline::Baseline;
use crate::backends::{self, BackendChoice};
use crate::film::Film;
use crate::job::render::{BackendInfo, RenderJob, Renderer, Stats};
use anyhow::{Result, anyhow, ensure};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

pub struct Candidate {
    pub name: String,
    /// `None` is the plain C program.
    backend: Option<BackendChoice>,
    /// `None` before the first picture and after a failure.
    renderer: Option<Box<dyn Renderer>>,
}

/// A film and its measurements.
pub struct Traced {
    pub film: Film,
    pub stats: Stats,
    /// Wall time to prepare and trace.
    pub seconds: f64,
    /// Parts of the scene that the backend cannot represent.
    pub warnings: Vec<String>,
}

impl Candidate {
    /// A backend, or the plain C program, which starts on first use.
    pub fn new(name: impl Into<String>, backend: impl Into<Option<BackendChoice>>) -> Self {
        Candidate { name: name.into(), backend: backend.into(), renderer: None }
    }

    pub fn is_baseline(&self) -> bool {
        self.backend.is_none()
    }

    /// Starts the backend unless it is running. Fails if it is unavailable.
    pub fn start(&mut self) -> Result<&mut dyn Renderer> {
        match &mut self.renderer {
            Some(renderer) => Ok(renderer.as_mut()),
            none => {
                let mut renderer: Box<dyn Renderer> = match &self.backend {
                    Some(choice) => backends::create(choice)?,
                    None => Box::new(Baseline::compile()?),
                };
                // Whoever named a software adapter knows what it is; later messages are about scenes.
                drop(renderer.take_messages());
                Ok(none.insert(renderer).as_mut())
            }
        }
    }

    /// `None` unless it is running.
    pub fn info(&self) -> Option<BackendInfo> {
        self.renderer.as_ref().map(|renderer| renderer.info())
    }

    /// An empty film; the C program's has a single half, so no error estimate.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn new_film(&self, job: &RenderJob) -> Result<Film> {
        let film = job.new_film();
        Ok(if self.is_baseline() { film.try_blank()? } else { film })
    }

    /// Adds samples to a film. Fails if `cancel` is set, too. A failed renderer is replaced for the next picture.
    pub fn add(
        &mut self,
        job: &RenderJob,
        samples: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats> {
        let renderer = self.start()?;
        let outcome = catch_unwind(AssertUnwindSafe(|| renderer.accumulate(job, samples, film, cancel)));
        if !matches!(outcome, Ok(Ok(_))) {
            self.renderer = None;
        }
        Ok(outcome.map_err(|_| anyhow!("the tracer panicked"))??)
    }

    /// Traces a new film.
    pub fn trace(&mut self, job: &RenderJob, samples: u64, cancel: &AtomicBool) -> Result<Traced> {
        self.start()?;
        let mut film = self.new_film(job)?;
        let begin = Instant::now();
        let stats = self.add(job, 0..samples, &mut film, cancel)?;
        let seconds = begin.elapsed().as_secs_f64();
        let warnings = self.start()?.take_messages();
        let held = film.sample_count();
        ensure!(held == samples, "the film holds {held} samples per pixel instead of {samples}");
        Ok(Traced { film, stats, seconds, warnings })
    }
}

#[cfg(test)]
impl Candidate {
    /// Renders with `renderer` until it fails, then with the reference.
    pub(super) fn of_renderer(name: &str, renderer: Box<dyn Renderer>) -> Self {
        let backend = Some(BackendChoice::Reference { threads: Some(1) });
        Candidate { name: name.to_owned(), backend, renderer: Some(renderer) }
    }
}
