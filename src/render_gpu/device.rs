//! The device, and how it can fail.

use super::GpuError;
use super::adapter::{AdapterInfo, STORAGE_BUFFERS, all_adapters};
use super::options::COMPILING_PATIENCE;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The first failure of a device; later failures are its consequences.
#[derive(Debug, Default)]
pub struct Faults {
    first: Mutex<Option<String>>,
}

impl Faults {
    fn note(&self, what: String) {
        log::warn!("the device failed: {what}");
        self.first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(what);
    }

    /// Returns `Err` with the first failure, if there was one.
    pub fn check(&self) -> Result<(), String> {
        match &*self.first.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(what) => Err(what.clone()),
            None => Ok(()),
        }
    }
}

/// The layouts of the shaders' bind groups.
#[derive(Clone, Debug)]
pub struct Layouts {
    /// Group 0: the job.
    pub job: wgpu::BindGroupLayout,
    /// Group 1: the dispatch.
    pub dispatch: wgpu::BindGroupLayout,
    /// Group 2: scratch words.
    pub scratch: wgpu::BindGroupLayout,
    /// The pipeline layout of all three groups.
    pub pipeline: wgpu::PipelineLayout,
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Self {
        let group = |label, types: &[wgpu::BufferBindingType]| {
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
            let entries = entries.as_slice();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let uniform = wgpu::BufferBindingType::Uniform;
        let read = wgpu::BufferBindingType::Storage { read_only: true };
        let write = wgpu::BufferBindingType::Storage { read_only: false };
        let job = group("job", &[uniform, read, read, read, read]);
        let dispatch = group("dispatch", &[uniform, read, write, write]);
        let scratch = group("scratch", &[write]);
        let pipeline = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("weekender"),
            bind_group_layouts: &[Some(&job), Some(&dispatch), Some(&scratch)],
            immediate_size: 0,
        });
        Layouts { job, dispatch, scratch, pipeline }
    }
}

/// An open device; clones share it.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub adapter: AdapterInfo,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub layouts: Layouts,
    pub faults: Arc<Faults>,
    /// How long to wait for the device before giving it up.
    patience: Duration,
    silence: Arc<Mutex<Silence>>,
}

/// Tracks how long a device has not responded.
#[derive(Debug, Default)]
struct Silence {
    /// Time spent waiting since its last response.
    waited: Duration,
    /// Whether the driver may be compiling.
    compiles: bool,
}

impl Silence {
    /// Counts a wait in which the device has not responded, and returns whether `patience` is over.
    fn lasts(&mut self, wait: Duration, patience: Duration) -> bool {
        self.waited += wait;
        self.waited >= patience * if self.compiles { COMPILING_PATIENCE } else { 1 }
    }
}

/// How often a wait for the device checks whether the result is still wanted.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

