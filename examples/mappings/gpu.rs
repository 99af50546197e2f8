//! The GPU: one thread per pixel, or one per sample.

use super::{Comparison, Mapping, Options, SIZE, Traced, compare, job, timed};
use anyhow::Context;
use std::rc::Rc;
use weekender::film::{HALVES, PixelSum};
use weekender::job::render::RenderJob;
use weekender::kernel::sampling::SampleBlock;
use weekender::kernel::{Features, GpuBlock, GpuCounters, GpuDispatch, GpuSuspendedPath, WORKGROUP_SIZE};
use weekender::render_gpu::layout::tile_size;
use weekender::render_gpu::shader_source::shared;
use weekender::render_gpu::{Exported, ITERATION_LIMIT, SHARED_BLOCK};
use wgpu::{BufferUsages, PollType};

const ENTRIES: &str = include_str!("mappings.wgsl");

/// Who traces what.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Pixels,
    SharedBlocks,
    SamplesOfATile,
    SamplesOfAPixel,
}

impl Way {
    const ALL: [Way; 4] = [Way::Pixels, Way::SharedBlocks, Way::SamplesOfATile, Way::SamplesOfAPixel];

    fn entry_point(self) -> &'static str {
        match self {
            Way::Pixels | Way::SharedBlocks => "pixels",
            Way::SamplesOfATile => "samples_of_a_tile",
            Way::SamplesOfAPixel => "samples_of_a_pixel",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Way::Pixels => "a thread per pixel",
            Way::SharedBlocks => "a group of threads per tile, which share its samples in blocks",
            Way::SamplesOfATile => "a thread per sample, neighbouring pixels in a group",
            Way::SamplesOfAPixel => "a thread per sample, a pixel's samples in a group",
        }
    }

    /// The program's shaders. With one thread per sample, a thread has a single block instead of all blocks of its
    /// pixel.
    fn source(self) -> anyhow::Result<String> {
        let mut text = shared();
        if matches!(self, Way::SamplesOfATile | Way::SamplesOfAPixel) {
            let next = "select(item + pixels, thread, item == NONE)";
            anyhow::ensure!(text.matches(next).count() == 1, "{next:?} is not in the shaders once");
            text = text.replace(next, "select(NONE, own_item, item == NONE)");
        }
        Ok(text + ENTRIES)
    }

    /// Maximum number of samples in a block.
    fn block_limit(self) -> u32 {
        match self {
            Way::Pixels => u32::MAX,
            Way::SharedBlocks => SHARED_BLOCK,
            Way::SamplesOfATile | Way::SamplesOfAPixel => 1,
        }
    }
}

/// The device and what all ways share.
struct Shared {
    device: wgpu::Device,
    queue: wgpu::Queue,
    film: wgpu::Buffer,
    counters: wgpu::Buffer,
    staging: wgpu::Buffer,
    pixels: u64,
}

struct GpuWay {
    way: Way,
    shared: Rc<Shared>,
    pipeline: wgpu::ComputePipeline,
    groups: Vec<wgpu::BindGroup>,
    workgroups: [u32; 3],
}

pub fn measure(options: &Options) -> anyhow::Result<Comparison> {
    let job = job()?;
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let wanted = options.adapter.clone().unwrap_or_default().to_lowercase();
    let adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    let adapter = adapters
        .into_iter()
        .find(|adapter| adapter.get_info().name.to_lowercase().contains(&wanted))
        .context("there is no such adapter")?;
    let limits =
        wgpu::Limits { max_storage_buffers_per_shader_stage: 8, ..wgpu::Limits::downlevel_defaults() };
    let described = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&described))?;
    let pixels = u64::from(SIZE[0]) * u64::from(SIZE[1]);
    let length = HALVES * pixels * size_of::<PixelSum>() as u64;
    let buffer = |size: u64, usage| {
        device.create_buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    };
    let both = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    let shared = Rc::new(Shared {
        film: buffer(length, both),
        counters: buffer(size_of::<GpuCounters>() as u64, both),
        staging: buffer(length + 256, BufferUsages::MAP_READ | BufferUsages::COPY_DST),
        pixels,
        device,
        queue,
    });
    let mut ways: Vec<Box<dyn Mapping>> = Vec::new();
    for way in Way::ALL {
        ways.push(Box::new(GpuWay::new(way, &shared, &job, options.samples)?));
    }
    let info = adapter.get_info();
    let machine = match info.device_type {
        wgpu::DeviceType::Cpu => format!("{}, a software GPU on {}", info.name, super::processor()),
        _ => info.name,
    };
    compare(options, machine, &mut ways)
}

