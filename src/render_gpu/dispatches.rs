//! Dispatches in flight: queued ahead of the device, resumed until all their samples are finished, and timed.

use super::device::Gpu;
use super::failed;
use super::layout::{GpuBlock, GpuDispatch, GpuSuspendedPath, WORKGROUP_SIZE};
use super::readback::{DispatchReadback, DispatchResult};
use super::scene::{ITERATION_LIMIT, iterations_over_lists};
use super::schedule::Budget;
use crate::job::render::RenderError;
use crate::kernel::Features;
use crate::prepared::PreparedScene;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Number of dispatches in flight across passes: while the host processes one, the device runs the other.
const QUEUE_DEPTH: usize = 2;

/// Maximum number of workgroups along one axis of a dispatch; WebGPU allows 65,535.
const GROUPS_ACROSS: u32 = 32_768;

/// Maximum number of threads in a dispatch; each can suspend its path, in [`SUSPENDED_SIZE`] bytes.
const THREAD_LIMIT: u64 = 1 << 20;

/// Bytes of a suspended path.
const SUSPENDED_SIZE: u64 = size_of::<GpuSuspendedPath>() as u64;

/// Factor of the target time on a software adapter. Mesa's llvmpipe compiles a kernel anew for each dispatch, which takes
/// about 6 ms, and keeps the memory: 0.7 MB for each of the book's last picture (Mesa 22.3).
const SOFTWARE_FACTOR: u32 = 10;

/// Each time samples are missing, dispatches shrink by this many bits.
pub(super) const CAUTION_SHIFT: u32 = 3;

/// Maximum number of times that missing samples are traced again.
pub(super) const CAUTION_LIMIT: u32 = 3;

/// Why a pass is incomplete.
pub(super) enum Incomplete {
    /// The device failed, or the pass was cancelled.
    Failed(RenderError),
    /// Samples are missing although the device reported no fault. Describes how many and where.
    Short(String),
}

impl From<RenderError> for Incomplete {
    fn from(error: RenderError) -> Self {
        Incomplete::Failed(error)
    }
}

/// A dispatch with everything that it binds.
pub(super) struct BoundDispatch {
    pub kernel: Features,
    pub pipeline: wgpu::ComputePipeline,
    pub scene: wgpu::BindGroup,
    pub film: wgpu::BindGroup,
    pub parameters_buffer: wgpu::Buffer,
    pub blocks_buffer: wgpu::Buffer,
    pub counters: wgpu::Buffer,
    pub blocks: Arc<[GpuBlock]>,
    pub parameters: GpuDispatch,
    /// Threads times samples, the unit of the budget.
    pub paths: u64,
    /// Samples in the dispatch, over all pixels.
    pub samples: u64,
}

/// A submission that may not be done yet.
struct InFlight {
    slot: usize,
    submission: wgpu::SubmissionIndex,
    submitted: Instant,
    dispatch: BoundDispatch,
    /// Samples finished by earlier rounds of this dispatch.
    finished: u64,
    /// Whether its samples are still needed.
    is_needed: bool,
}

/// The buffers of one dispatch in flight.
struct Slot {
    readback: DispatchReadback,
    suspended: wgpu::Buffer,
    /// Group 2: the buffer for suspended paths.
    group: wgpu::BindGroup,
    /// Whether the buffer may contain paths of an earlier dispatch. Only a resumed dispatch may read them.
    holds_paths: bool,
}

impl Slot {
    fn new(gpu: &Gpu, size: u64) -> Result<Self, String> {
        let (suspended, group) = suspended_storage(gpu, size)?;
        Ok(Slot { readback: DispatchReadback::new(gpu)?, suspended, group, holds_paths: false })
    }
}

fn suspended_storage(gpu: &Gpu, size: u64) -> Result<(wgpu::Buffer, wgpu::BindGroup), String> {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
    let suspended = gpu.buffer("suspended paths", size, usage)?;
    let group = gpu.bind(&gpu.layouts.scratch, &[&suspended]);
    Ok((suspended, group))
}

/// The dispatches in flight, and the times of completed ones.
pub(super) struct Dispatches {
    slots: Vec<Slot>,
    in_flight: VecDeque<InFlight>,
    last_done: Instant,
    /// By kernel, so that switching to another view of a scene and back keeps the full speed.
    budgets: HashMap<Features, Budget>,
    target: Duration,
    /// Limit on a thread's loop iterations, as the adapter counts them.
    iteration_limit: u32,
    /// How often samples were missing.
    pub(super) caution: u32,
    /// Description of the missing samples, if needed samples are missing.
    shortfall: Option<String>,
    /// Dispatches so far.
    pub(super) count: u64,
    /// Total time of the completed dispatches.
    pub(super) time: Duration,
}

