//! Runs an entry point that rendering does not need, on a device of its own.

use super::{skip_without_adapter, take_turn};
use weekender::job::render::RenderJob;
use weekender::kernel::{GpuBlock, GpuCounters, GpuDispatch};
use weekender::render_gpu::{Exported, shader_source};
use wgpu::BufferUsages as Usages;

/// A device on any adapter, even a software one, or on the one that `WEEKENDER_TEST_ADAPTER` names.
pub struct Programs {
    device: wgpu::Device,
    queue: wgpu::Queue,
}

/// The text of a program after the shared text, its entry point and overrides.
pub struct Program<'a> {
    pub text: &'a str,
    pub entry_point: &'a str,
    pub overrides: Vec<(String, f64)>,
}

impl Programs {
    /// `None` without an adapter.
    pub fn open() -> Option<Self> {
        take_turn();
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let wanted = std::env::var("WEEKENDER_TEST_ADAPTER").unwrap_or_default().to_lowercase();
        let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let found = adapters.into_iter().find(|found| found.get_info().name.to_lowercase().contains(&wanted));
        let Some(adapter) = found else {
            skip_without_adapter();
            return None;
        };
        let limits =
            wgpu::Limits { max_storage_buffers_per_shader_stage: 8, ..wgpu::Limits::downlevel_defaults() };
        let described = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&described)).unwrap();
        Some(Programs { device, queue })
    }

    /// Runs a program with the buffers of `job`. Returns the scratch words that it has changed.
    pub fn run(
        &self,
        job: &RenderJob,
        program: &Program,
        dispatch: GpuDispatch,
        sums: &[u64],
        scratch: &[u32],
        workgroups: u32,
    ) -> Vec<u32> {
        let Programs { device, queue } = self;
        let source = shader_source::shared() + program.text;
        let source = wgpu::ShaderSource::Wgsl(source.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let uniform = wgpu::BufferBindingType::Uniform;
        let [read, write] = [true, false].map(|read_only| wgpu::BufferBindingType::Storage { read_only });
        let job_buffers = Exported::new(job).buffers;
        let job_types = [uniform, read, read, read, read];
        let groups: [Vec<(wgpu::BufferBindingType, &[u8])>; 3] = [
            job_types.into_iter().zip(job_buffers.iter().map(Vec::as_slice)).collect(),
            vec![
                (uniform, bytemuck::bytes_of(&dispatch)),
                (read, &[0; size_of::<GpuBlock>()]),
                (write, bytemuck::cast_slice(sums)),
                (write, &[0; size_of::<GpuCounters>()]),
            ],
            vec![(write, bytemuck::cast_slice(scratch))],
        ];
        let filled = |ty: wgpu::BufferBindingType, bytes: &[u8]| {
            let own = if ty == uniform { Usages::UNIFORM } else { Usages::STORAGE | Usages::COPY_SRC };
            let size = (bytes.len() as u64).next_multiple_of(16).max(256);
            let usage = own | Usages::COPY_DST;
            let described = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            let buffer = device.create_buffer(&described);
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let bound = groups.map(|group| {
            let entry = |(binding, (ty, _)): (u32, &(wgpu::BufferBindingType, &[u8]))| {
                let ty =
                    wgpu::BindingType::Buffer { ty: *ty, has_dynamic_offset: false, min_binding_size: None };
                let visibility = wgpu::ShaderStages::COMPUTE;
                wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }
            };
            let entries: Vec<_> = (0..).zip(&group).map(entry).collect();
            let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: None,
                entries: &entries,
            });
            let buffers: Vec<wgpu::Buffer> = group.iter().map(|(ty, bytes)| filled(*ty, bytes)).collect();
            let entries: Vec<_> = (0..)
                .zip(&buffers)
                .map(|(binding, buffer)| {
                    let resource = buffer.as_entire_binding();
                    wgpu::BindGroupEntry { binding, resource }
                })
                .collect();
            let described = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
            (device.create_bind_group(&described), layout, buffers)
        });
        let layouts: Vec<_> = bound.iter().map(|(_, layout, _)| Some(layout)).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let constants: Vec<(&str, f64)> =
            program.overrides.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let compilation_options =
            wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some(program.entry_point),
            compilation_options,
            cache: None,
        });
        let changed = &bound[2].2[0];
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: changed.size(),
            usage: Usages::MAP_READ | Usages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            (0..).zip(&bound).for_each(|(place, (group, ..))| pass.set_bind_group(place, group, &[]));
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
        encoder.copy_buffer_to_buffer(changed, 0, &staging, 0, changed.size());
        queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let view = staging.slice(..4 * scratch.len() as u64).get_mapped_range().unwrap();
        bytemuck::pod_collect_to_vec(&view)
    }
}
