//! Reads results from the device.

use super::device::Gpu;
use super::layout::{GpuCounters, GpuDispatchCounters};
use std::mem::offset_of;
use std::sync::mpsc::{self, Receiver};
use std::time::Duration;

/// A buffer through which the host reads results, once the work that copies them there is done.
#[derive(Debug)]
pub struct Staging {
    pub buffer: wgpu::Buffer,
    /// Receives a message when the buffer is mapped.
    mapping: Option<Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

impl Staging {
    /// # Errors
    /// If the device runs out of memory.
    pub fn new(gpu: &Gpu, label: &str, size: u64) -> Result<Self, String> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        Ok(Staging { buffer: gpu.buffer(label, size, usage)?, mapping: None })
    }

    /// Call after the submission: maps the buffer once the work is done.
    pub fn request(&mut self) {
        let (sender, mapping) = mpsc::channel();
        self.buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // There is no receiver if the samples were discarded, or after an error that was reported.
            let _ = sender.send(result);
        });
        self.mapping = Some(mapping);
    }

    /// The results, once the work is done.
    pub fn view(&self) -> Result<wgpu::BufferView, String> {
        let mapping = self.mapping.as_ref().ok_or("nothing was submitted")?;
        let mapped = mapping.try_recv().map_err(|_| "the device did not return its results".to_owned())?;
        mapped.map_err(|error| format!("reading results: {error}"))?;
        self.buffer.get_mapped_range(..).map_err(|error| format!("reading results: {error}"))
    }

    /// Makes room for the next results.
    pub fn release(&mut self) {
        if self.mapping.take().is_some() {
            self.buffer.unmap();
        }
    }
}

/// Reads the results of a dispatch. Serves one dispatch in flight at a time.
#[derive(Debug)]
pub struct DispatchReadback {
    /// `None` if the device has no clock.
    clock: Option<Clock>,
    /// Two timestamps, then the dispatch's counters.
    staging: Staging,
}

/// A pair of timestamps around a dispatch.
#[derive(Debug)]
struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    period_ns: f32,
}

/// The time of a dispatch by the device's clock, and its counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct DispatchResult {
    /// Time on the device; `None` without a clock.
    pub took: Option<Duration>,
    /// The dispatch's counters.
    pub counters: GpuDispatchCounters,
}

impl DispatchResult {
    /// Samples whose sums are in the film.
    pub fn finished(&self) -> u64 {
        u64::from(self.counters.finished) | u64::from(self.counters.finished_high) << 32
    }
}

/// Size of two timestamps in bytes.
const TIMES_SIZE: u64 = 16;

/// Size of a dispatch's counters in bytes.
const COUNTERS_SIZE: u64 = size_of::<GpuDispatchCounters>() as u64;

/// Offset of a dispatch's counters in [`GpuCounters`].
const COUNTERS_OFFSET: u64 = offset_of!(GpuCounters, dispatch) as u64;

impl DispatchReadback {
    /// # Errors
    /// If the device runs out of memory.
    pub fn new(gpu: &Gpu) -> Result<DispatchReadback, String> {
        let staging = Staging::new(gpu, "readback", TIMES_SIZE + COUNTERS_SIZE)?;
        Ok(DispatchReadback { clock: Clock::new(gpu), staging })
    }

    /// Whether the device's own clock times dispatches.
    pub fn has_clock(&self) -> bool {
        self.clock.is_some()
    }

    /// Call before the pass: resets the dispatch's counters to 0.
    pub fn begin(&self, encoder: &mut wgpu::CommandEncoder, counters: &wgpu::Buffer) {
        encoder.clear_buffer(counters, COUNTERS_OFFSET, Some(COUNTERS_SIZE));
    }

    /// Timestamp writes for the pass to be timed.
    pub fn writes(&self) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.clock.as_ref().map(|clock| wgpu::ComputePassTimestampWrites {
            query_set: &clock.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        })
    }

    /// Call after the pass: copies timestamps and counters to the staging buffer.
    pub fn end(&self, encoder: &mut wgpu::CommandEncoder, counters: &wgpu::Buffer) {
        let staging = &self.staging.buffer;
        if let Some(clock) = &self.clock {
            encoder.resolve_query_set(&clock.queries, 0..2, &clock.resolved, 0);
            encoder.copy_buffer_to_buffer(&clock.resolved, 0, staging, 0, TIMES_SIZE);
        }
        encoder.copy_buffer_to_buffer(counters, COUNTERS_OFFSET, staging, TIMES_SIZE, COUNTERS_SIZE);
    }

    /// Call after the submission: maps the staging buffer.
    pub fn request(&mut self) {
        self.staging.request();
    }

    /// Reads the results of a completed dispatch.
    ///
    /// # Errors
    /// The device's error.
    pub fn read(&mut self) -> Result<DispatchResult, String> {
        let view = self.staging.view()?;
        let (times, counters) = view.split_at(TIMES_SIZE as usize);
        let mut ticks = times.chunks_exact(8).map(|time| time.try_into().map_or(0, u64::from_le_bytes));
        let (begin, end) = (ticks.next().unwrap_or(0), ticks.next().unwrap_or(0));
        let seconds = |clock: &Clock| end.saturating_sub(begin) as f64 * f64::from(clock.period_ns) * 1e-9;
        let took = self.clock.as_ref().map(|clock| Duration::from_secs_f64(seconds(clock)));
        let counters = bytemuck::pod_read_unaligned(counters);
        drop(view);
        self.staging.release();
        Ok(DispatchResult { took, counters })
    }
}

impl Clock {
    /// Returns `None` if the device has no timestamps.
    fn new(gpu: &Gpu) -> Option<Clock> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let queries = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("dispatch times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolve = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        Some(Clock {
            queries,
            resolved: gpu.buffer("dispatch times", TIMES_SIZE, resolve).ok()?,
            period_ns: gpu.queue.get_timestamp_period(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finished_samples_are_counted_in_two_words() {
        for (low, high, expected) in [(7, 0, 7), (7, 1, (1 << 32) + 7), (u32::MAX, 2, (3 << 32) - 1)] {
            let counters = GpuDispatchCounters { finished: low, finished_high: high, ..Default::default() };
            assert_eq!(DispatchResult { took: None, counters }.finished(), expected);
        }
    }
}