impl Dispatches {
    /// # Errors
    /// If the device runs out of memory.
    pub(super) fn new(gpu: &Gpu, target: Duration, iteration_limit: Option<u32>) -> Result<Self, String> {
        let target = if gpu.adapter.is_software { SOFTWARE_FACTOR * target } else { target };
        Ok(Dispatches {
            slots: (0..QUEUE_DEPTH).map(|_| Slot::new(gpu, SUSPENDED_SIZE)).collect::<Result<_, _>>()?,
            in_flight: VecDeque::new(),
            last_done: Instant::now(),
            budgets: HashMap::new(),
            target,
            iteration_limit: iteration_limit.unwrap_or(ITERATION_LIMIT / gpu.adapter.threads_in_step()),
            caution: 0,
            shortfall: None,
            count: 0,
            time: Duration::ZERO,
        })
    }

    /// Name of the clock that times dispatches.
    pub(super) fn timer(&self) -> &'static str {
        if self.is_timed_by_device() { "timestamp queries" } else { "wall clock" }
    }

    /// Whether the device's own clock times dispatches.
    pub(super) fn is_timed_by_device(&self) -> bool {
        self.slots.iter().all(|slot| slot.readback.has_clock())
    }

    /// Whether a kernel has never run.
    pub(super) fn is_new(&self, kernel: &Features) -> bool {
        !self.budgets.contains_key(kernel)
    }

    pub(super) fn budget(&mut self, kernel: &Features) -> &mut Budget {
        self.budgets.entry(*kernel).or_insert_with(|| Budget::new(self.target))
    }

    /// Limit on a thread's loop iterations in one dispatch.
    pub(super) fn iteration_limit(&self, kernel: &Features) -> u32 {
        let shift = if kernel.suspends { CAUTION_SHIFT * self.caution } else { 0 };
        (self.iteration_limit >> shift).max(1)
    }

    /// Samples per pixel that are sure to fit one dispatch however long their paths are, so that none is suspended.
    /// `None` if that is unknown or not even one sample is sure to fit.
    pub(super) fn whole_samples(&self, kernel: &Features, prepared: &PreparedScene<f32>) -> Option<u64> {
        // A path may take one iteration without a ray at its end, and one iteration precedes the first path.
        let iterations =
            u64::from(prepared.settings.max_depth) * (1 + iterations_over_lists(kernel, prepared)) + 1;
        let samples = u64::from(self.iteration_limit - 1) / iterations;
        (!kernel.hierarchy && samples > 0).then_some(samples)
    }

    /// Allocates storage for the paths of a picture with `threads` threads, up to the limit of a dispatch.
    ///
    /// # Errors
    /// If the device runs out of memory.
    pub(super) fn reserve_suspended(
        &mut self,
        gpu: &Gpu,
        threads: u64,
        binding_limit: u64,
    ) -> Result<(), String> {
        let size = threads.min(THREAD_LIMIT).min(binding_limit / SUSPENDED_SIZE) * SUSPENDED_SIZE;
        for slot in &mut self.slots {
            if slot.suspended.size() < size {
                // The readback may belong to a dispatch in flight.
                (slot.suspended, slot.group) = suspended_storage(gpu, size)?;
            }
        }
        Ok(())
    }

    /// Maximum number of tiles in a dispatch.
    pub(super) fn tile_limit(&self) -> u64 {
        let sizes = self.slots.iter().map(|slot| slot.suspended.size());
        (sizes.min().unwrap_or_default() / (SUSPENDED_SIZE * u64::from(WORKGROUP_SIZE))).max(1)
    }

    /// Discards the samples of all dispatches in flight.
    pub(super) fn discard(&mut self) {
        self.shortfall = None;
        self.in_flight.iter_mut().for_each(|in_flight| in_flight.is_needed = false);
    }

    /// Submits a dispatch, using a free slot.
    pub(super) fn submit(
        &mut self,
        gpu: &Gpu,
        slot: usize,
        dispatch: BoundDispatch,
        finished: u64,
    ) -> Result<(), String> {
        let Slot { readback, suspended, group, holds_paths } = &mut self.slots[slot];
        gpu.queue.write_buffer(&dispatch.blocks_buffer, 0, bytemuck::cast_slice(&dispatch.blocks));
        gpu.queue.write_buffer(&dispatch.parameters_buffer, 0, bytemuck::bytes_of(&dispatch.parameters));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        if *holds_paths && dispatch.parameters.resumes == 0 {
            encoder.clear_buffer(suspended, 0, None);
        }
        *holds_paths = false;
        readback.begin(&mut encoder, &dispatch.counters);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("path_trace"),
                timestamp_writes: readback.writes(),
            });
            pass.set_pipeline(&dispatch.pipeline);
            pass.set_bind_group(0, &dispatch.scene, &[]);
            pass.set_bind_group(1, &dispatch.film, &[]);
            pass.set_bind_group(2, &*group, &[]);
            let [x, y] = groups(dispatch.parameters.tile_count);
            pass.dispatch_workgroups(x, y, 1);
        }
        readback.end(&mut encoder, &dispatch.counters);
        log::debug!(
            "dispatch {}: {} tiles from tile {}, {} blocks of samples, {} samples{}",
            self.count,
            dispatch.parameters.tile_count,
            dispatch.parameters.first_tile,
            dispatch.blocks.len(),
            dispatch.samples,
            if dispatch.parameters.resumes == 0 { "" } else { ", resumed" }
        );
        let submitted = Instant::now();
        let submission = gpu.queue.submit([encoder.finish()]);
        readback.request();
        self.in_flight.push_back(InFlight {
            slot,
            submission,
            submitted,
            dispatch,
            finished,
            is_needed: true,
        });
        self.count += 1;
        gpu.faults.check()
    }

    /// Waits for the oldest dispatch and learns from its time. If threads have suspended paths, submits it again.
    fn finish_oldest(&mut self, gpu: &Gpu, cancel: Option<&AtomicBool>) -> Result<(), Incomplete> {
        let Some(oldest) = self.in_flight.front() else { return Ok(()) };
        if !gpu.wait_unless(&oldest.submission, cancel).map_err(failed)? {
            return Err(RenderError::Cancelled.into());
        }
        let Some(mut done) = self.in_flight.pop_front() else { return Ok(()) };
        let result = self.slots[done.slot].readback.read().map_err(failed)?;
        let took = result.took.unwrap_or_else(|| {
            let begun = self.last_done.max(done.submitted);
            self.last_done = Instant::now();
            self.last_done - begun
        });
        self.time += took;
        log::debug!("a dispatch took {:.3} ms", took.as_secs_f64() * 1e3);
        self.slots[done.slot].holds_paths = result.counters.unfinished > 0;
        if !done.is_needed {
            return Ok(());
        }
        self.learn(&done.dispatch, &result, took);
        done.finished += result.finished();
        if result.counters.stuck > 0 {
            return Err(failed(stuck(result.counters.stuck)).into());
        }
        if result.counters.unfinished > 0 && done.dispatch.kernel.suspends {
            done.dispatch.parameters.resumes = 1;
            self.submit(gpu, done.slot, done.dispatch, done.finished).map_err(failed)?;
        } else if done.finished != done.dispatch.samples {
            self.shortfall = Some(done.dispatch.shortfall(done.finished));
        }
        self.check_whole()
    }

    /// Returns `Err` while needed samples are missing.
    pub(super) fn check_whole(&self) -> Result<(), Incomplete> {
        self.shortfall.clone().map_or(Ok(()), |shortfall| Err(Incomplete::Short(shortfall)))
    }

    fn learn(&mut self, dispatch: &BoundDispatch, result: &DispatchResult, took: Duration) {
        let share = result.finished() as f64 / dispatch.samples.max(1) as f64;
        let paths = ((dispatch.paths as f64 * share) as u64).max(1);
        self.budget(&dispatch.kernel).learn(paths, took);
    }

    /// Waits for all dispatches in flight.
    pub(super) fn drain(&mut self, gpu: &Gpu, cancel: Option<&AtomicBool>) -> Result<(), Incomplete> {
        while !self.in_flight.is_empty() {
            self.finish_oldest(gpu, cancel)?;
        }
        self.check_whole()
    }

    /// Returns a slot without a dispatch in flight; waits for one if necessary.
    pub(super) fn free_slot(&mut self, gpu: &Gpu, cancel: &AtomicBool) -> Result<usize, Incomplete> {
        loop {
            let is_free = |slot: &usize| self.in_flight.iter().all(|in_flight| in_flight.slot != *slot);
            if let Some(slot) = (0..self.slots.len()).find(is_free) {
                return Ok(slot);
            }
            self.finish_oldest(gpu, Some(cancel))?;
        }
    }
}

