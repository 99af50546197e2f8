//! A backend that can record a path.

use crate::backends::BackendChoice;
use crate::film::Film;
use crate::job::render::{RenderError, RenderJob, Renderer};
use crate::kernel::path_record::PathRecord;
use crate::render_cpu::{CpuRenderer, Isa, record_path};
use crate::render_gpu::GpuRenderer;
use anyhow::{Result, anyhow, bail};
use std::sync::atomic::AtomicBool;

/// One of the two backends compared.
pub struct Side {
    /// Short name for sentences: `cpu avx2`.
    pub name: String,
    /// Full name, with adapter and precision.
    pub about: String,
    tracer: Tracer,
}

enum Tracer {
    /// With the recorder's level; `None` for the reference.
    Cpu(Box<CpuRenderer>, Option<Isa>),
    Gpu(Box<GpuRenderer>),
}

impl Side {
    /// Starts a backend. If it is unavailable, the error lists the alternatives.
    pub fn open(choice: &BackendChoice) -> Result<Self> {
        let (name, about, tracer) = match choice {
            BackendChoice::Cpu(options) => {
                let renderer = Box::new(CpuRenderer::new(*options)?);
                let best = Isa::available().last().copied().unwrap_or(Isa::Portable);
                let isa = options.isa.unwrap_or(best);
                let rounding = if isa.is_fused() { "rounded once" } else { "rounded separately" };
                let about = format!("cpu {isa}, f32, multiply and add {rounding}");
                (format!("cpu {isa}"), about, Tracer::Cpu(renderer, Some(isa)))
            }
            BackendChoice::Reference { threads } => {
                let tracer = Tracer::Cpu(Box::new(CpuRenderer::reference(*threads)?), None);
                ("reference".to_owned(), "reference, f64 on the CPU".to_owned(), tracer)
            }
            BackendChoice::Gpu(options) => {
                let renderer = GpuRenderer::new(options.clone()).map_err(|reason| {
                    anyhow!(
                        "the side gpu is not available: {reason}; compare other sides, such as --sides cpu,reference or \
                         --sides cpu,portable"
                    )
                })?;
                let about = format!("gpu, {}", renderer.adapter());
                ("gpu".to_owned(), about, Tracer::Gpu(Box::new(renderer)))
            }
            BackendChoice::Both(..) => bail!("a side is one backend, not two"),
        };
        Ok(Side { name, about, tracer })
    }

    /// Records a path; `pixel` must be inside the picture.
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
