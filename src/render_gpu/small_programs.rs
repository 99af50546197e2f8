//! Programs other than tracing: converting the film to a picture, small functions for tests, and recording one path.

use super::dispatches::{self, groups};
use super::film_buffers::FilmBuffers;
use super::kernel::Kernel;
use super::layout::{GpuDispatch, WORKGROUP_SIZE};
use super::loaded::Loaded;
use super::schedule::Blocks;
use super::shader_source::{EntryPoint, Probe};
use super::{GpuRenderer, ITERATION_LIMIT, failed, readback, record};
use crate::film::Film;
use crate::job::render::{RenderError, RenderJob};
use crate::kernel::path_record::PathRecord;
use crate::kernel::{Features, PROBE_STRIDE, Tag};
use crate::stages::Transfer;
use std::sync::atomic::AtomicBool;

impl GpuRenderer {
    /// Converts a film of this job to a picture on the device: one word per pixel, red in the lowest byte.
    ///
    /// # Errors
    /// [`RenderError::Backend`], also if the film does not fit one buffer.
    pub fn resolve(
        &mut self,
        job: &RenderJob,
        film: &Film,
        transfer: Transfer,
    ) -> Result<Vec<u32>, RenderError> {
        self.with_loaded(job, &go_on(), |this, loaded| {
            let kernel =
                this.kernels.get(&this.gpu, (EntryPoint::Resolve, Features::default(), 0), &go_on())?;
            let buffers = this.own_film(loaded)?;
            let (width, height) = (film.width(), film.height());
            let Some(sums_on_device) = buffers.sums_of_whole() else {
                return Err(failed(format!("a film of {width}x{height} does not fit one buffer")));
            };
            let pixels = width as usize * height as usize;
            let sums: Vec<u64> = (0..pixels).flat_map(|i| film.pixel_sum(i).0).collect();
            this.gpu.queue.write_buffer(sums_on_device, 0, bytemuck::cast_slice(&sums));
            let parameters = GpuDispatch {
                row_count: height,
                sample_count: film.sample_count().min(u64::from(u32::MAX)) as u32,
                transfer: transfer.tag(),
                ..GpuDispatch::default()
            };
            this.gpu.queue.write_buffer(&buffers.parameters, 0, bytemuck::bytes_of(&parameters));
            let groups = (pixels as u32).div_ceil(WORKGROUP_SIZE);
            this.run(loaded, &buffers, &kernel, &vec![0; pixels], groups)
        })
    }

    /// Runs a small shader function on many inputs of [`PROBE_STRIDE`] words each and returns as many words of output,
    /// for tests. shaders/probe.wgsl lists the functions and their words.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    pub fn probe(&mut self, job: &RenderJob, probe: Probe, words: &[u32]) -> Result<Vec<u32>, RenderError> {
        self.with_loaded(job, &go_on(), |this, loaded| {
            let features = Features { dielectric_laws: job.rules().dielectric, ..Features::default() };
            let kernel =
                this.kernels.get(&this.gpu, (EntryPoint::Probe, features, probe as u32), &go_on())?;
            let groups = (words.len() / PROBE_STRIDE).div_ceil(WORKGROUP_SIZE as usize) as u32;
            this.run(loaded, &loaded.film, &kernel, words, groups)
        })
    }

    /// Records sample `index` of pixel (`x`, `y`), which must be inside the picture, as the kernel of `job` traces it.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    pub fn record_path(
        &mut self,
        job: &RenderJob,
        pixel: [u32; 2],
        index: u64,
    ) -> Result<PathRecord, RenderError> {
        self.with_loaded(job, &go_on(), |this, loaded| {
            let kernel =
                this.kernels.get(&this.gpu, (EntryPoint::PathRecord, loaded.features, 0), &go_on())?;
            let buffers = this.own_film(loaded)?;
            let settings = job.settings();
            let (blocks, _) =
                Blocks::of_range(index..index + 1, settings, loaded.scene.prepared.block_limit).take(1);
            let mut parameters = GpuDispatch {
                block_count: blocks.len() as u32,
                iteration_limit: ITERATION_LIMIT,
                row_count: buffers.slabs.first().map_or(0, |slab| slab.row_count),
                first_suspended: record::first_suspended(settings.max_depth) as u32,
                ..GpuDispatch::default()
            };
            this.gpu.queue.write_buffer(&buffers.blocks, 0, bytemuck::cast_slice(&blocks));
            let mut words = record::words_for(pixel, settings.max_depth);
            let mut rays = 0;
            loop {
                this.gpu.queue.write_buffer(&buffers.parameters, 0, bytemuck::bytes_of(&parameters));
                words = this.run(loaded, &buffers, &kernel, &words, 1)?;
                match record::is_suspended(&words, settings.max_depth, &mut rays) {
                    Some(true) => parameters.resumes = 1,
                    Some(false) => {
                        let (index, origin) = (&loaded.scene.scene_index, loaded.scene.prepared.origin);
                        return Ok(record::from_words(&words, settings.max_depth, index, origin));
                    }
                    None => return Err(failed(dispatches::stuck(1))),
                }
            }
        })
    }

    /// Buffers for a film, separate from the one being traced.
    fn own_film(&self, loaded: &Loaded) -> Result<FilmBuffers, RenderError> {
        FilmBuffers::new(&self.gpu, loaded.job.settings(), self.film_limit()).map_err(failed)
    }

    /// Runs a kernel on `words` and returns the resulting words.
    fn run(
        &self,
        loaded: &Loaded,
        film: &FilmBuffers,
        kernel: &Kernel,
        words: &[u32],
        group_count: u32,
    ) -> Result<Vec<u32>, RenderError> {
        let Some(slab) = film.slabs.first() else { return Ok(Vec::new()) };
        let gpu = &self.gpu;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let buffer = gpu.filled("words", bytemuck::cast_slice(words), usage).map_err(failed)?;
        let group = gpu.bind(&gpu.layouts.words, &[&buffer]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&kernel.pipeline);
            pass.set_bind_group(0, &loaded.scene.group, &[]);
            pass.set_bind_group(1, &slab.group, &[]);
            pass.set_bind_group(2, &group, &[]);
            let [x, y] = groups(group_count);
            pass.dispatch_workgroups(x, y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        readback::words(gpu, &buffer, words.len()).map_err(failed)
    }
}

/// A flag that never cancels: these programs are short.
fn go_on() -> AtomicBool {
    AtomicBool::new(false)
}
