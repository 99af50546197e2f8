//! Adapters, the device, and how they can fail.

use super::options::COMPILING_PATIENCE;
use super::{Fault, GpuError};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Number of storage buffers that the path tracer binds.
const STORAGE_BUFFERS: u32 = 8;

/// Number of threads that keep a software adapter busy. 1024 threads and 4096 were equally fast; a dispatch of the
/// whole picture was a seventh slower.
const BUSY_THREADS_OF_SOFTWARE: u64 = 4096;

/// A description of an adapter, for lists and reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    /// The adapter's name, as the driver reports it.
    pub name: String,
    /// "discrete GPU", "integrated GPU", "virtual GPU", "software" or "other".
    pub kind: &'static str,
    /// "Vulkan", "Metal", "DX12" or "GL".
    pub backend: String,
    /// The driver's name and version.
    pub driver: String,
    /// Whether the adapter is a software implementation that runs on the CPU.
    pub is_software: bool,
    /// Size limit of a storage buffer binding, in bytes.
    pub storage_binding_limit: u64,
    /// Size limit of a buffer, in bytes.
    pub buffer_limit: u64,
    /// Whether the adapter supports timestamp queries, which time a dispatch.
    pub has_timestamps: bool,
    /// Largest number of threads that run in step.
    pub subgroup_size: u32,
    /// The reason why the path tracer cannot run on this adapter, if it cannot.
    pub lacks: Option<String>,
}

impl AdapterInfo {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let compute = wgpu::DownlevelFlags::COMPUTE_SHADERS;
        let lacks = if !adapter.get_downlevel_capabilities().flags.contains(compute) {
            Some("no compute shaders".to_owned())
        } else if limits.max_storage_buffers_per_shader_stage < STORAGE_BUFFERS {
            let count = limits.max_storage_buffers_per_shader_stage;
            Some(format!("{count} storage buffers a shader where {STORAGE_BUFFERS} are needed"))
        } else {
            None
        };
        AdapterInfo {
            name: info.name.trim().to_owned(),
            kind: match info.device_type {
                wgpu::DeviceType::DiscreteGpu => "discrete GPU",
                wgpu::DeviceType::IntegratedGpu => "integrated GPU",
                wgpu::DeviceType::VirtualGpu => "virtual GPU",
                wgpu::DeviceType::Cpu => "software",
                wgpu::DeviceType::Other => "other",
            },
            backend: match info.backend {
                wgpu::Backend::Vulkan => "Vulkan".to_owned(),
                wgpu::Backend::Metal => "Metal".to_owned(),
                wgpu::Backend::Dx12 => "DX12".to_owned(),
                wgpu::Backend::Gl => "GL".to_owned(),
                other => format!("{other:?}"),
            },
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            // GL reports the type "other" for every device, software included.
            is_software: info.device_type == wgpu::DeviceType::Cpu || names_software(&info.name),
            storage_binding_limit: limits.max_storage_buffer_binding_size,
            buffer_limit: limits.max_buffer_size,
            has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            subgroup_size: info.subgroup_max_size,
            lacks,
        }
    }

    /// Number of threads that share a limit on loop turns: software counts the turns of all threads that run in step.
    /// GPUs have no known limit.
    pub fn threads_in_step(&self) -> u32 {
        // Some adapters do not report a subgroup size; 8 threads fit a processor's registers.
        if self.is_software { self.subgroup_size.clamp(8, 64) } else { 1 }
    }

    /// Number of threads that keep the adapter busy. A dispatch uses this many if it can, and then as many samples as
    /// fit its time. More threads with fewer samples each are slower, because threads that run in step wait for the
    /// longest.
    pub fn busy_threads(&self) -> u64 {
        if self.is_software { BUSY_THREADS_OF_SOFTWARE } else { u64::MAX }
    }

    /// Whether the adapter may be chosen by default: a GPU that the path tracer can run on.
    pub fn is_fit(&self) -> bool {
        !self.is_software && self.lacks.is_none()
    }

    /// The sort key for adapters: the smallest comes first.
    fn rank(&self) -> (bool, bool, u8, u8) {
        let kind = match self.kind {
            "discrete GPU" => 0,
            "integrated GPU" => 1,
            "virtual GPU" => 2,
            _ => 3,
        };
        (self.lacks.is_some(), self.is_software, kind, u8::from(self.backend == "GL"))
    }
}

