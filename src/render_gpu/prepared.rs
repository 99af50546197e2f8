//! A job on the device: tables and hierarchy in buffers, the kernel, the film.

use super::film_buffers::FilmBuffers;
use super::kernel::Kernel;
use super::layout::{GpuAnchoredSphere, GpuJob};
use super::scene::SceneData;
use super::shader_source::EntryPoint;
use super::{GpuRenderer, HierarchyKind, Overrides, failed};
use crate::render::{RenderError, RenderJob};
use crate::tables::Tables;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A job on the device.
pub(super) struct Prepared {
    pub(super) job: RenderJob,
    /// Most samples whose sum fits 32 bits.
    pub(super) block_limit: u32,
    /// By number, the sphere's index in the scene.
    pub(super) scene_index: Vec<u32>,
    pub(super) overrides: Overrides,
    pub(super) kernel: Kernel,
    /// Group 0.
    pub(super) job_group: wgpu::BindGroup,
    pub(super) film: FilmBuffers,
}

impl GpuRenderer {
    /// Builds what `job` needs, unless that is there.
    pub(super) fn get_ready(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        if self.prepared.as_ref().is_none_or(|prepared| prepared.job != *job) {
            let old = self.prepared.take();
            self.prepared = Some(self.built(job, old, cancel)?);
        }
        Ok(())
    }

    fn built(
        &mut self,
        job: &RenderJob,
        old: Option<Prepared>,
        cancel: &AtomicBool,
    ) -> Result<Prepared, RenderError> {
        self.gpu.faults.check().map_err(failed)?;
        let tables = Tables::<f32>::new(job);
        let overrides = self.overrides(job, &tables);
        self.kernels.begin(&self.gpu, EntryPoint::PathTrace, &overrides, 0);
        let begin = Instant::now();
        let scene = SceneData::new(job, &tables, self.options.hierarchy).map_err(failed)?;
        self.report.hierarchy_time = tables.hierarchy_time + begin.elapsed();
        let scene_index = scene.scene_index.clone();
        let job_group = self.job_group(&tables, scene).map_err(failed)?;
        let film = self.film_buffers(job, old).map_err(failed)?;
        let kernel = self.kernels.get(&self.gpu, EntryPoint::PathTrace, &overrides, 0, cancel)?;
        self.gpu.faults.check().map_err(failed)?;
        self.report.features = overrides.summary();
        self.report.compile_time = kernel.compile_time;
        Ok(Prepared {
            job: job.clone(),
            block_limit: tables.block_limit,
            scene_index,
            overrides,
            kernel,
            job_group,
            film,
        })
    }

    fn overrides(&self, job: &RenderJob, tables: &Tables<f32>) -> Overrides {
        let overrides = if self.options.specialise {
            Overrides::specialised(job, tables)
        } else {
            Overrides::general(job, tables)
        };
        let cwbvh = overrides.hierarchy && self.options.hierarchy == HierarchyKind::Cwbvh;
        Overrides { cwbvh, ..overrides }
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

    fn job_group(&self, tables: &Tables<f32>, scene: SceneData) -> Result<wgpu::BindGroup, String> {
        let gpu = &self.gpu;
        let limit = self.binding_limit();
        let storage = |label, data: &[u8]| {
            if data.len() as u64 > limit {
                return Err(format!(
                    "the {label} of {} spheres take {} bytes, but the adapter binds at most {limit}; render this scene on the CPU",
                    tables.rows.len(),
                    data.len(),
                ));
            }
            gpu.filled(label, data, wgpu::BufferUsages::STORAGE)
        };
        let anchored: Vec<GpuAnchoredSphere> = tables.anchored.iter().map(Into::into).collect();
        let job = GpuJob::new(tables, scene.node_count);
        let buffers = [
            gpu.filled("job", bytemuck::bytes_of(&job), wgpu::BufferUsages::UNIFORM)?,
            storage("spheres", bytemuck::cast_slice(&scene.spheres))?,
            // At least one element of each, as the shader's types ask for.
            storage("anchored spheres", bytemuck::cast_slice(&at_least_one(anchored)))?,
            storage("rows", bytemuck::cast_slice(&scene.rows))?,
            storage("nodes", bytemuck::cast_slice(&at_least_one(scene.nodes)))?,
        ];
        Ok(gpu.bind(&gpu.layouts.job, &buffers.each_ref()))
    }

    /// Empty buffers for a film of `job`: those of the old job where they fit.
    fn film_buffers(&self, job: &RenderJob, old: Option<Prepared>) -> Result<FilmBuffers, String> {
        let limit = self.film_limit();
        match old.map(|prepared| prepared.film) {
            Some(mut film) if film.fit(job.settings(), limit) => {
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

fn at_least_one<T: bytemuck::Zeroable>(mut items: Vec<T>) -> Vec<T> {
    if items.is_empty() {
        items.push(T::zeroed());
    }
    items
}
