//! The GPU backend: a path tracer in one compute kernel, the twin of the CPU's.
//!
//! `shaders/` holds the functions, in files of the same names as in `src/render_cpu/`; this module opens an
//! adapter, specialises the kernel to the job, deals it dispatches of measured size and adds what it summed up
//! to the film. Sample indices, numbers and fixed point are the CPU's to the bit.

mod device;
mod kernel;
pub mod layout;
mod readback;
mod schedule;
pub mod shader_source;

pub use device::{AdapterInfo, adapters};
pub use kernel::{Constant, Overrides};

use crate::film::{Film, PixelSum};
use crate::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};
use crate::stages::Transfer;
use crate::tables::Tables;
use device::Gpu;
use kernel::{Kernel, Kernels};
use layout::{GpuAnchoredSphere, GpuCounters, GpuDispatch, GpuJob, GpuNode, GpuPixelSum, GpuRow, tile_size};
use readback::Timer;
use schedule::{BLOCK_LIMIT, Blocks, Budget};
use shader_source::{EntryPoint, PROBE_STRIDE, Probe, STACK_SIZE, transfer_tag};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

/// What a dispatch should take when nobody waits for it.
pub const BATCH_TARGET: Duration = Duration::from_millis(50);

/// What a dispatch should take while someone interacts.
pub const INTERACTIVE_TARGET: Duration = Duration::from_millis(8);

/// Dispatches under way: while the host deals with one, the device has another.
const QUEUE_DEPTH: usize = 2;

/// Most workgroups along one axis of a dispatch; WebGPU allows 65,535.
const GROUPS_ACROSS: u32 = 32_768;

/// Largest buffer through which films are read.
const STAGING_LIMIT: u64 = 64 << 20;

const PIXEL_SIZE: u64 = size_of::<GpuPixelSum>() as u64;

/// How to open an adapter and use it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GpuOptions {
    /// Part of an adapter's name, backend or driver; by default the best there is.
    pub adapter: Option<String>,
    /// Whether a software adapter will do.
    pub allow_software: bool,
    /// What a dispatch should take.
    pub dispatch_target: Duration,
    /// Whether kernels carry only what the job needs; else all, to measure what that gains.
    pub specialise: bool,
    /// Samples of a pixel in one dispatch, instead of as many as the target allows: to measure.
    pub samples_per_dispatch: Option<u64>,
    /// Most bytes of a film on the device at once; by default what the adapter can bind.
    pub film_limit: Option<u64>,
    /// Loses the device after so many dispatches: a drill.
    pub simulate_device_lost_after: Option<u64>,
}

impl Default for GpuOptions {
    fn default() -> Self {
        GpuOptions {
            adapter: None,
            allow_software: false,
            dispatch_target: BATCH_TARGET,
            specialise: true,
            samples_per_dispatch: None,
            film_limit: None,
            simulate_device_lost_after: None,
        }
    }
}

/// Why there is no GPU to render on.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum GpuError {
    /// No adapter at all.
    #[error("no graphics adapter was found; install its Vulkan driver, or render on the CPU")]
    None,
    /// None of that name.
    #[error("no adapter matches \"{wanted}\"; there are: {}", available.join("; "))]
    NoMatch {
        /// Asked for.
        wanted: String,
        /// What there is.
        available: Vec<String>,
    },
    /// Only software.
    #[error("there is no GPU, only software adapters: {}; ask for one by name, or render on the CPU, which is faster", available.join("; "))]
    Software {
        /// What there is.
        available: Vec<String>,
    },
    /// Not able to run the kernel.
    #[error("{adapter} has {lacks}; choose another adapter, or render on the CPU")]
    Lacks {
        /// The adapter.
        adapter: String,
        /// What it lacks.
        lacks: String,
    },
    /// It would not open.
    #[error("{adapter} could not be opened: {reason}")]
    Device {
        /// The adapter.
        adapter: String,
        /// What it said.
        reason: String,
    },
}

