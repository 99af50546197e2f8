//! The GPU backend: a path tracer in one compute kernel, the twin of the CPU's tracer.
//!
//! `shaders/` contains the functions, in files with the same names as in `src/render_cpu/`. This module opens an
//! adapter, specialises the kernel to the job, sizes dispatches by measured time and adds the resulting sums to the
//! film. Sample indices, random numbers and fixed-point sums match the CPU's to the bit.

mod adapter;
mod device;
mod dispatches;
mod film_buffers;
mod kernel;
pub mod layout;
mod loaded;
mod options;
mod readback;
mod scene;
mod schedule;
pub mod shader_source;
mod trace;

#[cfg(test)]
pub(crate) use adapter::tests;
pub use adapter::{AdapterInfo, BUSY_THREADS_OF_SOFTWARE, SOFTWARE_THREADS_IN_STEP, adapters};
pub use options::{BATCH_TARGET, GpuError, GpuOptions, GpuReport, INTERACTIVE_TARGET};
pub use scene::{Exported, ITERATION_LIMIT, SHARED_BLOCK};
pub use schedule::{BUDGET_LIMITS, FIRST_PATHS, GROWTH_LIMIT};

use crate::film::Film;
use crate::job::render::{
    BackendInfo, Control, Diagnostics, KernelInfo, Outcome, RenderError, RenderJob, Renderer, Stats,
};
use crate::kernel::parts;
use device::Gpu;
use dispatches::{Dispatches, Incomplete};
use kernel::Kernels;
use loaded::Loaded;
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// The renderer on a GPU.
pub struct GpuRenderer {
    gpu: Gpu,
    options: GpuOptions,
    kernels: Kernels,
    dispatches: Dispatches,
    loaded: Option<Loaded>,
    /// Number of readbacks requested.
    readbacks: u64,
    messages: Vec<String>,
}

fn failed(reason: String) -> RenderError {
    RenderError::Backend { backend: "gpu", reason }
}

impl GpuRenderer {
    /// Opens an adapter.
    ///
    /// # Errors
    /// [`GpuError`], with the available adapters.
    pub fn new(options: GpuOptions) -> Result<Self, GpuError> {
        let gpu = Gpu::open(options.adapter.as_deref(), options.allow_software, options.patience)?;
        let dispatches = Dispatches::new(&gpu, options.dispatch_target, options.iteration_limit)
            .map_err(|reason| GpuError::Device { adapter: gpu.adapter.to_string(), reason })?;
        let software = |adapter: &AdapterInfo| {
            format!("{adapter} is not a GPU: it runs on the processor and is slower than the CPU backend")
        };
        let messages = gpu.adapter.is_software.then(|| software(&gpu.adapter)).into_iter().collect();
        Ok(GpuRenderer {
            gpu,
            options,
            kernels: Kernels::default(),
            dispatches,
            loaded: None,
            readbacks: 0,
            messages,
        })
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.gpu.adapter
    }

    /// The open device.
    pub fn device(&self) -> &wgpu::Device {
        &self.gpu.device
    }

    /// Figures of dispatches and readbacks so far.
    pub fn report(&self) -> GpuReport {
        GpuReport {
            dispatches: self.dispatches.count,
            dispatch_time: self.dispatches.time,
            timer: self.dispatches.timer(),
            films: self.readbacks,
            film_time: self.loaded.as_ref().map_or(Duration::ZERO, |loaded| loaded.film.readbacks_took),
        }
    }

    /// Prepares the job and runs `work` on it.
    fn with_loaded<T>(
        &mut self,
        job: &RenderJob,
        cancel: &AtomicBool,
        work: impl FnOnce(&mut Self, &mut Loaded) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let loaded = self.take_loaded(job, cancel)?;
        self.work_on(loaded, work)
    }

    /// Runs `work` on the loaded job. If that fails, traced samples are discarded.
    fn work_on<T>(
        &mut self,
        mut loaded: Loaded,
        work: impl FnOnce(&mut Self, &mut Loaded) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let result = work(self, &mut loaded);
        if let Err(RenderError::Cancelled | RenderError::Backend { .. }) = result {
            self.discard(&mut loaded);
        }
        self.loaded = Some(loaded);
        result
    }

    /// Discards traced samples that are not in a film.
    fn discard(&mut self, loaded: &mut Loaded) {
        self.dispatches.discard();
        loaded.film.discard(&self.gpu);
    }

    /// Traces samples and adds them to the film, or leaves them on the device if they `may_defer`.
    fn trace(
        &mut self,
        loaded: &mut Loaded,
        range: &Range<u64>,
        film: &mut Film,
        &Control { cancel, may_defer, .. }: &Control,
    ) -> Result<Stats, Incomplete> {
        let begin = Instant::now();
        let mut stats = self.trace_range(loaded, range, film, cancel)?;
        if !may_defer {
            self.dispatches.drain(&self.gpu, Some(cancel))?;
        }
        loaded.film.note(range.clone(), begin.elapsed())?;
        if !may_defer {
            stats.add(&self.finish_all(loaded, film)?);
        } else if loaded.film.is_readback_due() {
            self.read_film_back(loaded)?;
        }
        Ok(stats)
    }

    fn kernel(&self) -> KernelInfo {
        let Some(Loaded { scene, features, kernel, .. }) = &self.loaded else { return KernelInfo::default() };
        let (present, timer) = (parts::describe(features.parts()), self.dispatches.timer());
        let seconds = kernel.compile_time.as_secs_f64();
        KernelInfo {
            about: format!("{present}; compiled in {seconds:.3} s; dispatches timed by {timer}"),
            left_out: parts::left_out(features.parts()),
            hierarchy_time: scene.prepared.hierarchy_source.time(),
        }
    }
}

impl Renderer for GpuRenderer {
    fn info(&self) -> BackendInfo {
        BackendInfo {
            name: "gpu",
            device: self.gpu.adapter.to_string(),
            lanes: layout::WORKGROUP_SIZE as usize,
            threads: 1,
        }
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn diagnostics(&self) -> Diagnostics {
        let device_time = self.dispatches.is_timed_by_device().then_some(self.dispatches.time);
        Diagnostics { kernel: self.kernel(), device_time, ..Diagnostics::default() }
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.with_loaded(job, cancel, |this, loaded| {
            if loaded.film.holds_samples() {
                this.discard(loaded);
            }
            Ok(())
        })
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        control: &Control,
    ) -> Result<Outcome, RenderError> {
        let stats = self.with_loaded(job, control.cancel, |this, loaded| {
            let traced = this.trace(loaded, &range, film, control);
            this.completed(loaded, traced, range, film, control.cancel)
        })?;
        Ok(Outcome::Added(stats))
    }

    fn request_readback(&mut self) -> Result<(), RenderError> {
        let Some(loaded) = self.loaded.take() else { return Ok(()) };
        self.work_on(loaded, |this, loaded| match this.read_film_back(loaded) {
            // The next call will detect missing samples.
            Ok(()) | Err(Incomplete::Short(_)) => Ok(()),
            Err(Incomplete::Failed(error)) => Err(error),
        })
    }

    fn finish(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let Some(loaded) = self.loaded.take() else { return Ok(Stats::default()) };
        self.work_on(loaded, |this, loaded| {
            let finished = this.finish_all(loaded, film);
            this.completed(loaded, finished, 0..0, film, &AtomicBool::new(false))
        })
    }
}
