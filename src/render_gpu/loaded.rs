//! A job on the device: prepared scene and hierarchy in buffers, the kernel, the film.

use super::dispatches::TURN_LIMIT;
use super::film_buffers::FilmBuffers;
use super::kernel::Kernel;
use super::layout::{GpuJob, WORKGROUP_SIZE, tile_size};
use super::options::InjectionPoint;
use super::scene::SceneData;
use super::shader_source::EntryPoint;
use super::{GpuRenderer, HierarchyKind, failed};
use crate::kernel::{Features, RECORD_COLUMNS, words_of};
use crate::prepared::PreparedScene;
use crate::render::{RenderError, RenderJob};
use crate::stages::Surface;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// A job on the device.
pub(super) struct Loaded {
    pub(super) job: RenderJob,
    pub(super) scene: SceneOnDevice,
    pub(super) features: Features,
    pub(super) kernel: Kernel,
    pub(super) film: FilmBuffers,
}

/// A scene in buffers, seen by a camera.
pub(super) struct SceneOnDevice {
    pub(super) prepared: PreparedScene<f32>,
    /// By number, the sphere's index in the scene.
    pub(super) scene_index: Vec<u32>,
    /// Nodes of the hierarchy.
    node_count: u32,
    job_buffer: wgpu::Buffer,
    anchored_buffer: wgpu::Buffer,
    rows_buffer: wgpu::Buffer,
    /// Group 0: the job's buffer and the scene's.
    pub(super) group: wgpu::BindGroup,
}

impl GpuRenderer {
    /// Builds what `job` needs, unless that is there.
    pub(super) fn get_ready(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        if self.loaded.as_ref().is_none_or(|loaded| loaded.job != *job) {
            let old = self.loaded.take();
            self.dispatches.abandon();
            self.inject(InjectionPoint::Prepare, self.preparations);
            self.preparations += 1;
            self.loaded = Some(self.built(job, old, cancel)?);
        }
        Ok(())
    }

    fn built(
        &mut self,
        job: &RenderJob,
        old: Option<Loaded>,
        cancel: &AtomicBool,
    ) -> Result<Loaded, RenderError> {
        self.gpu.faults.check().map_err(failed)?;
        let (mut seen, old_film) =
            old.map_or((None, None), |old| (Some((old.scene, old.job)), Some(old.film)));
        let follows = seen.as_mut().is_some_and(|(scene, before)| scene.prepared.follow(before, job));
        let scene = match seen {
            Some((scene, _)) if follows => {
                let data = GpuJob::new(&scene.prepared, scene.node_count);
                self.gpu.queue.write_buffer(&scene.job_buffer, 0, bytemuck::cast_slice(&words_of(&[data])));
                self.renew_anchored(&scene);
                self.report.hierarchy_time = Duration::ZERO;
                scene
            }
            other => {
                // Both need not fit into the device.
                drop(other);
                self.scene_on_device(job)?
            }
        };
        let features = self.features(&scene.prepared);
        self.check_lists(&features, &scene.prepared).map_err(failed)?;
        self.kernels.begin(&self.gpu, EntryPoint::PathTrace, &features, 0);
        self.messages.extend(scene.prepared.warnings().iter().cloned());
        let film = self.film_buffers(job, old_film).map_err(failed)?;
        self.make_room(job).map_err(failed)?;
        let kernel = self.kernels.get(&self.gpu, EntryPoint::PathTrace, &features, 0, cancel)?;
        self.gpu.faults.check().map_err(failed)?;
        if self.dispatches.is_new(&features) {
            self.gpu.expect_compiling();
        }
        self.report.features = features.describe();
        self.report.compile_time = kernel.compile_time;
        Ok(Loaded { job: job.clone(), scene, features, kernel, film })
    }

    /// Where spheres are anchored depends on the eye.
    fn renew_anchored(&self, scene: &SceneOnDevice) {
        let prepared = &scene.prepared;
        let anchored = words_of(&prepared.anchored);
        let first = prepared.opaque.len() + prepared.two_root.len();
        let records: Vec<[f32; RECORD_COLUMNS]> = prepared.records[first..].iter().map(|row| row.0).collect();
        let queue = &self.gpu.queue;
        queue.write_buffer(&scene.anchored_buffer, 0, bytemuck::cast_slice(&anchored));
        let offset = (first * RECORD_COLUMNS * size_of::<f32>()) as u64;
        queue.write_buffer(&scene.rows_buffer, offset, bytemuck::cast_slice(&records));
    }

    /// Builds prepared scene and hierarchy, while the kernel is compiled, and copies them to the device.
    fn scene_on_device(&mut self, job: &RenderJob) -> Result<SceneOnDevice, RenderError> {
        let prepared = PreparedScene::<f32>::new(job);
        self.kernels.begin(&self.gpu, EntryPoint::PathTrace, &self.features(&prepared), 0);
        let begin = Instant::now();
        let data = SceneData::new(job, &prepared, self.options.hierarchy).map_err(failed)?;
        self.report.hierarchy_time = prepared.hierarchy_time + begin.elapsed();
        self.copied(prepared, data).map_err(failed)
    }