impl BoundDispatch {
    fn shortfall(&self, finished: u64) -> String {
        let GpuDispatch { first_tile, tile_count, first_row, .. } = self.parameters;
        let block_count = self.blocks.len();
        let last_tile = first_tile + tile_count.saturating_sub(1);
        format!(
            "the device added only {finished} of {} samples, in {block_count} blocks of tiles {first_tile} to \
             {last_tile} from row {first_row} on",
            self.samples
        )
    }
}

/// The error message for rays that cannot be traced to their end.
pub(super) fn stuck(pixels: u32) -> String {
    format!(
        "{pixels} pixels have a ray that is tested against more of the scene than a loop of this driver allows \
         (llvmpipe: 65,535 iterations); render this scene on the CPU"
    )
}

/// Workgroups along x and y whose product is at least `count`.
pub(super) fn groups(count: u32) -> [u32; 2] {
    if count <= GROUPS_ACROSS { [count, 1] } else { [GROUPS_ACROSS, count.div_ceil(GROUPS_ACROSS)] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_tile_has_a_workgroup() {
        for count in [1, GROUPS_ACROSS, GROUPS_ACROSS + 1, 3 * GROUPS_ACROSS - 1, 1 << 22] {
            let [x, y] = groups(count);
            // No more than a device allows in one direction, and less than a row too many.
            assert!(x.max(y) <= 65_535 && x * (y - 1) < count && count <= x * y, "{count}: {x} x {y}");
        }
    }
}
