//! A candidate: a backend of this program, or the plain C program. It survives whatever goes wrong in a picture.

use super::baseline::Baseline;
use crate::backends::{self, BackendChoice};
use crate::film::Film;
use crate::job::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};
use anyhow::Result;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What traces a candidate's pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    Backend(BackendChoice),
    /// The plain C program.
    C89,
}

impl Source {
    fn create(&self) -> Result<Box<dyn Renderer>> {
        Ok(match self {
            Source::Backend(choice) => backends::create(choice)?,
            Source::C89 => Box::new(Baseline::compile()?),
        })
    }
}

pub struct Candidate {
    /// Its name in tables.
    pub name: String,
    source: Source,
    /// `None` before the first picture, and after one that failed.
    renderer: Option<Box<dyn Renderer>>,
}

/// A film and how it came about.
pub struct Traced {
    pub film: Film,
    pub stats: Stats,
    /// Wall time to prepare and trace.
    pub seconds: f64,
    /// What the backend warned about: parts of the scene that it cannot represent.
    pub warnings: Vec<String>,
}

/// Why there is no film.
#[derive(Debug, PartialEq, Eq)]
pub enum Stop {
    Cancelled,
    Failed(String),
}

impl From<RenderError> for Stop {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Cancelled => Stop::Cancelled,
            error => Stop::Failed(error.to_string()),
        }
    }
}

impl From<anyhow::Error> for Stop {
    fn from(error: anyhow::Error) -> Self {
        Stop::Failed(format!("{error:#}"))
    }
}

impl Candidate {
    /// A candidate that starts when it is first used.
    pub fn new(name: impl Into<String>, source: Source) -> Self {
        Candidate { name: name.into(), source, renderer: None }
    }

    pub fn backend(name: impl Into<String>, choice: BackendChoice) -> Self {
        Candidate::new(name, Source::Backend(choice))
    }

    pub fn is_baseline(&self) -> bool {
        self.source == Source::C89
    }

    /// Starts it unless it is running.
    ///
    /// # Errors
    /// If it is not available.
    pub fn start(&mut self) -> Result<&mut dyn Renderer> {
        let renderer = self.take()?;
        Ok(self.renderer.insert(renderer).as_mut())
    }

    fn take(&mut self) -> Result<Box<dyn Renderer>> {
        if let Some(renderer) = self.renderer.take() {
            return Ok(renderer);
        }
        let mut renderer = self.source.create()?;
        // Whoever named a software adapter knows that it is one; later messages are about scenes.
        drop(renderer.take_messages());
        Ok(renderer)
    }

    /// `None` unless it is running.
    pub fn info(&self) -> Option<BackendInfo> {
        self.renderer.as_ref().map(|renderer| renderer.info())
    }

    /// An empty film. That of the C program has no halves to estimate the error from.
    pub fn new_film(&self, job: &RenderJob) -> Film {
        if self.is_baseline() {
            Film::new(job.settings().width, job.settings().height, 1)
        } else {
            job.new_film()
        }
    }

    /// Adds samples to a film. After a failure, the next picture gets a new renderer.
    ///
    /// # Errors
    /// [`Stop`]
    pub fn add(
        &mut self,
        job: &RenderJob,
        samples: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, Stop> {
        let mut renderer = self.take()?;
        let outcome = catch_unwind(AssertUnwindSafe(|| renderer.accumulate(job, samples, film, cancel)));
        let stats = outcome.map_err(|_| Stop::Failed("the tracer panicked".to_owned()))??;
        self.renderer = Some(renderer);
        Ok(stats)
    }

    /// Traces a new film with this many samples per pixel.
    ///
    /// # Errors
    /// [`Stop`]
    pub fn trace(&mut self, job: &RenderJob, samples: u64, cancel: &AtomicBool) -> Result<Traced, Stop> {
        self.start()?;
        let mut film = self.new_film(job);
        let begin = Instant::now();
        let stats = self.add(job, 0..samples, &mut film, cancel)?;
        let seconds = begin.elapsed().as_secs_f64();
        let warnings = self.start()?.take_messages();
        if film.sample_count() != samples {
            let held = film.sample_count();
            return Err(Stop::Failed(format!(
                "the film holds {held} samples per pixel instead of {samples}"
            )));
        }
        Ok(Traced { film, stats, seconds, warnings })
    }
}

#[cfg(test)]
impl Candidate {
    /// Renders with `renderer` until that fails, and then like the reference.
    pub(super) fn of_renderer(name: &str, renderer: Box<dyn Renderer>) -> Self {
        let source = Source::Backend(BackendChoice::Reference { threads: Some(1) });
        Candidate { name: name.to_owned(), source, renderer: Some(renderer) }
    }
}
