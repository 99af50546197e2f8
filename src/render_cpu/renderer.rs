//! The renderer on the CPU: what it prepares for a job, and its passes.

use super::broadcast::BroadcastScene;
use super::isa::Isa;
use super::kernels;
use super::options::{CpuError, CpuOptions};
use super::pass::{Pass, PassTracer, Prepared, Purpose, StopRequest, describe_missing};
use super::priority::give_way;
use super::rebuild::Rebuild;
use super::tiles::tile_side;
use super::work::TileStats;
use crate::film::{Film, HALVES};
use crate::job::render::{
    BackendInfo, Control, Diagnostics, KernelInfo, Outcome, RenderError, RenderJob, Renderer, Stats,
};
use crate::kernel::{Features, Real, parts};
use crate::prepared::PreparedScene;
use crate::system::threads::Pool;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The renderer on the CPU.
pub struct CpuRenderer {
    /// Level and lane count; `None` for the reference.
    packets: Option<(Isa, usize)>,
    /// Whether every job gets the general kernel.
    general: bool,
    low_priority: bool,
    threads: Pool,
    job: Option<RenderJob>,
    pub(super) prepared: Option<Prepared>,
    pub(super) rebuild: Rebuild,
    messages: Vec<String>,
}

impl CpuRenderer {
    /// Creates a renderer in `f32` with these options.
    ///
    /// # Errors
    /// [`CpuError`], with what is available instead.
    pub fn new(options: CpuOptions) -> Result<Self, CpuError> {
        let available = Isa::available();
        let best = available.iter().copied().max().unwrap_or(Isa::Portable);
        let isa = options.isa.unwrap_or(best);
        if !available.contains(&isa) {
            return Err(CpuError::Isa { isa, available });
        }
        let lanes = options.lanes.unwrap_or_else(|| isa.native_lanes());
        if !isa.lane_counts().contains(&lanes) {
            return Err(CpuError::Lanes { lanes, isa, available: isa.lane_counts().to_vec() });
        }
        CpuRenderer::with_packets(Some((isa, lanes)), options)
    }

    /// Creates the reference renderer: scalar, `f64`, with `threads` threads (`None`: one per core).
    ///
    /// # Errors
    /// [`CpuError::Threads`] if the threads cannot be started.
    pub fn reference(threads: Option<usize>) -> Result<Self, CpuError> {
        CpuRenderer::with_packets(None, CpuOptions { threads, ..CpuOptions::default() })
    }

    fn with_packets(packets: Option<(Isa, usize)>, options: CpuOptions) -> Result<Self, CpuError> {
        let CpuOptions { threads, low_priority, general, .. } = options;
        let builder = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(0))
            .thread_name(|index| format!("trace-{index}"))
            .start_handler(move |_| {
                if low_priority {
                    give_way();
                }
            });
        let threads = Pool::start(builder).map_err(|error| {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            let threads = threads.filter(|threads| *threads > 0).unwrap_or(cores);
            CpuError::Threads { threads, reason: error.to_string() }
        })?;
        Ok(CpuRenderer {
            packets,
            general,
            low_priority,
            threads,
            job: None,
            prepared: None,
            rebuild: Rebuild::new(),
            messages: Vec::new(),
        })
    }
}

impl Renderer for CpuRenderer {
    fn info(&self) -> BackendInfo {
        let threads = self.threads.count();
        match self.packets {
            Some((isa, lanes)) => BackendInfo { name: "cpu", device: isa.to_string(), lanes, threads },
            None => BackendInfo { name: "reference", device: "f64".into(), lanes: 1, threads },
        }
    }

