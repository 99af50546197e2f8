//! Records one path on the device, and reads it.
//!
//! On the device: shaders/record.wgsl

use super::dispatches::stuck;
use super::film_buffers::FilmBuffers;
use super::layout::GpuDispatch;
use super::loaded::SceneOnDevice;
use super::readback::Staging;
use super::schedule::Blocks;
use super::shader_source::EntryPoint;
use super::{GpuRenderer, ITERATION_LIMIT, failed};
use crate::film::PixelSum;
use crate::job::render::{RenderError, RenderJob};
use crate::kernel::path_record::{PathRecord, RecordedHit, RecordedRay};
use crate::kernel::{GpuRecordHead, GpuRecordedRay, GpuSuspendedPath, NONE, word_count};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
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
        // Recording a path is quick.
        let never = AtomicBool::new(false);
        self.with_loaded(job, &never, |this, loaded| {
            let key = (EntryPoint::PathRecord, loaded.features);
            let kernel = this.kernels.get(&this.gpu, key, &never)?;
            // Not the film that is being traced.
            let settings = job.settings();
            let film = FilmBuffers::new(&this.gpu, settings, this.film_limit()).map_err(failed)?;
            let SceneOnDevice { prepared, scene_index, group, .. } = &loaded.scene;
            let (blocks, _) = Blocks::of_range(index..index + 1, settings, prepared.block_limit).take(1);
            let mut parameters = GpuDispatch {
                block_count: blocks.len() as u32,
                iteration_limit: ITERATION_LIMIT,
                row_count: film.slabs[0].row_count,
                first_suspended: first_suspended(settings.max_depth) as u32,
                ..GpuDispatch::default()
            };
            let queue = &this.gpu.queue;
            queue.write_buffer(&film.blocks, 0, bytemuck::cast_slice(&blocks));
            let mut words = words_for(pixel, settings.max_depth);
            let mut rays = 0;
            loop {
                queue.write_buffer(&film.parameters, 0, bytemuck::bytes_of(&parameters));
                words = this.run(&kernel.pipeline, group, &film.slabs[0].group, &words).map_err(failed)?;
                match is_suspended(&words, settings.max_depth, &mut rays) {
                    Some(true) => parameters.resumes = 1,
                    Some(false) => {
                        return Ok(from_words(&words, settings.max_depth, scene_index, prepared.origin));
                    }
                    None => return Err(failed(stuck(1))),
                }
            }
        })
    }

    /// Runs one workgroup of a kernel on `words` and returns the resulting words.
    fn run(
        &self,
        pipeline: &wgpu::ComputePipeline,
        scene: &wgpu::BindGroup,
        film: &wgpu::BindGroup,
        words: &[u32],
    ) -> Result<Vec<u32>, String> {
        use wgpu::BufferUsages as Usages;
        let (gpu, size) = (&self.gpu, size_of_val(words) as u64);
        let data = bytemuck::cast_slice(words);
        let buffer = gpu.filled("scratch", data, Usages::STORAGE | Usages::COPY_SRC)?;
        let mut staging = Staging::new(gpu, "scratch, read", size)?;
        let group = gpu.bind(&gpu.layouts.scratch, &[&buffer]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            for (group, number) in [scene, film, &group].into_iter().zip(0..) {
                pass.set_bind_group(number, group, &[]);
            }
            pass.dispatch_workgroups(1, 1, 1);
        }
        encoder.copy_buffer_to_buffer(&buffer, 0, &staging.buffer, 0, size);
        let submission = gpu.queue.submit([encoder.finish()]);
        staging.request();
        gpu.wait_unless(&submission, None)?;
        Ok(bytemuck::pod_collect_to_vec(&staging.view()?[..size as usize]))
    }
}

/// Number of words before those of the suspended path.
fn first_suspended(max_depth: u32) -> usize {
    first_of_ray(max_depth as usize)
}

fn first_of_ray(number: usize) -> usize {
    word_count::<GpuRecordHead>() + word_count::<GpuRecordedRay>() * number
}