impl GpuWay {
    fn new(way: Way, shared: &Rc<Shared>, job: &RenderJob, samples: u64) -> anyhow::Result<Self> {
        let (device, queue) = (&shared.device, &shared.queue);
        let exported = Exported::new(job);
        let features = Features { suspends: way == Way::SharedBlocks, ..exported.features };
        let source = wgpu::ShaderSource::Wgsl(way.source()?.into());
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let overrides = features.overrides();
        let constants: Vec<(&str, f64)> =
            overrides.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let filled = |bytes: &[u8], usage: BufferUsages| {
            let size = (bytes.len() as u64).next_multiple_of(16).max(256);
            let usage = usage | BufferUsages::COPY_DST;
            let described = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            let buffer = device.create_buffer(&described);
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let limit = way.block_limit().min(exported.block_limit);
        let ranges: Vec<_> = match way {
            Way::Pixels | Way::SharedBlocks => std::iter::once(0..samples).collect(),
            _ => (0..samples).map(|sample| sample..sample + 1).collect(),
        };
        let blocks: Vec<GpuBlock> = ranges
            .into_iter()
            .flat_map(|range| SampleBlock::split(range, limit))
            .map(|block| {
                let (counter, step) = block.counter(job.settings());
                GpuBlock { half: block.half, counter, step, count: block.count }
            })
            .collect();
        let [width, height] = SIZE;
        let tile = tile_size(width, height);
        let tiles = width.div_ceil(tile[0]) * height.div_ceil(tile[1]);
        let order = GpuDispatch {
            tile_count: tiles,
            block_count: blocks.len() as u32,
            iteration_limit: ITERATION_LIMIT,
            row_count: height,
            ..GpuDispatch::default()
        };
        let job_buffers: Vec<wgpu::Buffer> = exported
            .buffers
            .iter()
            .enumerate()
            .map(|(place, bytes)| {
                filled(bytes, if place == 0 { BufferUsages::UNIFORM } else { BufferUsages::STORAGE })
            })
            .collect();
        let order = filled(bytemuck::bytes_of(&order), BufferUsages::UNIFORM);
        let blocks = filled(bytemuck::cast_slice(&blocks), BufferUsages::STORAGE);
        let words = filled(&[0; size_of::<GpuSuspendedPath>()], BufferUsages::STORAGE);
        let bound: [Vec<&wgpu::Buffer>; 3] = [
            job_buffers.iter().collect(),
            vec![&order, &blocks, &shared.film, &shared.counters],
            vec![&words],
        ];
        let uniform = wgpu::BufferBindingType::Uniform;
        let [read, write] = [true, false].map(|read_only| wgpu::BufferBindingType::Storage { read_only });
        let types: [&[wgpu::BufferBindingType]; 3] =
            [&[uniform, read, read, read, read], &[uniform, read, write, write], &[write]];
        let layouts: Vec<wgpu::BindGroupLayout> = types
            .iter()
            .map(|types| {
                let entries: Vec<_> = types
                    .iter()
                    .zip(0..)
                    .map(|(ty, binding)| wgpu::BindGroupLayoutEntry {
                        binding,
                        visibility: wgpu::ShaderStages::COMPUTE,
                        ty: wgpu::BindingType::Buffer {
                            ty: *ty,
                            has_dynamic_offset: false,
                            min_binding_size: None,
                        },
                        count: None,
                    })
                    .collect();
                device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: None,
                    entries: &entries,
                })
            })
            .collect();
        let groups = layouts.iter().zip(&bound).map(|(layout, buffers)| {
            let entries: Vec<_> = buffers
                .iter()
                .zip(0..)
                .map(|(buffer, binding)| wgpu::BindGroupEntry {
                    binding,
                    resource: buffer.as_entire_binding(),
                })
                .collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
        });
        let groups: Vec<wgpu::BindGroup> = groups.collect();
        let layouts: Vec<Option<&wgpu::BindGroupLayout>> = layouts.iter().map(Some).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &layouts,
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: Some(&layout),
            module: &module,
            entry_point: Some(way.entry_point()),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            cache: None,
        });
        let samples = samples as u32;
        let pixels = width * height;
        let workgroups = match way {
            Way::Pixels | Way::SharedBlocks => [tiles, 1, 1],
            Way::SamplesOfATile => [tiles, samples, 1],
            Way::SamplesOfAPixel => {
                anyhow::ensure!(
                    samples.is_multiple_of(WORKGROUP_SIZE),
                    "samples must be a multiple of {WORKGROUP_SIZE}"
                );
                [pixels.min(65_535), samples / WORKGROUP_SIZE, pixels.div_ceil(65_535)]
            }
        };
        Ok(GpuWay { way, shared: Rc::clone(shared), pipeline, groups, workgroups })
    }

    fn dispatch(&self) -> anyhow::Result<()> {
        let Shared { device, queue, .. } = &*self.shared;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(&self.pipeline);
            for (place, group) in (0..).zip(&self.groups) {
                pass.set_bind_group(place, group, &[]);
            }
            let [x, y, z] = self.workgroups;
            pass.dispatch_workgroups(x, y, z);
        }
        queue.submit([encoder.finish()]);
        device.poll(PollType::wait_indefinitely())?;
        Ok(())
    }
}