/// What the renderer did since it was made, for reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuReport {
    /// What the kernel in use contains.
    pub features: String,
    /// What compiling it took.
    pub compile_time: Duration,
    /// Dispatches so far.
    pub dispatches: u64,
    /// What they took together.
    pub dispatch_time: Duration,
    /// By what that was measured: "timestamp queries" or "wall clock".
    pub timer: &'static str,
}

/// A job on the device.
struct Prepared {
    job: RenderJob,
    block_limit: u32,
    kernel: Kernel,
    job_group: wgpu::BindGroup,
    order: wgpu::Buffer,
    blocks: wgpu::Buffer,
    film: wgpu::Buffer,
    counters: wgpu::Buffer,
    staging: wgpu::Buffer,
    dispatch_group: wgpu::BindGroup,
    /// Rows that the film buffer holds.
    slab_rows: u32,
    budget: Budget,
}

/// A submission that is not known to be done.
struct UnderWay {
    submission: wgpu::SubmissionIndex,
    timer: Option<usize>,
    paths: u64,
}

/// Renders on a GPU.
pub struct GpuRenderer {
    gpu: Gpu,
    options: GpuOptions,
    kernels: Kernels,
    timers: Vec<Timer>,
    words_group: wgpu::BindGroup,
    prepared: Option<Prepared>,
    report: GpuReport,
}

fn failed(reason: String) -> RenderError {
    RenderError::Backend { backend: "gpu", reason }
}

impl GpuRenderer {
    /// Opens an adapter.
    ///
    /// # Errors
    /// [`GpuError`], with the adapters that there are.
    pub fn new(options: GpuOptions) -> Result<Self, GpuError> {
        let gpu = Gpu::open(options.adapter.as_deref(), options.allow_software)?;
        let timers: Vec<Timer> = (0..QUEUE_DEPTH).map_while(|_| Timer::new(&gpu)).collect();
        let nothing = gpu
            .buffer("no words", 16, wgpu::BufferUsages::STORAGE)
            .map_err(|reason| GpuError::Device { adapter: gpu.adapter.to_string(), reason })?;
        let words_group = gpu.bind(&gpu.layouts.words, &[&nothing]);
        let timer = if timers.len() == QUEUE_DEPTH { "timestamp queries" } else { "wall clock" };
        let report = GpuReport { timer, ..GpuReport::default() };
        Ok(GpuRenderer {
            gpu,
            options,
            kernels: Kernels::default(),
            timers,
            words_group,
            prepared: None,
            report,
        })
    }

    /// The adapter.
    pub fn adapter(&self) -> &AdapterInfo {
        &self.gpu.adapter
    }

    /// What was compiled and measured so far.
    pub fn report(&self) -> &GpuReport {
        &self.report
    }

    /// What a dispatch should take from now on: [`INTERACTIVE_TARGET`] or [`BATCH_TARGET`].
    pub fn set_dispatch_target(&mut self, target: Duration) {
        self.options.dispatch_target = target;
        if let Some(prepared) = &mut self.prepared {
            prepared.budget.set_target(target);
        }
    }