/// The words for recording the path at `pixel`, including the shader's input.
fn words_for([column, row]: [u32; 2], max_depth: u32) -> Vec<u32> {
    let mut words = vec![0; first_suspended(max_depth) + word_count::<GpuSuspendedPath>()];
    let head = GpuRecordHead { column, row, ..GpuRecordHead::default() };
    words[..word_count::<GpuRecordHead>()].copy_from_slice(bytemuck::cast_slice(&[head]));
    words
}

/// Returns whether the path was suspended and the shader must resume it; `rays` becomes the number of rays recorded
/// so far. Returns `None` if the path has not advanced since `rays` were recorded.
fn is_suspended(words: &[u32], max_depth: u32, rays: &mut u32) -> Option<bool> {
    if read::<GpuSuspendedPath>(words, first_suspended(max_depth)).state == 0 {
        return Some(false);
    }
    let before = std::mem::replace(rays, read::<GpuRecordHead>(words, 0).ray_count);
    (*rays != before).then_some(true)
}

/// Decodes the path from the words. `scene_index` maps a sphere's number to its index in the scene; positions are
/// relative to `origin`.
fn from_words(words: &[u32], max_depth: u32, scene_index: &[u32], origin: DVec3) -> PathRecord {
    let head: GpuRecordHead = read(words, 0);
    let count = head.ray_count.min(max_depth) as usize;
    let rays: Vec<GpuRecordedRay> = (0..count).map(|number| read(words, first_of_ray(number))).collect();
    let vector = |of: [f32; 3]| of.map(f64::from);
    let position = |of: [f32; 3]| (DVec3::from_array(vector(of)) + origin).to_array();
    let recorded = |(number, ray): (usize, &GpuRecordedRay)| RecordedRay {
        origin: position(ray.origin),
        direction: vector(ray.direction),
        throughput: vector(ray.throughput),
        hit: (ray.sphere != NONE).then(|| RecordedHit {
            sphere: scene_index.get(ray.sphere as usize).map_or(usize::MAX, |index| *index as usize),
            distance: f64::from(ray.distance),
            position: rays.get(number + 1).map(|next| position(next.origin)),
        }),
    };
    PathRecord {
        rays: rays.iter().enumerate().map(recorded).collect(),
        radiance: PixelSum(head.sums.map(u64::from)).radiance(),
    }
}

/// The record that begins at word `first`; all zeros if it is not there.
fn read<T: Pod>(words: &[u32], first: usize) -> T {
    let its_words = words.get(first..first + word_count::<T>());
    its_words.map_or_else(Zeroable::zeroed, |its_words| {
        bytemuck::pod_read_unaligned(bytemuck::cast_slice(its_words))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stores a record from the word `first` on.
    fn put<T: Pod>(words: &mut [u32], first: usize, record: T) {
        words[first..first + word_count::<T>()].copy_from_slice(bytemuck::cast_slice(&[record]));
    }

    #[test]
    fn suspended_path_resumes_while_it_advances() {
        let mut words = words_for([7, 5], 4);
        assert_eq!((read::<GpuRecordHead>(&words, 0).column, read::<GpuRecordHead>(&words, 0).row), (7, 5));
        let mut rays = 0;
        assert_eq!((is_suspended(&words, 4, &mut rays), rays), (Some(false), 0));
        put(
            &mut words,
            first_suspended(4),
            GpuSuspendedPath { state: 1 << 16, ..GpuSuspendedPath::default() },
        );
        for ray_count in [2, 3] {
            put(&mut words, 0, GpuRecordHead { ray_count, ..GpuRecordHead::default() });
            assert_eq!((is_suspended(&words, 4, &mut rays), rays), (Some(true), ray_count));
        }
        assert_eq!(is_suspended(&words, 4, &mut rays), None, "it stands still");
        // It has ended, with as many rays as before.
        put(&mut words, first_suspended(4), GpuSuspendedPath::default());
        assert_eq!(is_suspended(&words, 4, &mut rays), Some(false));
    }
}