impl Mapping for GpuWay {
    fn name(&self) -> String {
        self.way.name().to_owned()
    }

    fn trace(&mut self) -> anyhow::Result<Traced> {
        let Shared { device, queue, film, counters, staging, pixels } = &*self.shared;
        let clear = |encoder: &mut wgpu::CommandEncoder| {
            encoder.clear_buffer(film, 0, None);
            encoder.clear_buffer(counters, 0, None);
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        clear(&mut encoder);
        queue.submit([encoder.finish()]);
        device.poll(PollType::wait_indefinitely())?;
        let (outcome, seconds) = timed(|| self.dispatch());
        outcome?;
        let length = HALVES * pixels * size_of::<PixelSum>() as u64;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(film, 0, staging, 0, length);
        let counted = size_of::<GpuCounters>() as u64;
        encoder.copy_buffer_to_buffer(counters, 0, staging, length, counted);
        queue.submit([encoder.finish()]);
        staging.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        device.poll(PollType::wait_indefinitely())?;
        let bytes = staging.slice(..length + counted).get_mapped_range()?.to_vec();
        staging.unmap();
        let (sums, counters) = bytes.split_at(length as usize);
        let counters: GpuCounters = bytemuck::pod_read_unaligned(counters);
        anyhow::ensure!(
            counters.dispatch.unfinished == 0,
            "some paths were not finished, because a thread's loop has at most {ITERATION_LIMIT} iterations; ask for fewer samples"
        );
        let sum = |pixel: &[u8]| PixelSum(bytemuck::pod_read_unaligned(pixel));
        let mut film: Vec<PixelSum> = sums.chunks_exact(24).map(sum).collect();
        let second = film.split_off(*pixels as usize);
        film.iter_mut().zip(second).for_each(|(sum, more)| sum.add(more));
        Ok(Traced { seconds, film, in_use: None })
    }
}