    fn diagnostics(&self) -> Diagnostics {
        Diagnostics { kernel: self.kernel(), device_time: None, stops_early: true }
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        if self.prepared.is_some() && self.job.as_ref() == Some(job) {
            return Ok(());
        }
        let before = self.job.take();
        let (single, double) = match self.prepared.take() {
            Some(Prepared::Single(old, _)) => (Some(old.prepared), None),
            Some(Prepared::Double(old, _)) => (None, Some(old.prepared)),
            None => (None, None),
        };
        self.prepared = Some(match self.packets {
            Some((isa, lanes)) => {
                let prepared = self.renewed(single.zip(before), job, cancel)?;
                self.messages = prepared.warning.clone().into_iter().collect();
                self.rebuild.note_prepared(&prepared);
                let wanted = self.wanted_parts(&prepared.features);
                let kernel = kernels::kernel(isa, lanes, wanted).ok_or_else(|| RenderError::Backend {
                    backend: "cpu",
                    reason: format!("there is no kernel for {lanes} lanes of {isa}"),
                })?;
                Prepared::Single(Box::new(BroadcastScene::new(prepared)), kernel)
            }
            None => {
                let prepared = self.renewed(double.zip(before), job, cancel)?;
                Prepared::Double(Box::new(BroadcastScene::new(prepared)), kernels::reference_kernel())
            }
        });
        self.job = Some(job.clone());
        Ok(())
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn estimate_sample_time(&mut self, one_in: usize, cancel: &AtomicBool) -> Option<Duration> {
        let settings = *self.job.as_ref()?.settings();
        let mut film = Film::try_new(settings.width, settings.height).ok()?;
        let side = tile_side(film.width(), film.height(), self.threads.count());
        let stop = StopRequest::when(cancel);
        let pass =
            Pass { side, range: &(0..HALVES), cancel, stop: &stop, purpose: Purpose::Estimate { one_in } };
        Some(self.pass_tracer()?.estimate_time(pass, &mut film)? / HALVES as u32)
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        &Control { cancel, stop, .. }: &Control,
    ) -> Result<Outcome, RenderError> {
        self.prepare(job, cancel)?;
        self.take_better_hierarchy(job);
        film.samples().check_new(&range)?;
        let start = Instant::now();
        let side = tile_side(film.width(), film.height(), self.threads.count());
        let stop = StopRequest::when(stop);
        let pass = Pass { side, range: &range, cancel, stop: &stop, purpose: Purpose::Add };
        let tracer = self.pass_tracer().ok_or_else(|| RenderError::Backend {
            backend: self.info().name,
            reason: "no scene is prepared".to_owned(),
        })?;
        let traced = tracer.trace(pass, film);
        if cancel.load(Ordering::Relaxed) {
            return Err(RenderError::Cancelled);
        }
        if let Some(reason) = describe_missing(&traced, side, film.width()) {
            let backend = self.info().name;
            let is_withdrawn = tracer.withdraw(pass, &traced, film);
            return match (is_withdrawn, stop.is_given_up()) {
                (false, _) => Err(RenderError::FilmLost { backend, reason }),
                (true, true) => Ok(Outcome::Withdrawn),
                (true, false) => Err(RenderError::Backend { backend, reason }),
            };
        }
        let pixels = u64::from(film.width()) * u64::from(film.height());
        let paths = pixels * range.end.saturating_sub(range.start);
        let tiles = traced.iter().map(|tile| tile.stats).fold(TileStats::default(), TileStats::plus);
        film.record(range, tiles.rejected)?;
        let trace = start.elapsed();
        self.begin_better_hierarchy(job, trace);
        Ok(Outcome::Added(Stats {
            paths,
            rays: tiles.rays,
            rejected: tiles.rejected,
            busy_lanes: tiles.rays,
            offered_lanes: tiles.offered_lanes,
            trace,
        }))
    }
}

impl CpuRenderer {
    fn kernel(&self) -> KernelInfo {
        let (features, hierarchy) = match &self.prepared {
            Some(Prepared::Single(traced, _)) => (traced.prepared.features, traced.prepared.hierarchy_source),
            Some(Prepared::Double(traced, _)) => (traced.prepared.features, traced.prepared.hierarchy_source),
            None => return KernelInfo::default(),
        };
        let offered = |(isa, lanes)| kernels::offered(isa, lanes, self.wanted_parts(&features));
        let contents = self.packets.map_or(parts::ALL, offered);
        let (present, needed) = (parts::describe(contents), parts::describe(features.parts()));
        let about = if needed == present { present } else { format!("{present} (needed: {needed})") };
        KernelInfo { about, left_out: parts::left_out(contents), hierarchy_time: hierarchy.time() }
    }

    fn pass_tracer(&self) -> Option<PassTracer<'_>> {
        Some(PassTracer { threads: &self.threads, prepared: self.prepared.as_ref()? })
    }

    fn renewed<R: Real>(
        &self,
        old: Option<(PreparedScene<R>, RenderJob)>,
        job: &RenderJob,
        cancel: &AtomicBool,
    ) -> Result<PreparedScene<R>, RenderError> {
        self.threads.install(|| PreparedScene::renewed(cancel, old, job)).ok_or(RenderError::Cancelled)
    }

    fn wanted_parts(&self, features: &Features) -> u32 {
        if self.general { parts::ALL } else { features.parts() }
    }

    /// Switches to the better hierarchy once it is built.
    fn take_better_hierarchy(&mut self, job: &RenderJob) {
        if let Some(Prepared::Single(broadcast, _)) = &mut self.prepared
            && let Some(better) = self.rebuild.take_built(job)
        {
            **broadcast = BroadcastScene::new(better);
        }
    }

    /// Begins to build a better hierarchy after long tracing.
    fn begin_better_hierarchy(&mut self, job: &RenderJob, traced: Duration) {
        if let Some(Prepared::Single(broadcast, _)) = &self.prepared {
            let threads = self.threads.count();
            self.rebuild.note_pass(traced, threads, &broadcast.prepared, job, self.low_priority);
        }
    }
}

#[cfg(test)]
mod tests;