    /// Builds all that a job needs on the device.
    fn built(&mut self, job: &RenderJob) -> Result<Prepared, String> {
        let gpu = &self.gpu;
        gpu.faults.check()?;
        let tables = Tables::<f32>::new(job);
        if let Some(depth) = tables.hierarchy.as_ref().map(|h| h.depth()).filter(|d| *d > STACK_SIZE) {
            return Err(format!(
                "the hierarchy has {depth} levels, the kernel room for {STACK_SIZE}; render this scene on the CPU"
            ));
        }
        let overrides = if self.options.specialise {
            Overrides::specialised(job, &tables)
        } else {
            Overrides::general(job, &tables)
        };
        let kernel = self.kernels.get(gpu, EntryPoint::PathTrace, &overrides, 0)?;

        // The scene.
        let listed: Vec<[f32; 4]> = tables.opaque.iter().chain(&tables.two_root).copied().collect();
        let anchored: Vec<GpuAnchoredSphere> = tables.anchored.iter().map(Into::into).collect();
        let rows: Vec<GpuRow> = tables.rows.iter().map(Into::into).collect();
        let nodes = tables.hierarchy.as_ref().map(GpuNode::all).unwrap_or_default();
        let storage = |label, data: &[u8]| {
            let limit = gpu.adapter.storage_binding_limit.min(gpu.adapter.buffer_limit);
            if data.len() as u64 > limit {
                return Err(format!(
                    "the {label} of {} spheres take {} bytes, but the adapter binds at most {limit}; render this scene on the CPU",
                    tables.rows.len(),
                    data.len(),
                ));
            }
            gpu.filled(label, data, wgpu::BufferUsages::STORAGE)
        };
        let scene = [
            gpu.filled("job", bytemuck::bytes_of(&GpuJob::new(&tables)), wgpu::BufferUsages::UNIFORM)?,
            storage("spheres", bytemuck::cast_slice(&listed))?,
            // At least one element of each, as the shader's types ask for.
            storage("anchored spheres", bytemuck::cast_slice(&at_least_one(anchored)))?,
            storage("rows", bytemuck::cast_slice(&rows))?,
            storage("nodes", bytemuck::cast_slice(&at_least_one(nodes)))?,
        ];
        let job_group = gpu.bind(&gpu.layouts.job, &scene.each_ref());

        // The film, or as many of its rows as fit a buffer, whole tiles each time.
        let settings = job.settings();
        let limit = gpu.adapter.storage_binding_limit.min(gpu.adapter.buffer_limit);
        let limit = self.options.film_limit.map_or(limit, |wanted| wanted.min(limit));
        let row_size = u64::from(settings.width) * settings.half_count() as u64 * PIXEL_SIZE;
        let tile_height = tile_size(settings.width, settings.height)[1];
        let fitting = (limit / row_size).min(u64::from(settings.height)) as u32;
        let slab_rows =
            if fitting == settings.height { fitting } else { fitting / tile_height * tile_height };
        if slab_rows == 0 {
            return Err(format!(
                "{tile_height} rows of {} pixels take {} bytes, but the adapter binds at most {limit}; choose a narrower picture or render on the CPU",
                settings.width,
                row_size * u64::from(tile_height),
            ));
        }
        let film_size = row_size * u64::from(slab_rows);
        let copied =
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let order = gpu.buffer(
            "dispatch",
            size_of::<GpuDispatch>() as u64,
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        )?;
        let blocks = gpu.buffer(
            "blocks",
            (BLOCK_LIMIT * size_of::<layout::GpuBlock>()) as u64,
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
        )?;
        let film = gpu.buffer("film", film_size, copied)?;
        let counters = gpu.buffer("counters", size_of::<GpuCounters>() as u64, copied)?;
        let staging = gpu.buffer(
            "film, read",
            film_size.min(STAGING_LIMIT),
            wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        )?;
        let dispatch_group = gpu.bind(&gpu.layouts.dispatch, &[&order, &blocks, &film, &counters]);
        gpu.faults.check()?;
        self.report.features = overrides.summary();
        self.report.compile_time = kernel.compile_time;
        Ok(Prepared {
            job: job.clone(),
            block_limit: tables.block_limit,
            kernel,
            job_group,
            order,
            blocks,
            film,
            counters,
            staging,
            dispatch_group,
            slab_rows,
            budget: Budget::new(self.options.dispatch_target),
        })
    }

