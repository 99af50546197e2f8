//! For tests: a backend whose pictures are made up.

use super::backend::Backend;
use crate::film::{Film, fixed_point};
use crate::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};
use std::ops::Range;
use std::sync::atomic::AtomicBool;

/// Adds samples to a film and returns what the user is warned about.
type Paint = dyn FnMut(&RenderJob, Range<u64>, &mut Film) -> Result<Vec<String>, RenderError> + Send;

struct Painter {
    paint: Box<Paint>,
    messages: Vec<String>,
}

impl Renderer for Painter {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "painter", device: String::new(), lanes: 1, threads: 1 }
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        samples: Range<u64>,
        film: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.messages = (self.paint)(job, samples, film)?;
        Ok(Stats::default())
    }
}

/// A backend that paints.
pub fn painted(
    name: &str,
    paint: impl FnMut(&RenderJob, Range<u64>, &mut Film) -> Result<Vec<String>, RenderError> + Send + 'static,
) -> Backend {
    Backend::of_renderer(name, Box::new(Painter { paint: Box::new(paint), messages: Vec::new() }))
}

/// A backend all of whose samples of a job have this radiance.
pub fn grey(name: &str, radiance: impl Fn(&RenderJob) -> f64 + Send + 'static) -> Backend {
    painted(name, move |job, samples, film| {
        fill(film, samples, radiance(job))?;
        Ok(Vec::new())
    })
}

/// Adds samples of this radiance to all pixels of an empty film.
///
/// # Errors
/// If the film cannot hold them.
pub fn fill(film: &mut Film, samples: Range<u64>, radiance: f64) -> Result<(), RenderError> {
    film.record(samples, 0)?;
    for half in 0..film.halves().len() {
        let count = film.half_sample_count(half) as f64;
        let sum = fixed_point([count * radiance; 3]).unwrap_or_default();
        film.halves_mut()[half].fill(sum);
    }
    Ok(())
}
