//! Adapters: what they are, what they can do, and which comes first.

use crate::system::foreign::Captured;
use std::fmt;
use std::sync::OnceLock;

/// Number of storage buffers that the path tracer binds.
pub const STORAGE_BUFFERS: u32 = 8;

/// Number of threads that keep a software adapter busy. 1024 threads and 4096 were equally fast; a dispatch of the
/// whole picture was a seventh slower.
pub const BUSY_THREADS_OF_SOFTWARE: u64 = 4096;

/// The smallest and the largest number of threads that a software adapter runs in step.
pub const SOFTWARE_THREADS_IN_STEP: [u32; 2] = [8, 64];

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
            Some(format!("only {count} storage buffers per shader, but needs {STORAGE_BUFFERS}"))
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
            subgroup_size: info.subgroup_max_size,
            lacks,
        }
    }

    /// Number of threads that share a limit on iterations: software counts those of all threads that run in step.
    /// GPUs have no known limit.
    pub fn threads_in_step(&self) -> u32 {
        // Some adapters do not report a subgroup size; 8 threads fit a processor's registers.
        let [fewest, most] = SOFTWARE_THREADS_IN_STEP;
        if self.is_software { self.subgroup_size.clamp(fewest, most) } else { 1 }
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

    /// The remedy if this adapter's kernels cannot be compiled.
    pub(super) fn compiler_remedy(&self) -> &'static str {
        if self.backend == "DX12" {
            "Direct3D compiles with FXC unless dxcompiler.dll is beside the program: put it there, install the \
             graphics card's Vulkan driver, or render on the CPU"
        } else {
            "choose another adapter, or render on the CPU"
        }
    }

    /// The sort key for adapters: the smallest comes first.
    fn rank(&self) -> (bool, bool, usize, usize) {
        let kinds = ["discrete GPU", "integrated GPU", "virtual GPU"];
        let kind = kinds.iter().position(|kind| *kind == self.kind).unwrap_or(kinds.len());
        // Vulkan's drivers compile kernels in a second; Direct3D's FXC can take minutes.
        let backend =
            ["DX12", "GL"].iter().position(|backend| *backend == self.backend).map_or(0, |place| place + 1);
        (self.lacks.is_some(), self.is_software, kind, backend)
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

/// All adapters, best first, of those graphics interfaces that the environment variable `WGPU_BACKEND` names, if it is
/// set (`vulkan,gl`; `noop` finds none). GL is enumerated only if no other backend has a usable adapter that is `wanted`:
/// it would list the same hardware again, and its libraries print warnings of their own.
pub fn all_adapters(wanted: impl Fn(&AdapterInfo) -> bool) -> Vec<(AdapterInfo, wgpu::Adapter)> {
    let allowed =
        super::options::variable().and_then(|_| wgpu::Backends::from_env()).unwrap_or(wgpu::Backends::all());
    let mut adapters = adapters_of(wgpu::Backends::PRIMARY & allowed);
    let is_found = adapters.iter().any(|(info, _)| info.lacks.is_none() && wanted(info));
    if !is_found && allowed.contains(wgpu::Backends::GL) {
        adapters.extend(adapters_of(wgpu::Backends::GL));
    }
    adapters.sort_by_key(|(info, _)| info.rank());
    for (info, _) in &adapters {
        let lacks = info.lacks.as_ref().map_or(String::new(), |lacks| format!("; not usable: {lacks}"));
        log::info!("found {info}{lacks}");
    }
    adapters
}

fn adapters_of(backends: wgpu::Backends) -> Vec<(AdapterInfo, wgpu::Adapter)> {
    // Without any, wgpu panics.
    let backends = backends & wgpu::Instance::enabled_backend_features();
    if backends.is_empty() {
        return Vec::new();
    }
    // Drivers print messages of their own.
    let _captured = Captured::begin();
    let found = pollster::block_on(instance(backends).enumerate_adapters(backends));
    found.into_iter().map(|adapter| (AdapterInfo::of(&adapter), adapter)).collect()
}

/// The instance for these backends. It lives as long as the program: the loader unloads the driver together with its
/// last instance, and a thread that has used NVIDIA's driver then crashes when it ends, because what it should call to
/// clean up is gone.
fn instance(backends: wgpu::Backends) -> &'static wgpu::Instance {
    static PRIMARY: OnceLock<wgpu::Instance> = OnceLock::new();
    static GL: OnceLock<wgpu::Instance> = OnceLock::new();
    let kept = if backends == wgpu::Backends::GL { &GL } else { &PRIMARY };
    kept.get_or_init(|| {
        wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends,
            // Without this, debug builds would load the driver's validation layers, which slow everything down.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        })
    })
}

/// All adapters of this machine, the default one first. Software adapters come after hardware.
pub fn adapters() -> Vec<AdapterInfo> {
    all_adapters(|_| true).into_iter().map(|(info, _)| info).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub fn adapter(kind: &'static str, backend: &str, is_software: bool, lacks: Option<&str>) -> AdapterInfo {
        AdapterInfo {
            name: "an adapter".to_owned(),
            kind,
            backend: backend.to_owned(),
            driver: "driver 1".to_owned(),
            is_software,
            storage_binding_limit: 1 << 27,
            buffer_limit: 1 << 28,
            subgroup_size: 32,
            lacks: lacks.map(str::to_owned),
        }
    }

    #[test]
    fn the_fastest_adapter_comes_first() {
        let ordered = [
            adapter("discrete GPU", "Vulkan", false, None),
            adapter("discrete GPU", "DX12", false, None),
            adapter("discrete GPU", "GL", false, None),
            adapter("integrated GPU", "Vulkan", false, None),
            adapter("virtual GPU", "Vulkan", false, None),
            adapter("other", "Vulkan", false, None),
            adapter("software", "Vulkan", true, None),
            adapter("discrete GPU", "Vulkan", false, Some("no compute shaders")),
        ];
        for pair in ordered.windows(2) {
            assert!(pair[0].rank() < pair[1].rank(), "{pair:?}");
        }
    }
}