    /// Traces samples `range` of rows `first_row ..` of the slab, and waits for the end of it.
    fn trace_slab(
        &mut self,
        prepared: &mut Prepared,
        range: &Range<u64>,
        first_row: u32,
        row_count: u32,
        cancel: &AtomicBool,
    ) -> Result<(), RenderError> {
        let settings = *prepared.job.settings();
        let [tile_width, tile_height] = tile_size(settings.width, settings.height);
        let tiles = settings.width.div_ceil(tile_width) * row_count.div_ceil(tile_height);
        let tile_pixels = u64::from(tile_width) * u64::from(tile_height);
        let pixels = u64::from(tiles) * tile_pixels;
        self.clear(&prepared.film);

        let mut left = Blocks::of_range(range.clone(), &settings, prepared.block_limit);
        let mut under_way: VecDeque<UnderWay> = VecDeque::new();
        let mut last_done = Instant::now();
        loop {
            let samples =
                self.options.samples_per_dispatch.unwrap_or_else(|| prepared.budget.paths() / pixels);
            let (blocks, samples) = left.take(samples);
            if blocks.is_empty() {
                break;
            }
            self.gpu.queue.write_buffer(&prepared.blocks, 0, bytemuck::cast_slice(&blocks));
            let mut first_tile = 0;
            while first_tile < tiles {
                if cancel.load(Ordering::Relaxed) {
                    // What is under way must not meet the next job's film.
                    for done in under_way {
                        self.gpu.wait(done.submission).map_err(failed)?;
                    }
                    return Err(RenderError::Cancelled);
                }
                // Evenly, so that no dispatch is left with a few tiles.
                let tiles_left = u64::from(tiles - first_tile);
                let affordable = (prepared.budget.paths() / (tile_pixels * samples).max(1)).max(1);
                let tile_count = tiles_left.div_ceil(tiles_left.div_ceil(affordable)) as u32;
                let order = GpuDispatch {
                    first_tile,
                    tile_count,
                    block_count: blocks.len() as u32,
                    ray_limit: samples
                        .saturating_mul(u64::from(settings.max_depth))
                        .saturating_add(1)
                        .min(u64::from(u32::MAX)) as u32,
                    first_row,
                    row_count,
                    ..GpuDispatch::default()
                };
                let paths = u64::from(tile_count) * tile_pixels * samples;
                let slot = (self.report.dispatches % QUEUE_DEPTH as u64) as usize;
                let timer = (self.timers.len() == QUEUE_DEPTH).then_some(slot);
                let submission = self.submit(prepared, &order, timer).map_err(failed)?;
                under_way.push_back(UnderWay { submission, timer, paths });
                if under_way.len() == QUEUE_DEPTH {
                    self.finish(prepared, &mut under_way, &mut last_done)?;
                }
                first_tile += tile_count;
            }
        }
        while !under_way.is_empty() {
            self.finish(prepared, &mut under_way, &mut last_done)?;
        }
        Ok(())
    }

    fn clear(&self, buffer: &wgpu::Buffer) {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(buffer, 0, None);
        self.gpu.queue.submit([encoder.finish()]);
    }