    fn features(&self, prepared: &PreparedScene<f32>) -> Features {
        let needed = prepared.features;
        let features = if self.options.specialise { needed } else { needed.generalised() };
        let cwbvh = features.hierarchy && self.options.hierarchy == HierarchyKind::Cwbvh;
        let features = Features { cwbvh, ..features };
        Features { aside: self.dispatches.whole_samples(&features, prepared).is_none(), ..features }
    }

    /// Refuses lists that are longer than a driver's loops.
    fn check_lists(&self, features: &Features, prepared: &PreparedScene<f32>) -> Result<(), String> {
        let turns = turns_over_lists(features, prepared);
        if self.gpu.adapter.threads_in_step() > 1 && turns >= u64::from(TURN_LIMIT) {
            return Err(format!(
                "each ray is tested against {turns} spheres, but loops of {} end after {TURN_LIMIT} turns; render this scene on the CPU",
                self.gpu.adapter.name
            ));
        }
        Ok(())
    }

    /// Has room for the paths that the threads of a picture may put aside.
    fn make_room(&mut self, job: &RenderJob) -> Result<(), String> {
        let (width, height) = (job.settings().width, job.settings().height);
        let [tile_width, tile_height] = tile_size(width, height);
        let tiles = u64::from(width.div_ceil(tile_width)) * u64::from(height.div_ceil(tile_height));
        let limit = self.binding_limit();
        self.dispatches.make_room(&self.gpu, tiles * u64::from(WORKGROUP_SIZE), limit)
    }

    /// Most bytes that a shader can see of one buffer.
    fn binding_limit(&self) -> u64 {
        self.gpu.adapter.storage_binding_limit.min(self.gpu.adapter.buffer_limit)
    }

    /// Most bytes of a film in one buffer.
    pub(super) fn film_limit(&self) -> u64 {
        let limit = self.binding_limit();
        self.options.film_limit.map_or(limit, |wanted| wanted.min(limit))
    }

    fn copied(&self, prepared: PreparedScene<f32>, scene: SceneData) -> Result<SceneOnDevice, String> {
        let gpu = &self.gpu;
        let limit = self.binding_limit();
        let storage = |label, data: &[u8]| {
            if data.len() as u64 > limit {
                return Err(format!(
                    "the {label} of {} spheres take {} bytes, but the adapter binds at most {limit}; render this scene on the CPU",
                    prepared.records.len(),
                    data.len(),
                ));
            }
            gpu.filled(label, data, wgpu::BufferUsages::STORAGE)
        };
        let anchored: Vec<[u32; 8]> = at_least_one(words_of(&prepared.anchored).as_chunks().0.to_vec());
        let job = GpuJob::new(&prepared, scene.node_count);
        let job_buffer =
            gpu.filled("job", bytemuck::cast_slice(&words_of(&[job])), wgpu::BufferUsages::UNIFORM)?;
        let buffers = [
            storage("spheres", bytemuck::cast_slice(&scene.spheres))?,
            // At least one element of each, as the shader's types ask for.
            storage("anchored spheres", bytemuck::cast_slice(&anchored))?,
            storage("records", bytemuck::cast_slice(&scene.records))?,
            storage("nodes", bytemuck::cast_slice(&at_least_one(scene.nodes)))?,
        ];
        let bound: Vec<&wgpu::Buffer> = std::iter::once(&job_buffer).chain(&buffers).collect();
        let group = gpu.bind(&gpu.layouts.job, &bound);
        let [_, anchored_buffer, rows_buffer, _] = buffers;
        Ok(SceneOnDevice {
            group,
            anchored_buffer,
            rows_buffer,
            scene_index: scene.scene_index,
            node_count: scene.node_count,
            job_buffer,
            prepared,
        })
    }

    /// Empty buffers for a film of `job`: those of the old job where they fit.
    fn film_buffers(&self, job: &RenderJob, old: Option<FilmBuffers>) -> Result<FilmBuffers, String> {
        let limit = self.film_limit();
        match old {
            Some(mut film) if film.fit(job.settings(), limit) => {
                // What is under way was abandoned.
                film.forget(&self.gpu);
                Ok(film)
            }
            other => {
                // Both need not fit into the device.
                drop(other);
                FilmBuffers::new(&self.gpu, job.settings(), limit)
            }
        }
    }
}

/// Turns of one ray's loops over lists. Twin: `turns_over_lists` in shaders/path.wgsl.
pub(super) fn turns_over_lists(features: &Features, prepared: &PreparedScene<f32>) -> u64 {
    let is_in_hierarchy = features.hierarchy && features.surface == Surface::Exact;
    let listed = if is_in_hierarchy { 0 } else { prepared.opaque.len() + prepared.two_root.len() };
    (prepared.anchored.len() + listed) as u64
}

fn at_least_one<T: bytemuck::Zeroable>(mut items: Vec<T>) -> Vec<T> {
    if items.is_empty() {
        items.push(T::zeroed());
    }
    items
}
