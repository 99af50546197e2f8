//! A job on the device: the prepared scene and its hierarchy in buffers, the kernel, and the film.

use super::film_buffers::FilmBuffers;
use super::kernel::Kernel;
use super::layout::{GpuJob, WORKGROUP_SIZE, tile_size};
use super::scene::{ITERATION_LIMIT, SceneData, iterations_over_lists};
use super::{GpuRenderer, failed};
use crate::job::render::{RenderError, RenderJob};
use crate::kernel::{Features, RECORD_COLUMNS, words_of};
use crate::prepared::PreparedScene;
use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

/// A job loaded to the device.
pub(super) struct Loaded {
    pub(super) job: RenderJob,
    pub(super) scene: SceneOnDevice,
    pub(super) features: Features,
    pub(super) kernel: Kernel,
    pub(super) film: FilmBuffers,
}

/// A scene in buffers, prepared for a camera.
pub(super) struct SceneOnDevice {
    pub(super) prepared: PreparedScene<f32>,
    /// Number of nodes in the hierarchy.
    node_count: u32,
    job_buffer: wgpu::Buffer,
    anchored_buffer: wgpu::Buffer,
    rows_buffer: wgpu::Buffer,
    /// Group 0: the buffers of job and scene.
    pub(super) group: wgpu::BindGroup,
}

impl GpuRenderer {
    /// Takes what is loaded, or loads what `job` needs.
    pub(super) fn take_loaded(
        &mut self,
        job: &RenderJob,
        cancel: &AtomicBool,
    ) -> Result<Loaded, RenderError> {
        match self.loaded.take() {
            Some(loaded) if loaded.job == *job => Ok(loaded),
            old => {
                self.dispatches.discard();
                self.load(job, old, cancel)
            }
        }
    }

    fn load(
        &mut self,
        job: &RenderJob,
        old: Option<Loaded>,
        cancel: &AtomicBool,
    ) -> Result<Loaded, RenderError> {
        self.gpu.faults.check().map_err(failed)?;
        let (mut old_scene, old_film) =
            old.map_or((None, None), |old| (Some((old.scene, old.job)), Some(old.film)));
        let is_reused =
            old_scene.as_mut().is_some_and(|(scene, before)| scene.prepared.try_reuse(before, job));
        let scene = match old_scene {
            Some((scene, _)) if is_reused => {
                let data = GpuJob::new(&scene.prepared, scene.node_count);
                self.gpu.queue.write_buffer(&scene.job_buffer, 0, bytemuck::cast_slice(&words_of(&[data])));
                self.upload_anchored(&scene);
                scene
            }
            other => {
                // The device may not have room for both.
                drop(other);
                self.scene_on_device(job, cancel)?
            }
        };
        let features = self.features(&scene.prepared);
        self.check_lists(&features, &scene.prepared).map_err(failed)?;
        self.kernels.begin(&self.gpu, features);
        self.messages.extend(scene.prepared.warning.clone());
        let film = self.film_buffers(job, old_film).map_err(failed)?;
        self.reserve_suspended(job).map_err(failed)?;
        let kernel = self.kernels.get(&self.gpu, features, cancel)?;
        self.gpu.faults.check().map_err(failed)?;
        if self.dispatches.is_new(&features) {
            self.gpu.expect_compiling();
        }
        Ok(Loaded { job: job.clone(), scene, features, kernel, film })
    }

    /// The anchors of spheres depend on the position of the eye.
    fn upload_anchored(&self, scene: &SceneOnDevice) {
        let prepared = &scene.prepared;
        let anchored = words_of(&prepared.anchored);
        let first = prepared.opaque.len() + prepared.two_root.len();
        let records: Vec<[f32; RECORD_COLUMNS]> = prepared.records[first..].iter().map(|row| row.0).collect();
        let queue = &self.gpu.queue;
        queue.write_buffer(&scene.anchored_buffer, 0, bytemuck::cast_slice(&anchored));
        let offset = (first * RECORD_COLUMNS * size_of::<f32>()) as u64;
        queue.write_buffer(&scene.rows_buffer, offset, bytemuck::cast_slice(&records));
    }

