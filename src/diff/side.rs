//! A backend that can record what it does along a path.

use crate::cli::SideChoice;
use crate::film::Film;
use crate::record::PathRecord;
use crate::render::{RenderError, RenderJob, Renderer};
use crate::render_cpu::{CpuError, CpuRenderer, Isa, record_path};
use crate::render_gpu::{GpuError, GpuRenderer};
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// One of the two backends that are compared.
pub struct Side {
    /// Short name for sentences: `cpu avx2`.
    pub name: String,
    /// Long name, with adapter and precision.
    pub about: String,
    tracer: Tracer,
}

enum Tracer {
    /// The level is that of the recorder; `None` is the reference.
    Cpu(Box<CpuRenderer>, Option<Isa>),
    Gpu(Box<GpuRenderer>),
}

/// Why a side is not available.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum SideError {
    /// The CPU cannot fulfil the options.
    #[error(transparent)]
    Cpu(#[from] CpuError),
    /// No GPU is available.
    #[error(
        "the side gpu is not available: {reason}; compare other sides, such as --sides cpu,reference or --sides cpu,portable"
    )]
    Gpu {
        /// The reason, with the adapters that exist.
        reason: GpuError,
    },
}

impl Side {
    /// Starts a side.
    ///
    /// # Errors
    /// [`SideError`], which says what is available instead.
    pub fn open(choice: &SideChoice) -> Result<Self, SideError> {
        Ok(match choice {
            SideChoice::Cpu(options) => {
                let renderer = CpuRenderer::new(*options)?;
                let best = Isa::available().last().copied().unwrap_or(Isa::Portable);
                let isa = options.isa.unwrap_or(best);
                let rounding = if isa.is_fused() { "rounded once" } else { "rounded separately" };
                Side {
                    name: format!("cpu {isa}"),
                    about: format!("cpu {isa}, f32, multiply and add {rounding}"),
                    tracer: Tracer::Cpu(Box::new(renderer), Some(isa)),
                }
            }
            SideChoice::Reference => Side {
                name: "reference".to_owned(),
                about: "reference, f64 on the CPU".to_owned(),
                tracer: Tracer::Cpu(Box::new(CpuRenderer::reference(None)?), None),
            },
            SideChoice::Gpu(options) => {
                let renderer =
                    GpuRenderer::new(options.clone()).map_err(|reason| SideError::Gpu { reason })?;
                Side {
                    name: "gpu".to_owned(),
                    about: format!("gpu, {}", renderer.adapter()),
                    tracer: Tracer::Gpu(Box::new(renderer)),
                }
            }
        })
    }

    /// Records a path; `pixel` must be inside the picture.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    pub fn record(
        &mut self,
        job: &RenderJob,
        pixel: [u32; 2],
        sample: u64,
    ) -> Result<PathRecord, RenderError> {
        match &mut self.tracer {
            Tracer::Cpu(_, isa) => Ok(record_path(job, pixel, sample, *isa)),
            Tracer::Gpu(renderer) => renderer.record_path(job, pixel, sample),
        }
    }

    /// Renders one sample of every pixel.
    ///
    /// # Errors
    /// [`RenderError`].
    pub fn film(&mut self, job: &RenderJob, sample: u64) -> Result<Film, RenderError> {
        let settings = job.settings();
        let mut film = Film::try_new(settings.width, settings.height, settings.half_count())?;
        let renderer: &mut dyn Renderer = match &mut self.tracer {
            Tracer::Cpu(renderer, _) => renderer.as_mut(),
            Tracer::Gpu(renderer) => renderer.as_mut(),
        };
        renderer.accumulate(job, sample..sample + 1, &mut film, &AtomicBool::new(false))?;
        Ok(film)
    }
}
