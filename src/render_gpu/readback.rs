//! From the device to memory.

use super::device::Gpu;
use std::sync::mpsc;
use std::time::Duration;

/// The first `count` words of `from`, once all that was submitted is done.
///
/// # Errors
/// What the device said.
pub fn words(gpu: &Gpu, from: &wgpu::Buffer, count: usize) -> Result<Vec<u32>, String> {
    let size = count as u64 * 4;
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let staging = gpu.buffer("words, read", size, usage)?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(from, 0, &staging, 0, size);
    let submission = gpu.queue.submit([encoder.finish()]);
    let mut words = Vec::new();
    mapped(gpu, &staging, size, submission, |bytes| words = bytemuck::pod_collect_to_vec(bytes))?;
    Ok(words)
}

/// Waits for `submission`, then shows the first `length` bytes of a staging buffer.
fn mapped(
    gpu: &Gpu,
    staging: &wgpu::Buffer,
    length: u64,
    submission: wgpu::SubmissionIndex,
    take: impl FnOnce(&[u8]),
) -> Result<(), String> {
    let (sender, receiver) = mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, 0..length, move |result| {
        // The receiver is gone only after an error that is reported already.
        let _ = sender.send(result);
    });
    gpu.wait(submission)?;
    receiver
        .try_recv()
        .map_err(|_| "the device did not hand its results over".to_owned())?
        .map_err(|error| format!("reading results: {error}"))?;
    {
        let view = staging.get_mapped_range(0..length).map_err(|error| format!("reading: {error}"))?;
        take(&view);
    }
    staging.unmap();
    Ok(())
}

/// Two timestamps around a dispatch, of which there can be one under way for each slot.
#[derive(Debug)]
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    period_ns: f32,
}

/// Bytes of two timestamps.
const TIMES_SIZE: u64 = 16;

impl Timer {
    /// `None` where the device has no timestamps.
    pub fn new(gpu: &Gpu) -> Option<Timer> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("dispatch times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let read = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        Some(Timer {
            queries,
            resolved: gpu.buffer("dispatch times", TIMES_SIZE, resolve).ok()?,
            staging: gpu.buffer("dispatch times, read", TIMES_SIZE, read).ok()?,
            period_ns: gpu.queue.get_timestamp_period(),
        })
    }

    /// For the pass that is to be timed.
    pub fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }

    /// After the pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, TIMES_SIZE);
    }

    /// Waits for the pass and returns what it took.
    ///
    /// # Errors
    /// What the device said.
    pub fn wait(&self, gpu: &Gpu, submission: wgpu::SubmissionIndex) -> Result<Duration, String> {
        let mut times = [0_u64; 2];
        mapped(gpu, &self.staging, TIMES_SIZE, submission, |bytes| {
            for (time, eight) in times.iter_mut().zip(bytes.chunks_exact(8)) {
                *time = eight.try_into().map_or(0, u64::from_le_bytes);
            }
        })?;
        let ticks = times[1].saturating_sub(times[0]);
        Ok(Duration::from_secs_f64(ticks as f64 * f64::from(self.period_ns) * 1e-9))
    }
}
