//! Dispatches: cut from a range of samples, sent off ahead of the device, timed, and sized by what they took.

use super::device::Gpu;
use super::layout::{GpuDispatch, tile_size};
use super::prepared::Prepared;
use super::readback::Timer;
use super::schedule::{Blocks, Budget};
use super::{GpuRenderer, Overrides, failed};
use crate::film::Film;
use crate::render::{RenderError, Stats};
use std::collections::{HashMap, VecDeque};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Dispatches under way, from one pass to the next: while the host deals with one, the device has another.
const QUEUE_DEPTH: usize = 2;

/// Most workgroups along one axis of a dispatch; WebGPU allows 65,535.
const GROUPS_ACROSS: u32 = 32_768;

/// A submission that is not known to be done.
struct UnderWay {
    submission: wgpu::SubmissionIndex,
    timer: Option<usize>,
    paths: u64,
    kernel: Overrides,
    submitted: Instant,
}

/// What is under way, and what was learnt from what is done.
pub(super) struct Dispatches {
    timers: Vec<Timer>,
    under_way: VecDeque<UnderWay>,
    last_done: Instant,
    /// By kernel, so that another view of a scene goes on at full speed.
    budgets: HashMap<Overrides, Budget>,
    target: Duration,
    /// Dispatches so far.
    pub(super) count: u64,
    /// What those that are done took.
    pub(super) time: Duration,
    /// Dispatches when the film was last sent for.
    count_at_fetch: u64,
}

impl Dispatches {
    pub(super) fn new(gpu: &Gpu, target: Duration) -> Self {
        let timers: Vec<Timer> = (0..QUEUE_DEPTH).map_while(|_| Timer::new(gpu)).collect();
        Dispatches {
            timers: if timers.len() == QUEUE_DEPTH { timers } else { Vec::new() },
            under_way: VecDeque::new(),
            last_done: Instant::now(),
            budgets: HashMap::new(),
            target,
            count: 0,
            time: Duration::ZERO,
            count_at_fetch: 0,
        }
    }

    /// By what they are timed.
    pub(super) fn timer(&self) -> &'static str {
        if self.is_timed_by_device() { "timestamp queries" } else { "wall clock" }
    }

    /// Whether the device's own clock tells what dispatches take.
    pub(super) fn is_timed_by_device(&self) -> bool {
        !self.timers.is_empty()
    }

    fn budget(&mut self, kernel: &Overrides) -> &mut Budget {
        self.budgets.entry(*kernel).or_insert_with(|| Budget::new(self.target))
    }

    /// Waits for the oldest dispatch and learns from it.
    fn finish(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        let Some(done) = self.under_way.pop_front() else { return Ok(()) };
        let took = match done.timer {
            Some(slot) => self.timers[slot].wait(gpu, done.submission).map_err(failed)?,
            None => {
                gpu.wait(done.submission).map_err(failed)?;
                let begun = self.last_done.max(done.submitted);
                self.last_done = Instant::now();
                self.last_done - begun
            }
        };
        self.time += took;
        self.budget(&done.kernel).learn(done.paths, took);
        Ok(())
    }

    /// Waits for all that is under way.
    pub(super) fn drain(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        while !self.under_way.is_empty() {
            self.finish(gpu)?;
        }
        Ok(())
    }

    /// Whether all that is under way came after the film was sent for.
    fn are_past_fetch(&self) -> bool {
        self.count - self.under_way.len() as u64 >= self.count_at_fetch
    }
}

