//! Kernels: a shader specialised to a job by pipeline overrides. Each set of features is compiled once, on a background
//! thread, and stays in the cache.

use super::adapter::AdapterInfo;
use super::device::Gpu;
use super::failed;
use super::shader_source::{EntryPoint, source};
use crate::job::render::RenderError;
use crate::kernel::Features;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often a wait for a kernel checks whether the kernel is still wanted.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// How long a driver may compile. The slowest known one that finishes takes a few seconds.
const PATIENCE: Duration = Duration::from_secs(60);

/// A compiled kernel.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub pipeline: wgpu::ComputePipeline,
    pub compile_time: Duration,
}

type Module = Arc<Mutex<Option<wgpu::ShaderModule>>>;

/// A kernel in the cache.
pub enum Slot {
    Compiling(Receiver<Result<Kernel, String>>, Instant),
    Done(Result<Kernel, String>),
}

/// All kernels of a device, finished or being compiled.
#[derive(Default)]
pub struct Kernels {
    module: Module,
    slots: HashMap<Features, Slot>,
}

impl Kernels {
    /// Starts compiling a kernel unless that has been done, without waiting for it.
    pub fn begin(&mut self, gpu: &Gpu, features: Features) -> &mut Slot {
        let module = &self.module;
        self.slots.entry(features).or_insert_with(|| start(gpu.clone(), features, Arc::clone(module)))
    }

    /// Returns a kernel, compiling it on first use.
    ///
    /// # Errors
    /// [`RenderError::Backend`] with the device's error. [`RenderError::Cancelled`] if the kernel is no longer wanted:
    /// it continues to compile, and the finished kernel stays in the cache.
    pub fn get(&mut self, gpu: &Gpu, features: Features, cancel: &AtomicBool) -> Result<Kernel, RenderError> {
        self.begin(gpu, features).wait(&gpu.adapter, cancel)
    }
}

impl Slot {
    fn wait(&mut self, adapter: &AdapterInfo, cancel: &AtomicBool) -> Result<Kernel, RenderError> {
        loop {
            match self {
                Slot::Done(kernel) => return kernel.clone().map_err(failed),
                Slot::Compiling(kernel, begin) => match kernel.recv_timeout(POLL_INTERVAL) {
                    Ok(kernel) => *self = Slot::Done(kernel),
                    Err(RecvTimeoutError::Disconnected) => {
                        *self = Slot::Done(Err("the kernel's compiler ended unexpectedly".to_owned()));
                    }
                    Err(RecvTimeoutError::Timeout) if cancel.load(Ordering::Relaxed) => {
                        return Err(RenderError::Cancelled);
                    }
                    Err(RecvTimeoutError::Timeout) if begin.elapsed() >= PATIENCE => {
                        return Err(failed(format!(
                            "{adapter} has been compiling the kernel for {:.0} s; {}",
                            begin.elapsed().as_secs_f64(),
                            adapter.compiler_remedy()
                        )));
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                },
            }
        }
    }
}

/// Compiles on a background thread, or at once if no thread can be started.
fn start(gpu: Gpu, features: Features, module: Module) -> Slot {
    let (sender, kernel) = mpsc::channel();
    let compile = {
        let (gpu, module) = (gpu.clone(), Arc::clone(&module));
        // If the renderer has been dropped, there is no receiver.
        move || drop(sender.send(compiled(&gpu, features, &module)))
    };
    match std::thread::Builder::new().name("compile".to_owned()).spawn(compile) {
        Ok(_) => Slot::Compiling(kernel, Instant::now()),
        Err(_) => Slot::Done(compiled(&gpu, features, &module)),
    }
}

fn compiled(gpu: &Gpu, features: Features, module: &Module) -> Result<Kernel, String> {
    let start = Instant::now();
    let label = Some(EntryPoint::PathTrace.name());
    let module = {
        let mut module = module.lock().unwrap_or_else(PoisonError::into_inner);
        match &*module {
            Some(module) => module.clone(),
            None => {
                let source = wgpu::ShaderSource::Wgsl(source(EntryPoint::PathTrace).into());
                let described = wgpu::ShaderModuleDescriptor { label, source };
                module.insert(gpu.guarded(|| module_of(gpu, described))?).clone()
            }
        }
    };
    let overrides = features.overrides();
    let constants: Vec<(&str, f64)> = overrides.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let pipeline = gpu.guarded(|| {
        gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label,
            layout: Some(&gpu.layouts.pipeline),
            module: &module,
            entry_point: label,
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            cache: None,
        })
    });
    let pipeline = pipeline.map_err(|reason| {
        log::warn!("{reason}");
        // The last line is the compiler's; those before it name calls of wgpu.
        let cause = reason.trim().lines().last().unwrap_or_default().trim();
        format!("{} cannot compile the kernel: {cause}; {}", gpu.adapter, gpu.adapter.compiler_remedy())
    })?;
    Ok(Kernel { pipeline, compile_time: start.elapsed() })
}

/// Compiles a shader without the counters that wgpu adds to its loops. They cost an eighth of the time of a picture of a
/// few spheres on an H200.
#[allow(unsafe_code)]
fn module_of(gpu: &Gpu, described: wgpu::ShaderModuleDescriptor<'_>) -> wgpu::ShaderModule {
    let checks = wgpu::ShaderRuntimeChecks { force_loop_bounding: false, ..Default::default() };
    // SAFETY: all checks but those of loops stay, and every loop of the shaders ends. The loop over a thread's rays counts
    // its iterations up to `iteration_limit`, the traversal its nodes up to `node_count`, and the loop over a leaf clears one of 24
    // bits per iteration. All others count up to a number that does not change.
    unsafe { gpu.device.create_shader_module_trusted(described, checks) }
}

#[cfg(test)]
mod tests {
    use super::super::adapter::tests::adapter;
    use super::*;

    #[test]
    fn endless_compilation_is_given_up() {
        let (_sender, kernel) = mpsc::channel();
        let begin = Instant::now().checked_sub(PATIENCE).unwrap();
        let mut slot = Slot::Compiling(kernel, begin);
        let adapter = adapter("discrete GPU", "DX12", false, None);
        assert!(matches!(slot.wait(&adapter, &AtomicBool::new(true)), Err(RenderError::Cancelled)));
        let message = slot.wait(&adapter, &AtomicBool::new(false)).unwrap_err().to_string();
        for part in ["compiling the kernel for 60 s", "dxcompiler.dll", "Vulkan", "CPU"] {
            assert!(message.contains(part), "{message}");
        }
    }
}