/// Formats the adapter like `NVIDIA H200 (discrete GPU, Vulkan, driver 580.1)`.
impl fmt::Display for AdapterInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_software { "software" } else { self.kind };
        write!(f, "{} ({kind}, {}, {})", self.name, self.backend, self.driver)
    }
}

fn names_software(name: &str) -> bool {
    let name = name.to_lowercase();
    ["llvmpipe", "softpipe", "swiftshader", "swrast", "basic render"].iter().any(|s| name.contains(s))
}

/// All adapters, best first. GL is enumerated only if no other backend has a usable adapter that is `wanted`: it would
/// list the same hardware again, and its libraries print warnings of their own.
fn all_adapters(wanted: impl Fn(&AdapterInfo) -> bool) -> Vec<(AdapterInfo, wgpu::Adapter)> {
    let mut adapters = adapters_of(wgpu::Backends::PRIMARY);
    if !adapters.iter().any(|(info, _)| info.lacks.is_none() && wanted(info)) {
        adapters.extend(adapters_of(wgpu::Backends::GL));
    }
    adapters.sort_by_key(|(info, _)| info.rank());
    adapters
}

fn adapters_of(backends: wgpu::Backends) -> Vec<(AdapterInfo, wgpu::Adapter)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        // Without this, debug builds would load the driver's validation layers, which slow everything down.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let found = pollster::block_on(instance.enumerate_adapters(backends));
    found.into_iter().map(|adapter| (AdapterInfo::of(&adapter), adapter)).collect()
}

/// All adapters of this machine, the default one first. Software adapters come after hardware.
pub fn adapters() -> Vec<AdapterInfo> {
    all_adapters(|_| true).into_iter().map(|(info, _)| info).collect()
}

/// The first failure of a device; later failures are its consequences.
#[derive(Debug, Default)]
pub struct Faults {
    first: Mutex<Option<String>>,
}

impl Faults {
    fn note(&self, what: String) {
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
    /// Group 2: input and output words.
    pub words: wgpu::BindGroupLayout,
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
        let words = group("words", &[write]);
        let pipeline = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("weekender"),
            bind_group_layouts: &[Some(&job), Some(&dispatch), Some(&words)],
            immediate_size: 0,
        });
        Layouts { job, dispatch, words, pipeline }
    }
}

/// An open device; clones share it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter that the device belongs to.
    pub adapter: AdapterInfo,
    /// The wgpu device.
    pub device: wgpu::Device,
    /// The device's queue.
    pub queue: wgpu::Queue,
    /// The bind group layouts.
    pub layouts: Layouts,
    /// The device's failures.
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
    /// End of an injected fault during which the device does not respond.
    simulated_until: Option<Instant>,
}

/// How often a wait for the device checks whether the result is still wanted.
const LOOK: Duration = Duration::from_millis(20);

/// How long the device does not respond during an injected fault.
const INJECTED_SILENCE: Duration = Duration::from_secs(10);