impl Gpu {
    /// Opens the first adapter whose name, backend or driver contains `wanted` (ignoring case), or the best adapter if
    /// `wanted` is `None`. Software adapters are opened only if `allow_software` is set.
    ///
    /// # Errors
    /// [`GpuError`], with the available adapters.
    pub fn open(wanted: Option<&str>, allow_software: bool, patience: Duration) -> Result<Self, GpuError> {
        let matches = |info: &AdapterInfo| {
            let text = info.to_string().to_lowercase();
            wanted.is_none_or(|wanted| text.contains(&wanted.to_lowercase()))
        };
        let candidates = all_adapters(matches);
        let listed = || candidates.iter().map(|(info, _)| info.to_string()).collect::<Vec<_>>();
        if candidates.is_empty() {
            return Err(GpuError::None);
        }
        let Some((info, adapter)) = candidates.iter().find(|(info, _)| matches(info)) else {
            let wanted = wanted.unwrap_or_default().to_owned();
            return Err(GpuError::NoMatch { wanted, available: listed() });
        };
        if let Some(lacks) = &info.lacks {
            return Err(GpuError::Lacks { adapter: info.to_string(), lacks: lacks.clone() });
        }
        if info.is_software && !allow_software {
            return Err(GpuError::Software { available: listed() });
        }
        let limits = adapter.limits();
        let opened = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("weekender"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: wgpu::Limits {
                max_storage_buffers_per_shader_stage: STORAGE_BUFFERS,
                max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
                max_buffer_size: limits.max_buffer_size,
                ..wgpu::Limits::downlevel_defaults()
            },
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        }));
        let (device, queue) = opened
            .map_err(|error| GpuError::Device { adapter: info.to_string(), reason: error.to_string() })?;
        let faults = Arc::new(Faults::default());
        let noted = Arc::clone(&faults);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| noted.note(error.to_string())));
        let noted = Arc::clone(&faults);
        device.set_device_lost_callback(move |reason, message| {
            let message = message.trim();
            let colon = if message.is_empty() { "" } else { ": " };
            noted.note(format!("the device was lost ({reason:?}){colon}{message}"));
        });
        let layouts = Layouts::new(&device);
        let silence = Arc::default();
        let gpu = Gpu { adapter: info.clone(), device, queue, layouts, faults, patience, silence };
        log::info!("opened {}", gpu.adapter);
        gpu.faults.check().map_err(|reason| GpuError::Device { adapter: gpu.adapter.to_string(), reason })?;
        Ok(gpu)
    }

    /// Runs `create` and returns its result, or the device's error.
    pub fn guarded<T>(&self, create: impl FnOnce() -> T) -> Result<T, String> {
        let filters =
            [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let made = create();
        let errors = scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop()));
        match errors.collect::<Vec<_>>().first() {
            Some(error) => Err(error.to_string()),
            None => self.faults.check().map(|()| made),
        }
    }

    /// Creates a buffer filled with zeros.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, String> {
        let size = size.max(16).next_multiple_of(16);
        self.guarded(|| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage,
                mapped_at_creation: false,
            })
        })
        .map_err(|reason| format!("cannot create a buffer of {size} bytes for {label}: {reason}"))
    }

    /// Creates a bind group that binds whole buffers to the bindings `0 ..`.
    pub fn bind(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn silence(&self) -> MutexGuard<'_, Silence> {
        self.silence.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Allows the next response more time, because a kernel runs for the first time.
    pub fn expect_compiling(&self) {
        self.silence().compiles = true;
    }

    /// Waits until a submission is done and returns true, or returns false once `cancel` is set.
    ///
    /// # Errors
    /// The device's failure, also if it has not responded for too long.
    pub fn wait_unless(
        &self,
        submission: &wgpu::SubmissionIndex,
        cancel: Option<&AtomicBool>,
    ) -> Result<bool, String> {
        loop {
            let begin = Instant::now();
            let submission_index = Some(submission.clone());
            let polled =
                self.device.poll(wgpu::PollType::Wait { submission_index, timeout: Some(POLL_INTERVAL) });
            self.faults.check()?;
            let mut silence = self.silence();
            let is_over = match polled {
                Ok(_) => {
                    *silence = Silence::default();
                    return Ok(true);
                }
                Err(wgpu::PollError::Timeout) => silence.lasts(begin.elapsed(), self.patience),
                Err(error) => return Err(format!("the device was lost: {error}")),
            };
            if is_over {
                self.faults.note(format!(
                    "{} has not responded for {:.0} s and is given up; render on the CPU, or start again once it responds",
                    self.adapter.name,
                    silence.waited.as_secs_f64()
                ));
            } else if cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Ok(false);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tested apart from a device, as a software adapter may do its work while it is submitted.
    #[test]
    fn a_device_is_given_up_when_patience_is_over() {
        let (wait, patience) = (Duration::from_secs(1), Duration::from_secs(3));
        let mut silence = Silence::default();
        assert_eq!([(); 4].map(|()| silence.lasts(wait, patience)), [false, false, true, true]);
        let mut silence = Silence { compiles: true, ..Silence::default() };
        let waits = (1..).find(|_| silence.lasts(wait, patience));
        assert_eq!(waits, Some(3 * COMPILING_PATIENCE));
    }
}