    /// Builds the prepared scene and its hierarchy while the kernel compiles, and uploads them to the device.
    fn scene_on_device(
        &mut self,
        job: &RenderJob,
        cancel: &AtomicBool,
    ) -> Result<SceneOnDevice, RenderError> {
        let (gpu, kernels) = (&self.gpu, &mut self.kernels);
        let specialise = self.options.specialise;
        let made = PreparedScene::<f32>::for_gpu(cancel, job, |needed| {
            let features = if specialise { *needed } else { needed.generalised() };
            // With a hierarchy, paths may be suspended.
            kernels.begin(gpu, Features { suspends: true, ..features });
        });
        let mut prepared = made.ok_or(RenderError::Cancelled)?;
        let data = SceneData::new(&mut prepared);
        self.upload(prepared, data).map_err(failed)
    }

    fn features(&self, prepared: &PreparedScene<f32>) -> Features {
        let needed = prepared.features;
        let features = if self.options.specialise { needed } else { needed.generalised() };
        Features { suspends: self.dispatches.whole_samples(&features, prepared).is_none(), ..features }
    }

    /// Rejects lists that are longer than the driver's loops allow.
    fn check_lists(&self, features: &Features, prepared: &PreparedScene<f32>) -> Result<(), String> {
        let iterations = iterations_over_lists(features, prepared);
        if self.gpu.adapter.threads_in_step() > 1 && iterations >= u64::from(ITERATION_LIMIT) {
            return Err(format!(
                "each ray is tested against {iterations} spheres, but loops of {} end after {ITERATION_LIMIT} iterations; render this scene on the CPU",
                self.gpu.adapter.name
            ));
        }
        Ok(())
    }

    /// Allocates storage for the paths that the threads of a picture may suspend.
    fn reserve_suspended(&mut self, job: &RenderJob) -> Result<(), String> {
        let (width, height) = (job.settings().width, job.settings().height);
        let [tile_width, tile_height] = tile_size(width, height);
        let tiles = u64::from(width.div_ceil(tile_width)) * u64::from(height.div_ceil(tile_height));
        let threads = tiles * u64::from(WORKGROUP_SIZE);
        self.dispatches.reserve_suspended(&self.gpu, threads, self.binding_limit())
    }

    /// Size limit of a buffer binding in a shader, in bytes.
    fn binding_limit(&self) -> u64 {
        self.gpu.adapter.storage_binding_limit.min(self.gpu.adapter.buffer_limit)
    }

    fn upload(&self, prepared: PreparedScene<f32>, scene: SceneData) -> Result<SceneOnDevice, String> {
        let gpu = &self.gpu;
        let limit = self.binding_limit();
        let contents = scene.buffers(&prepared);
        if let Some((label, data)) = contents.iter().find(|(_, data)| data.len() as u64 > limit) {
            return Err(format!(
                "the {label} of {} spheres take {} bytes, but the adapter binds at most {limit}; render this scene on the CPU",
                prepared.records.len(),
                data.len(),
            ));
        }
        let filled = |(label, data): &(&'static str, Cow<'_, [u8]>)| {
            let usage = match *label {
                "job" => wgpu::BufferUsages::UNIFORM,
                _ => wgpu::BufferUsages::STORAGE,
            };
            let buffer = gpu.buffer(label, data.len() as u64, usage | wgpu::BufferUsages::COPY_DST)?;
            gpu.queue.write_buffer(&buffer, 0, data);
            Ok(buffer)
        };
        let buffers = contents.iter().map(filled).collect::<Result<Vec<_>, String>>()?;
        let group = gpu.bind(&gpu.layouts.job, &buffers.iter().collect::<Vec<_>>());
        let [job_buffer, _, anchored_buffer, rows_buffer, _] = <[wgpu::Buffer; 5]>::try_from(buffers)
            .map_err(|buffers| format!("{} buffers instead of 5", buffers.len()))?;
        Ok(SceneOnDevice {
            group,
            anchored_buffer,
            rows_buffer,
            node_count: scene.node_count,
            job_buffer,
            prepared,
        })
    }

    /// Empty buffers for a film of `job`; reuses the old ones if they fit.
    fn film_buffers(&self, job: &RenderJob, old: Option<FilmBuffers>) -> Result<FilmBuffers, String> {
        let limit = self.binding_limit().min(self.options.film_limit.unwrap_or(u64::MAX));
        // The device may not have room for both.
        let Some(mut film) = old.filter(|film| film.fit(job.settings(), limit)) else {
            return FilmBuffers::new(&self.gpu, job.settings(), limit);
        };
        // Work in flight was abandoned.
        film.discard(&self.gpu);
        Ok(film)
    }
}
