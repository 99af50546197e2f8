//! Records one path on the device.

use super::dispatches;
use super::film_buffers::FilmBuffers;
use super::kernel::Kernel;
use super::layout::GpuDispatch;
use super::loaded::Loaded;
use super::schedule::Blocks;
use super::shader_source::EntryPoint;
use super::{GpuRenderer, ITERATION_LIMIT, failed, readback, record};
use crate::job::render::{RenderError, RenderJob};
use crate::kernel::path_record::PathRecord;
use std::sync::atomic::AtomicBool;

impl GpuRenderer {
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
            let kernel = this.kernels.get(&this.gpu, (EntryPoint::PathRecord, loaded.features), &go_on())?;
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
                words = this.run(loaded, &buffers, &kernel, &words)?;
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

    /// Runs one workgroup of a kernel on `words` and returns the resulting words.
    fn run(
        &self,
        loaded: &Loaded,
        film: &FilmBuffers,
        kernel: &Kernel,
        words: &[u32],
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
            pass.dispatch_workgroups(1, 1, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        readback::words(gpu, &buffer, words.len()).map_err(failed)
    }
}

/// A flag that never cancels: recording a path is quick.
fn go_on() -> AtomicBool {
    AtomicBool::new(false)
}