impl GpuRenderer {
    /// Sends off the dispatches of `range`; the last may be under way at the end. A film that was sent for is
    /// added to `film` as soon as the device has other work.
    pub(super) fn trace_range(
        &mut self,
        prepared: &mut Prepared,
        range: &Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        prepared.film.check_new(range, film)?;
        let settings = *prepared.job.settings();
        let [tile_width, tile_height] = tile_size(settings.width, settings.height);
        let tile_pixels = u64::from(tile_width) * u64::from(tile_height);
        let mut stats = Stats::default();
        for slab in 0..prepared.film.slabs.len() {
            let (first_row, row_count) = {
                let slab = &prepared.film.slabs[slab];
                (slab.first_row, slab.row_count)
            };
            let tiles = settings.width.div_ceil(tile_width) * row_count.div_ceil(tile_height);
            let mut left = Blocks::of_range(range.clone(), &settings, prepared.scene.tables.block_limit);
            loop {
                let affordable = self.dispatches.budget(&prepared.overrides).paths();
                let pixels = u64::from(tiles) * tile_pixels;
                let samples = self.options.samples_per_dispatch.unwrap_or(affordable / pixels);
                let (blocks, samples) = left.take(samples);
                if blocks.is_empty() {
                    break;
                }
                self.gpu.queue.write_buffer(&prepared.film.blocks, 0, bytemuck::cast_slice(&blocks));
                let rays = samples.saturating_mul(u64::from(settings.max_depth)).saturating_add(1);
                let mut first_tile = 0;
                while first_tile < tiles {
                    if cancel.load(Ordering::Relaxed) {
                        return Err(RenderError::Cancelled);
                    }
                    while self.dispatches.under_way.len() >= QUEUE_DEPTH {
                        self.dispatches.finish(&self.gpu)?;
                    }
                    let affordable = self.dispatches.budget(&prepared.overrides).paths();
                    let order = GpuDispatch {
                        first_tile,
                        tile_count: evenly(tiles - first_tile, affordable / (tile_pixels * samples).max(1)),
                        block_count: blocks.len() as u32,
                        ray_limit: rays.min(u64::from(u32::MAX)) as u32,
                        first_row,
                        row_count,
                        ..GpuDispatch::default()
                    };
                    let paths = u64::from(order.tile_count) * tile_pixels * samples;
                    self.submit(prepared, slab, &order, paths).map_err(failed)?;
                    first_tile += order.tile_count;
                    if prepared.film.is_leaving() && self.dispatches.are_past_fetch() {
                        stats.add(&prepared.film.arrive(&self.gpu, film)?);
                    }
                }
            }
        }
        stats.add(&prepared.film.arrive(&self.gpu, film)?);
        Ok(stats)
    }

    /// Sends a dispatch off.
    fn submit(
        &mut self,
        prepared: &Prepared,
        slab: usize,
        order: &GpuDispatch,
        paths: u64,
    ) -> Result<(), String> {
        if let Some(drill) = self.options.drill
            && drill.after == self.dispatches.count
        {
            self.gpu.break_by(drill.fault);
        }
        let dispatches = &mut self.dispatches;
        let slot = (dispatches.count % QUEUE_DEPTH as u64) as usize;
        let timer = dispatches.timers.get(slot);
        self.gpu.queue.write_buffer(&prepared.film.order, 0, bytemuck::bytes_of(order));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("path_trace"),
                timestamp_writes: timer.map(Timer::writes),
            });
            pass.set_pipeline(&prepared.kernel.pipeline);
            pass.set_bind_group(0, &prepared.scene.group, &[]);
            pass.set_bind_group(1, &prepared.film.slabs[slab].group, &[]);
            pass.set_bind_group(2, &self.words_group, &[]);
            let [x, y] = groups(order.tile_count);
            pass.dispatch_workgroups(x, y, 1);
        }
        if let Some(timer) = timer {
            timer.resolve(&mut encoder);
        }
        let timer = timer.map(|_| slot);
        let submitted = Instant::now();
        let submission = self.gpu.queue.submit([encoder.finish()]);
        let kernel = prepared.overrides;
        dispatches.under_way.push_back(UnderWay { submission, timer, paths, kernel, submitted });
        dispatches.count += 1;
        self.gpu.faults.check()
    }

    /// Sends for the film.
    pub(super) fn send_for_film(&mut self, prepared: &mut Prepared) -> Result<(), RenderError> {
        if !prepared.film.is_leaving() {
            prepared.film.leave(&self.gpu);
            self.dispatches.count_at_fetch = self.dispatches.count;
        }
        self.gpu.faults.check().map_err(failed)
    }

    /// Adds all that was traced to the film.
    pub(super) fn collect_all(
        &mut self,
        prepared: &mut Prepared,
        film: &mut Film,
    ) -> Result<Stats, RenderError> {
        let mut stats = Stats::default();
        // What is on its way already comes first.
        while prepared.film.holds_samples() {
            self.send_for_film(prepared)?;
            self.dispatches.drain(&self.gpu)?;
            stats.add(&prepared.film.arrive(&self.gpu, film)?);
        }
        Ok(stats)
    }
}

/// So many of what is left that no dispatch is left with a few: at most `affordable`, at least one.
fn evenly(left: u32, affordable: u64) -> u32 {
    let left = u64::from(left);
    left.div_ceil(left.div_ceil(affordable.max(1))) as u32
}

/// Workgroups along x and y that are together at least `count`.
pub(super) fn groups(count: u32) -> [u32; 2] {
    if count <= GROUPS_ACROSS { [count, 1] } else { [GROUPS_ACROSS, count.div_ceil(GROUPS_ACROSS)] }
}
