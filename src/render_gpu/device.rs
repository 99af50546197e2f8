//! Adapters, the device, and what can go wrong with it.

use super::options::COMPILING_PATIENCE;
use super::{Fault, GpuError};
use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Storage buffers that the path tracer binds.
const STORAGE_BUFFERS: u32 = 8;

/// Threads that keep a processor busy that does the work of a GPU. Of 1024 and 4096 both were as fast, and a whole picture
/// slower by a seventh.
const BUSY_THREADS_OF_SOFTWARE: u64 = 4096;

/// What an adapter is, for lists and reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    /// As the driver calls it.
    pub name: String,
    /// "discrete GPU", "integrated GPU", "virtual GPU", "software" or "other".
    pub kind: &'static str,
    /// "Vulkan", "Metal", "DX12" or "GL".
    pub backend: String,
    /// Driver and its version.
    pub driver: String,
    /// Whether a processor computes what a GPU should.
    pub is_software: bool,
    /// Largest storage buffer that a shader can see at once, bytes.
    pub storage_binding_limit: u64,
    /// Largest buffer, bytes.
    pub buffer_limit: u64,
    /// Whether it can time a dispatch itself.
    pub has_timestamps: bool,
    /// Most threads that run in step.
    pub subgroup_size: u32,
    /// Why the path tracer cannot run on it, if it cannot.
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
            // GL names every device "other", software too.
            is_software: info.device_type == wgpu::DeviceType::Cpu || names_software(&info.name),
            storage_binding_limit: limits.max_storage_buffer_binding_size,
            buffer_limit: limits.max_buffer_size,
            has_timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            subgroup_size: info.subgroup_max_size,
            lacks,
        }
    }

    /// By how many threads a limit of the turns of loops is shared: software counts those of all threads that run in
    /// step. No limit of a GPU is known.
    pub fn threads_in_step(&self) -> u32 {
        // Some do not tell; a processor has room for 8 in its registers.
        if self.is_software { self.subgroup_size.clamp(8, 64) } else { 1 }
    }

    /// Threads that keep it busy: a dispatch has as many if it can, then as many samples as its time allows. More threads
    /// of fewer samples each are slower, since those that run in step wait for the longest.
    pub fn busy_threads(&self) -> u64 {
        if self.is_software { BUSY_THREADS_OF_SOFTWARE } else { u64::MAX }
    }

    /// Whether it is chosen when none is named: a GPU that the path tracer can run on.
    pub fn is_fit(&self) -> bool {
        !self.is_software && self.lacks.is_none()
    }

    /// Smaller is chosen first.
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

/// As `NVIDIA H200 (discrete GPU, Vulkan, driver 580.1)`.
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

/// Adapters, best first. GL is looked at only where nothing better has what is asked for: it would name the same
/// hardware again, and its libraries print complaints of their own.
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
        // Debug builds would load a driver's validation layers, which slow everything down.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let found = pollster::block_on(instance.enumerate_adapters(backends));
    found.into_iter().map(|adapter| (AdapterInfo::of(&adapter), adapter)).collect()
}

/// All adapters of this machine, that which is chosen by itself first. Software stands behind hardware.
pub fn adapters() -> Vec<AdapterInfo> {
    all_adapters(|_| true).into_iter().map(|(info, _)| info).collect()
}

/// The first failure of a device: what comes after it is its consequence.
#[derive(Debug, Default)]
pub struct Faults {
    first: Mutex<Option<String>>,
}

impl Faults {
    fn note(&self, what: String) {
        self.first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(what);
    }

    /// `Err` with the first failure, if there was one.
    pub fn check(&self) -> Result<(), String> {
        match &*self.first.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(what) => Err(what.clone()),
            None => Ok(()),
        }
    }
}

/// How the bindings of the shaders are grouped.
#[derive(Clone, Debug)]
pub struct Layouts {
    /// Group 0: the job.
    pub job: wgpu::BindGroupLayout,
    /// Group 1: the dispatch.
    pub dispatch: wgpu::BindGroupLayout,
    /// Group 2: words in and out.
    pub words: wgpu::BindGroupLayout,
    /// All of them.
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

/// An open device; clones are the same one.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The adapter it is of.
    pub adapter: AdapterInfo,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Its bindings.
    pub layouts: Layouts,
    /// Its failures.
    pub faults: Arc<Faults>,
    /// How long it is waited for.
    patience: Duration,
    silence: Arc<Mutex<Silence>>,
}

/// How long a device has not answered.
#[derive(Debug, Default)]
struct Silence {
    /// What was waited since its last answer.
    waited: Duration,
    /// Whether the driver may be compiling.
    compiles: bool,
    /// When an injected fault ends in which it does not answer.
    simulated_until: Option<Instant>,
}

/// How often whoever waits for the device looks whether its answer is still wanted.
const LOOK: Duration = Duration::from_millis(20);

/// How long a device does not answer in an injected fault.
const INJECTED_SILENCE: Duration = Duration::from_secs(10);

/// Buffers of the largest size that an injected fault asks for: no device has so much memory.
const INJECTED_BUFFERS: usize = 4096;

impl Gpu {
    /// Opens the first adapter whose name, backend or driver contains `wanted` (in any case), or the first of
    /// all. A software adapter must be allowed.
    ///
    /// # Errors
    /// [`GpuError`] with the adapters that there are.
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

    /// Runs `create` and returns what it made, or what the device had against it.
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

    /// A buffer of zeros.
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

    /// A buffer with `data` in it.
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

    /// Bindings `0 ..` to whole buffers.
    pub fn bind(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// Breaks the device, as an injected fault.
    pub fn break_by(&self, fault: Fault) {
        match fault {
            Fault::Lost => self.device.destroy(),
            Fault::OutOfMemory => self.use_up_memory(),
            Fault::Hang => self.silence().simulated_until = Some(Instant::now() + INJECTED_SILENCE),
            // It is the dispatch's.
            Fault::Short | Fault::AlwaysShort => {}
            // More than the buffer has room for.
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

    /// Asks for buffers until one is refused.
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

    /// The next answer may take longer: a kernel runs for the first time.
    pub fn expect_compiling(&self) {
        self.silence().compiles = true;
    }

    /// Waits until a submission is done.
    ///
    /// # Errors
    /// What failed, also if the device has not answered for too long.
    pub fn wait(&self, submission: &wgpu::SubmissionIndex) -> Result<(), String> {
        self.wait_unless(submission, None).map(drop)
    }

    /// Waits until a submission is done, which it returns, or `cancel` is set.
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

    /// Waits for a moment.
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
