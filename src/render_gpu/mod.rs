//! The GPU backend: a path tracer in one compute kernel, the twin of the CPU's tracer.
//!
//! `shaders/` contains the functions, in files with the same names as in `src/render_cpu/`. This module opens an
//! adapter, specialises the kernel to the job, sizes dispatches by measured time and adds the resulting sums to the
//! film. Sample indices, random numbers and fixed-point sums match the CPU's to the bit.

mod adapter;
mod arrival;
mod device;
mod dispatches;
mod film_buffers;
mod kernel;
pub mod layout;
mod loaded;
mod options;
mod readback;
mod record;
mod scene;
mod schedule;
pub mod shader_source;
mod small_programs;
mod trace;

pub use adapter::{AdapterInfo, adapters};
pub use options::{
    BATCH_TARGET, Fault, FaultInjection, GpuError, GpuOptions, GpuReport, INTERACTIVE_TARGET, InjectionPoint,
};
pub use scene::{Exported, ITERATION_LIMIT, SHARED_BLOCK};

use crate::film::Film;
use crate::job::render::{BackendInfo, KernelInfo, RenderError, RenderJob, Renderer, Stats};
use crate::kernel::parts;
use device::Gpu;
use dispatches::{Broken, Dispatches};
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
    /// Number of jobs prepared.
    preparations: u64,
    /// Number of times a film was sent for.
    fetches: u64,
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
            preparations: 0,
            fetches: 0,
            messages,
        })
    }

    /// The adapter in use.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.gpu.adapter
    }

    /// A report of what was compiled and measured so far.
    pub fn report(&self) -> GpuReport {
        let film = |loaded: &Loaded| (loaded.film.arrivals, loaded.film.arrivals_took);
        let (films, film_time) = self.loaded.as_ref().map_or((0, Duration::ZERO), film);
        GpuReport {
            dispatches: self.dispatches.count,
            dispatch_time: self.dispatches.time,
            timer: self.dispatches.timer(),
            films,
            film_time,
        }
    }

    /// Prepares the job and runs `work` on it.
    fn with_loaded<T>(
        &mut self,
        job: &RenderJob,
        cancel: &AtomicBool,
        work: impl FnOnce(&mut Self, &mut Loaded) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let loaded = self.ready(job, cancel)?;
        self.work_on(loaded, work)
    }

    /// Runs `work` on what is loaded. If that fails, traced samples are discarded.
    fn work_on<T>(
        &mut self,
        mut loaded: Loaded,
        work: impl FnOnce(&mut Self, &mut Loaded) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let result = work(self, &mut loaded);
        if let Err(RenderError::Cancelled | RenderError::Backend { .. }) = result {
            self.forget(&mut loaded);
        }
        self.loaded = Some(loaded);
        result
    }

    /// Discards traced samples that are not in a film.
    fn forget(&mut self, loaded: &mut Loaded) {
        self.dispatches.abandon();
        loaded.film.forget(&self.gpu);
    }

    /// Injects the fault that is due at the `count`th event of this kind, if any, by breaking the device.
    fn inject(&self, point: InjectionPoint, count: u64) -> Option<Fault> {
        let is_due = |injection: &FaultInjection| {
            let lasts = injection.fault == Fault::AlwaysShort;
            injection.point == point && (injection.after == count || lasts && injection.after < count)
        };
        let injection = self.options.injection.filter(is_due)?;
        self.gpu.break_by(injection.fault);
        Some(injection.fault)
    }

    /// Adds samples to the film, or leaves them on the device unless they `are_collected`.
    fn add(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
        are_collected: bool,
    ) -> Result<Stats, RenderError> {
        self.with_loaded(job, cancel, |this, loaded| {
            match this.traced(loaded, &range, film, cancel, are_collected) {
                Err(Broken::Short(reason)) => this.trace_again(loaded, reason, range, film, cancel),
                Err(Broken::Ended(error)) => Err(error),
                Ok(stats) => Ok(stats),
            }
        })
    }

    fn traced(
        &mut self,
        loaded: &mut Loaded,
        range: &Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
        are_collected: bool,
    ) -> Result<Stats, Broken> {
        let begin = Instant::now();
        let mut stats = self.trace_range(loaded, range, film, cancel)?;
        if are_collected {
            self.dispatches.drain(&self.gpu, Some(cancel))?;
        }
        loaded.film.note(range.clone(), begin.elapsed())?;
        if are_collected {
            stats.add(&self.collect_all(loaded, film)?);
        } else if loaded.film.is_due() {
            self.send_for_film(loaded)?;
        }
        Ok(stats)
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

    fn device_time(&self) -> Option<Duration> {
        self.dispatches.is_timed_by_device().then_some(self.dispatches.time)
    }

    fn kernel(&self) -> KernelInfo {
        let Some(Loaded { scene, features, kernel, .. }) = &self.loaded else { return KernelInfo::default() };
        let (present, timer) = (parts::describe(features.parts()), self.dispatches.timer());
        let seconds = kernel.compile_time.as_secs_f64();
        KernelInfo {
            about: format!("{present}; compiled in {seconds:.3} s; dispatches timed by {timer}"),
            left_out: parts::left_out(features.parts()),
            hierarchy_time: scene.hierarchy_time,
        }
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.with_loaded(job, cancel, |this, loaded| {
            if loaded.film.holds_samples() {
                this.forget(loaded);
            }
            Ok(())
        })
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.add(job, range, film, cancel, true)
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.add(job, range, film, cancel, false)
    }

    fn fetch(&mut self) -> Result<(), RenderError> {
        let Some(loaded) = self.loaded.take() else { return Ok(()) };
        self.work_on(loaded, |this, loaded| match this.send_for_film(loaded) {
            // The next call will detect missing samples.
            Ok(()) | Err(Broken::Short(_)) => Ok(()),
            Err(Broken::Ended(error)) => Err(error),
        })
    }

    fn collect(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let Some(loaded) = self.loaded.take() else { return Ok(Stats::default()) };
        self.work_on(loaded, |this, loaded| match this.collect_all(loaded, film) {
            Err(Broken::Short(reason)) => {
                this.trace_again(loaded, reason, 0..0, film, &AtomicBool::new(false))
            }
            Err(Broken::Ended(error)) => Err(error),
            Ok(stats) => Ok(stats),
        })
    }
}