/// Number of buffers of the largest size that an injected fault allocates: no device has that much memory.
const INJECTED_BUFFERS: usize = 4096;

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
        gpu.faults.check().map_err(|reason| GpuError::Device { adapter: gpu.adapter.to_string(), reason })?;
        Ok(gpu)
    }

    /// Runs `create` and returns its result, or the device's error.
    pub fn guarded<T>(&self, create: impl FnOnce() -> T) -> Result<T, String> {
        let filters =
            [wgpu::ErrorFilter::Internal, wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation];
        let mut scopes = filters.map(|filter| Some(self.device.push_error_scope(filter)));
        let made = create();
        let mut error = None;
        for scope in scopes.iter_mut().rev() {
            let caught = scope.take().and_then(|scope| pollster::block_on(scope.pop()));
            error = error.or(caught);
        }
        match error {
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
        .map_err(|reason| format!("no buffer of {size} bytes for {label}: {reason}"))
    }

    /// Creates a buffer with the contents `data`.
    pub fn filled(
        &self,
        label: &str,
        data: &[u8],
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, String> {
        let buffer = self.buffer(label, data.len() as u64, usage | wgpu::BufferUsages::COPY_DST)?;
        self.queue.write_buffer(&buffer, 0, data);
        Ok(buffer)
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

    /// Breaks the device, as an injected fault does.
    pub fn break_by(&self, fault: Fault) {
        match fault {
            Fault::Lost => self.device.destroy(),
            Fault::OutOfMemory => self.use_up_memory(),
            Fault::Hang => self.silence().simulated_until = Some(Instant::now() + INJECTED_SILENCE),
            // The dispatch code injects these faults.
            Fault::Short | Fault::AlwaysShort => {}
            // Copies more than the buffer can hold.
            Fault::Invalid => {
                let small = self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("injection"),
                    size: 16,
                    usage: wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                self.queue.write_buffer(&small, 16, &[0; 16]);
            }
        }
    }

    /// Allocates buffers until an allocation fails.
    fn use_up_memory(&self) {
        let size = self.adapter.buffer_limit / 16 * 16;
        let mut taken = Vec::new();
        while self.faults.check().is_ok() && taken.len() < INJECTED_BUFFERS {
            taken.push(self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("injection"),
                size,
                usage: wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            }));
        }
    }

    fn silence(&self) -> MutexGuard<'_, Silence> {
        self.silence.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Allows the next response more time, because a kernel runs for the first time.
    pub fn expect_compiling(&self) {
        self.silence().compiles = true;
    }

    /// Waits until a submission is done.
    ///
    /// # Errors
    /// The device's failure, also if it has not responded for too long.
    pub fn wait(&self, submission: &wgpu::SubmissionIndex) -> Result<(), String> {
        self.wait_unless(submission, None).map(drop)
    }

    /// Waits until a submission is done and returns true, or returns false once `cancel` is set.
    ///
    /// # Errors
    /// As [`Gpu::wait`].
    pub fn wait_unless(
        &self,
        submission: &wgpu::SubmissionIndex,
        cancel: Option<&AtomicBool>,
    ) -> Result<bool, String> {
        loop {
            let begin = Instant::now();
            let polled = self.poll(submission);
            self.faults.check()?;
            let mut silence = self.silence();
            match polled {
                Ok(_) => {
                    (silence.waited, silence.compiles) = (Duration::ZERO, false);
                    return Ok(true);
                }
                Err(wgpu::PollError::Timeout) => silence.waited += begin.elapsed(),
                Err(error) => return Err(format!("the device was lost: {error}")),
            }
            if silence.waited >= self.patience * if silence.compiles { COMPILING_PATIENCE } else { 1 } {
                self.faults.note(format!(
                    "{} has not answered for {:.0} s and is given up; render on the CPU, or start again once it answers",
                    self.adapter.name,
                    silence.waited.as_secs_f64()
                ));
            } else if cancel.is_some_and(|cancel| cancel.load(Ordering::Relaxed)) {
                return Ok(false);
            }
        }
    }

    /// Waits briefly.
    fn poll(&self, submission: &wgpu::SubmissionIndex) -> Result<wgpu::PollStatus, wgpu::PollError> {
        let simulated_until = self.silence().simulated_until;
        if simulated_until.is_some_and(|until| Instant::now() < until) {
            std::thread::sleep(LOOK);
            return Err(wgpu::PollError::Timeout);
        }
        self.device
            .poll(wgpu::PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(LOOK) })
    }
}
