//! The one loop in which the command line watches a render: pictures, frames of animations, and figures.

use crate::backends::{self, BackendChoice};
use crate::film::Film;
use crate::job::render::{RenderJob, Renderer, panic_text};
use crate::progressive::{Phase, Plan, Progressive, RenderRequest, Status, Stop};
use crate::system::failure::Failure;
use crate::system::interrupt::Interrupt;
use anyhow::Context;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Renders one picture after another with one backend.
pub struct Studio<'a> {
    backend: &'a BackendChoice,
    renderer: Option<Box<dyn Renderer>>,
    progressive: Progressive,
    interrupt: &'a Interrupt,
}

impl<'a> Studio<'a> {
    /// Makes the renderer and starts the render thread.
    ///
    /// # Errors
    /// [`Failure::Input`] if the backend is not available.
    pub fn open(backend: &'a BackendChoice, interrupt: &'a Interrupt) -> Result<Self, Failure> {
        let renderer = Some(backends::create(backend).map_err(Failure::input)?);
        let progressive =
            Progressive::spawn().context("cannot start the render thread").map_err(Failure::Run)?;
        Ok(Studio { backend, renderer, progressive, interrupt })
    }

    /// A plan for this many samples per pixel, in passes for an unattended render.
    pub fn plan(samples: u64) -> Plan {
        Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(Stop::at_samples(samples)) }
    }

    /// Renders a picture, or continues its `film`, until the plan ends or a signal arrives. `look` sees the state, at
    /// least once per [`Progressive::LOOK`]. Returns the last status and the film so far. A panic in `look` ends the
    /// render as a failure.
    pub fn render(
        &mut self,
        job: RenderJob,
        plan: Plan,
        film: Option<Film>,
        mut look: impl FnMut(&Progressive, &Status),
    ) -> (Status, Option<Film>) {
        let Studio { backend, renderer, progressive, interrupt } = self;
        let backend = (*backend).clone();
        let request = RenderRequest { job, backend, renderer: renderer.take(), plan, film };
        let mut is_stopping = false;
        let watched = catch_unwind(AssertUnwindSafe(|| {
            progressive.watch(request, |progressive, status| {
                if interrupt.is_set() && !is_stopping && !status.phase.is_over() {
                    is_stopping = true;
                    progressive.stop();
                }
                look(progressive, status);
            })
        }));
        let status = watched.unwrap_or_else(|payload| {
            progressive.stop();
            while progressive.status().phase.is_working() {
                progressive.wait(Progressive::LOOK);
            }
            let phase = Phase::Failed(format!("the program failed ({})", panic_text(payload.as_ref())));
            Status { phase, ..progressive.status() }
        });
        (status, progressive.take_film())
    }
}

#[cfg(test)]
impl<'a> Studio<'a> {
    /// A studio whose renderers `factory` makes.
    pub(crate) fn with_factory(
        factory: crate::progressive::Factory,
        backend: &'a BackendChoice,
        interrupt: &'a Interrupt,
    ) -> Self {
        let progressive = Progressive::with_factory(factory).unwrap();
        Studio { backend, renderer: None, progressive, interrupt }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_the_onlooker_ends_the_render_and_keeps_its_film() {
        let flags = ["--samples", "4294967295", "--device", "cpu"];
        let options = crate::batch::tests::options(&flags);
        let interrupt = Interrupt::unheard();
        let Ok(mut studio) = Studio::open(&options.backend, &interrupt) else { panic!("no CPU") };
        let (status, film) = studio.render(options.job.clone(), options.plan.clone(), None, |_, status| {
            assert!(status.samples_per_pixel == 0, "a slip of the onlooker");
        });
        let reason = match status.phase {
            Phase::Failed(reason) => reason,
            phase => panic!("{phase:?}"),
        };
        assert!(reason.contains("a slip of the onlooker"), "{reason}");
        assert!(film.is_some_and(|film| film.sample_count() > 0));
    }
}