    /// Sends a dispatch off.
    fn submit(
        &mut self,
        prepared: &Prepared,
        order: &GpuDispatch,
        timer: Option<usize>,
    ) -> Result<wgpu::SubmissionIndex, String> {
        if self.options.simulate_device_lost_after == Some(self.report.dispatches) {
            self.gpu.device.destroy();
        }
        let timer = timer.map(|slot| &self.timers[slot]);
        self.gpu.queue.write_buffer(&prepared.order, 0, bytemuck::bytes_of(order));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("path_trace"),
                timestamp_writes: timer.map(Timer::writes),
            });
            pass.set_pipeline(&prepared.kernel.pipeline);
            pass.set_bind_group(0, &prepared.job_group, &[]);
            pass.set_bind_group(1, &prepared.dispatch_group, &[]);
            pass.set_bind_group(2, &self.words_group, &[]);
            let [x, y] = groups(order.tile_count);
            pass.dispatch_workgroups(x, y, 1);
        }
        if let Some(timer) = timer {
            timer.resolve(&mut encoder);
        }
        let submission = self.gpu.queue.submit([encoder.finish()]);
        self.report.dispatches += 1;
        self.gpu.faults.check().map(|()| submission)
    }

    /// Waits for the oldest dispatch and learns from it.
    fn finish(
        &mut self,
        prepared: &mut Prepared,
        under_way: &mut VecDeque<UnderWay>,
        last_done: &mut Instant,
    ) -> Result<(), RenderError> {
        let Some(done) = under_way.pop_front() else { return Ok(()) };
        let took = match done.timer {
            Some(slot) => self.timers[slot].wait(&self.gpu, done.submission).map_err(failed)?,
            None => {
                self.gpu.wait(done.submission).map_err(failed)?;
                let now = Instant::now();
                let took = now - *last_done;
                *last_done = now;
                took
            }
        };
        self.report.dispatch_time += took;
        prepared.budget.learn(done.paths, took);
        Ok(())
    }

    fn accumulated(
        &mut self,
        prepared: &mut Prepared,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        // Refused before anything is added, not after.
        film.samples().clone().insert(range.clone())?;
        let settings = *prepared.job.settings();
        self.clear(&prepared.counters);
        let mut trace = Duration::ZERO;
        let mut slabs = Vec::new();
        let mut first_row = 0;
        while first_row < settings.height {
            let row_count = prepared.slab_rows.min(settings.height - first_row);
            let start = Instant::now();
            self.trace_slab(prepared, &range, first_row, row_count, cancel)?;
            trace += start.elapsed();
            slabs.push((first_row, self.read_film(prepared, row_count).map_err(failed)?));
            first_row += row_count;
        }
        let mut counters = GpuCounters::default();
        let size = size_of::<GpuCounters>() as u64;
        readback::read(&self.gpu, &prepared.counters, size, &prepared.staging, size, |_, bytes| {
            counters = bytemuck::pod_read_unaligned(bytes);
        })
        .map_err(failed)?;

        // All is here: from now on nothing can fail.
        let wide = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        let rejected = wide(counters.rejected, counters.rejected_high);
        for (first_row, sums) in slabs {
            let start = first_row as usize * settings.width as usize;
            let halves = film.halves_mut();
            let pixels = sums.len() / halves.len();
            for (half, sums) in halves.iter_mut().zip(sums.chunks_exact(pixels)) {
                for (sum, more) in half[start..start + pixels].iter_mut().zip(sums) {
                    sum.add(*more);
                }
            }
        }
        let paths = u64::from(settings.width) * u64::from(settings.height) * (range.end - range.start);
        film.record(range, rejected)?;
        let rays = wide(counters.rays, counters.rays_high);
        Ok(Stats { paths, rays, rejected, busy_lanes: rays, offered_lanes: rays, trace })
    }

    /// The sums of the slab, half by half.
    fn read_film(&self, prepared: &Prepared, row_count: u32) -> Result<Vec<PixelSum>, String> {
        let settings = prepared.job.settings();
        let pixels = u64::from(settings.width) * u64::from(row_count) * settings.half_count() as u64;
        let mut sums = Vec::with_capacity(pixels as usize);
        let size = pixels * PIXEL_SIZE;
        readback::read(&self.gpu, &prepared.film, size, &prepared.staging, PIXEL_SIZE, |_, bytes| {
            sums.extend(bytes.chunks_exact(PIXEL_SIZE as usize).map(|pixel| {
                let channel = |i: usize| pixel[8 * i..8 * i + 8].try_into().map_or(0, u64::from_le_bytes);
                PixelSum([channel(0), channel(1), channel(2)])
            }));
        })?;
        Ok(sums)
    }

    /// A film of this job as a picture, made on the device: one word a pixel, red in the lowest byte.
    ///
    /// # Errors
    /// [`RenderError::Backend`], also where the film does not fit one buffer.
    pub fn resolve(
        &mut self,
        job: &RenderJob,
        film: &Film,
        transfer: Transfer,
    ) -> Result<Vec<u32>, RenderError> {
        self.prepare(job)?;
        let Some(prepared) = self.prepared.take() else { return Ok(Vec::new()) };
        let picture = self.resolved(&prepared, film, transfer);
        self.prepared = Some(prepared);
        picture.map_err(failed)
    }

    fn resolved(&mut self, prepared: &Prepared, film: &Film, transfer: Transfer) -> Result<Vec<u32>, String> {
        let (width, height) = (film.width(), film.height());
        if prepared.slab_rows < height {
            return Err(format!(
                "{height} rows are in the film, but the adapter binds {}",
                prepared.slab_rows
            ));
        }
        let kernel = self.kernels.get(&self.gpu, EntryPoint::Resolve, &Overrides::default(), 0)?;
        let pixels = width as usize * height as usize;
        let sums: Vec<u64> = (0..pixels).flat_map(|i| film.pixel_sum(i).0).collect();
        self.gpu.queue.write_buffer(&prepared.film, 0, bytemuck::cast_slice(&sums));
        let order = GpuDispatch {
            row_count: height,
            sample_count: film.sample_count().min(u64::from(u32::MAX)) as u32,
            transfer: transfer_tag(transfer),
            ..GpuDispatch::default()
        };
        self.gpu.queue.write_buffer(&prepared.order, 0, bytemuck::bytes_of(&order));
        let group_count = (pixels as u32).div_ceil(layout::WORKGROUP_SIZE);
        self.run_words(prepared, &kernel, vec![0; pixels], group_count)
    }

    /// Runs a small function of the shaders on many inputs of [`PROBE_STRIDE`] words each, and returns as many
    /// words of output: for tests. The functions and their words are listed in shaders/probe.wgsl.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    pub fn probe(&mut self, job: &RenderJob, probe: Probe, words: Vec<u32>) -> Result<Vec<u32>, RenderError> {
        self.prepare(job)?;
        let Some(prepared) = self.prepared.take() else { return Ok(Vec::new()) };
        let groups = (words.len() / PROBE_STRIDE).div_ceil(layout::WORKGROUP_SIZE as usize) as u32;
        let overrides = Overrides { dielectric_laws: job.rules().dielectric, ..Overrides::default() };
        let done = self
            .kernels
            .get(&self.gpu, EntryPoint::Probe, &overrides, probe as u32)
            .and_then(|kernel| self.run_words(&prepared, &kernel, words, groups));
        self.prepared = Some(prepared);
        done.map_err(failed)
    }

    fn run_words(
        &self,
        prepared: &Prepared,
        kernel: &Kernel,
        mut words: Vec<u32>,
        group_count: u32,
    ) -> Result<Vec<u32>, String> {
        let gpu = &self.gpu;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let buffer = gpu.filled("words", bytemuck::cast_slice(&words), usage)?;
        let group = gpu.bind(&gpu.layouts.words, &[&buffer]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &prepared.job_group, &[]);
            pass.set_bind_group(1, &prepared.dispatch_group, &[]);
            pass.set_bind_group(2, &group, &[]);
            let [x, y] = groups(group_count);
            pass.dispatch_workgroups(x, y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        let size = words.len() as u64 * 4;
        readback::read(gpu, &buffer, size, &prepared.staging, 4, |offset, bytes| {
            let first = offset as usize / 4;
            for (word, four) in words[first..].iter_mut().zip(bytes.chunks_exact(4)) {
                *word = four.try_into().map_or(0, u32::from_le_bytes);
            }
        })?;
        Ok(words)
    }
}

fn at_least_one<T: bytemuck::Zeroable>(mut items: Vec<T>) -> Vec<T> {
    if items.is_empty() {
        items.push(T::zeroed());
    }
    items
}

/// Workgroups along x and y that are together at least `count`.
fn groups(count: u32) -> [u32; 2] {
    if count <= GROUPS_ACROSS { [count, 1] } else { [GROUPS_ACROSS, count.div_ceil(GROUPS_ACROSS)] }
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

    fn prepare(&mut self, job: &RenderJob) -> Result<(), RenderError> {
        if self.prepared.as_ref().is_some_and(|prepared| prepared.job == *job) {
            return Ok(());
        }
        self.prepared = None;
        let prepared = self.built(job).map_err(failed)?;
        self.prepared = Some(prepared);
        Ok(())
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.prepare(job)?;
        let Some(mut prepared) = self.prepared.take() else {
            return Err(failed("nothing was prepared".to_owned()));
        };
        let result = self.accumulated(&mut prepared, range, film, cancel);
        self.prepared = Some(prepared);
        result
    }
}
