//! The list of backends and their factory. A new backend needs a variant of [`BackendChoice`] and an arm of
//! [`create`]; the command line, the window and the reports read everything else from here.

pub mod explain;
pub mod layers;

mod pending;

pub use pending::{Factory, Pending, Prepared, make};

use crate::job::render::Renderer;
use crate::render_cpu::{CpuOptions, CpuRenderer, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, GpuRenderer, adapters};
use anyhow::Result;
use std::sync::mpsc;
use std::time::Duration;

/// Which backend renders, with its options.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BackendChoice {
    /// `f32` on the CPU, in SIMD packets or scalar.
    Cpu(CpuOptions),
    /// A compute shader on the GPU.
    Gpu(GpuOptions),
    /// Scalar `f64` on the CPU, the reference for rounding errors.
    Reference {
        /// Number of threads; by default one per core.
        threads: Option<usize>,
    },
}

impl BackendChoice {
    /// The best choice for this machine: a GPU if one is available, otherwise the widest CPU kernel; always the CPU if any
    /// CPU option is set.
    pub fn auto(cpu: CpuOptions, gpu: GpuOptions) -> Self {
        let is_gpu = cpu == CpuOptions::default() && adapters().iter().any(AdapterInfo::is_fit);
        if is_gpu { BackendChoice::Gpu(gpu) } else { BackendChoice::Cpu(cpu) }
    }

    /// The GPU that `adapter` names, or else the best one; `None` if none is named and none is suitable.
    pub fn gpu_if_present(adapter: Option<&str>) -> Option<Self> {
        let is_there = adapter.is_some() || adapters().iter().any(AdapterInfo::is_fit);
        is_there.then(|| BackendChoice::Gpu(GpuOptions::of_adapter(adapter)))
    }

    /// The next backend to try after `failed` have failed: the CPU's best kernel, then its plainest code, then the
    /// reference. `None` if all have failed.
    pub fn fallback(failed: &[BackendChoice]) -> Option<Self> {
        let given = failed.iter().rev().find_map(|choice| match choice {
            BackendChoice::Cpu(options) => Some(*options),
            _ => None,
        });
        let best = CpuOptions { isa: None, lanes: None, ..given.unwrap_or_default() };
        let plainest = CpuOptions { isa: Some(Isa::Portable), lanes: Some(1), ..best };
        let runs_alike = |a: &BackendChoice, b: &BackendChoice| match (a, b) {
            (BackendChoice::Cpu(a), BackendChoice::Cpu(b)) => (a.isa, a.lanes) == (b.isa, b.lanes),
            (a, b) => a.name() == b.name(),
        };
        let reference = BackendChoice::Reference { threads: best.threads };
        [BackendChoice::Cpu(best), BackendChoice::Cpu(plainest), reference]
            .into_iter()
            .find(|choice| !failed.iter().any(|failed| runs_alike(failed, choice)))
    }

    /// Its name in a sentence.
    pub fn words(&self) -> &'static str {
        match self {
            BackendChoice::Cpu(CpuOptions { isa: Some(Isa::Portable), lanes: Some(1), .. }) => {
                "the CPU's scalar code"
            }
            BackendChoice::Cpu(_) => "the CPU",
            BackendChoice::Gpu(_) => "the GPU",
            BackendChoice::Reference { .. } => "the reference",
        }
    }

    /// Names of single backends, for comparisons: see [`BackendChoice::named`].
    pub const NAMES: [&str; 5] = ["cpu", "scalar", "portable", "reference", "gpu"];

    /// The backend with one of [`BackendChoice::NAMES`]: the CPU's widest packets, one lane at the best level, one
    /// lane without fused multiply and add, `f64`, or the GPU, where `adapter` chooses among several.
    pub fn named(name: &str, adapter: Option<&str>) -> Option<Self> {
        Some(match name {
            "cpu" => BackendChoice::Cpu(CpuOptions::default()),
            "scalar" => BackendChoice::Cpu(CpuOptions { lanes: Some(1), ..CpuOptions::default() }),
            "portable" => {
                let (isa, lanes) = (Some(Isa::Portable), Some(1));
                BackendChoice::Cpu(CpuOptions { isa, lanes, ..CpuOptions::default() })
            }
            "reference" => BackendChoice::Reference { threads: None },
            "gpu" => BackendChoice::Gpu(GpuOptions::of_adapter(adapter)),
            _ => return None,
        })
    }

    /// Its name for `--device`.
    pub fn name(&self) -> &'static str {
        match self {
            BackendChoice::Cpu(_) => "cpu",
            BackendChoice::Gpu(_) => "gpu",
            BackendChoice::Reference { .. } => "reference",
        }
    }
}

/// Starts a backend.
///
/// # Errors
/// If it is not available; the error says what is.
pub fn create(choice: &BackendChoice) -> Result<Box<dyn Renderer>> {
    log::info!("creating the backend {choice:?}");
    Ok(match choice {
        BackendChoice::Cpu(options) => Box::new(CpuRenderer::new(*options)?),
        BackendChoice::Gpu(options) => Box::new(GpuRenderer::new(options.clone())?),
        BackendChoice::Reference { threads } => Box::new(CpuRenderer::reference(*threads)?),
    })
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendListing {
    /// The `--device` value that selects it.
    pub device: &'static str,
    /// Instruction level or adapter, with its options.
    pub about: String,
    /// Whether `--device auto` chooses it.
    pub is_auto: bool,
}

/// The backends of this machine, ordered as on the command line.
pub fn list() -> Vec<BackendListing> {
    listing(Isa::available(), &adapters())
}

fn listing(levels: Vec<Isa>, adapters: &[AdapterInfo]) -> Vec<BackendListing> {
    let best = levels.last().copied();
    let auto_adapter = adapters.iter().position(AdapterInfo::is_fit);
    let cpu = levels.into_iter().map(|isa| {
        let lanes: Vec<String> = isa.lane_counts().iter().map(usize::to_string).collect();
        let about = format!("--isa {isa}: --simd {}; default {}", lanes.join(", "), isa.native_lanes());
        BackendListing { device: "cpu", about, is_auto: auto_adapter.is_none() && Some(isa) == best }
    });
    let gpu = adapters.iter().enumerate().map(|(index, adapter)| {
        let [buffers, bindings] =
            [adapter.buffer_limit, adapter.storage_binding_limit].map(|bytes| bytes >> 20);
        let lacks = adapter.lacks.as_ref().map_or(String::new(), |lacks| format!("; not usable: {lacks}"));
        let software = if adapter.is_software { "; used only if named with --adapter" } else { "" };
        let limits = format!("buffers of up to {buffers} MiB, bindings of up to {bindings} MiB");
        let about = format!("{adapter}: {limits}{lacks}{software}");
        BackendListing { device: "gpu", about, is_auto: auto_adapter == Some(index) }
    });
    let about = "f64, one lane: slow, the reference for rounding errors".to_owned();
    let reference = BackendListing { device: "reference", about, is_auto: false };
    cpu.chain(gpu).chain([reference]).collect()
}

/// How long to wait for a backend to close.
const CLOSING_PATIENCE: Duration = Duration::from_secs(1);

/// Closes a failed backend on its own thread, because a hanging driver would block the caller. Waits for it briefly,
/// since a driver may crash if the program ends while it is still working.
pub fn close<T: Send + 'static>(backend: T) {
    let (closed, is_closed) = mpsc::channel();
    let work = move || {
        drop(backend);
        // The caller may have stopped waiting.
        let _ = closed.send(());
    };
    // If no thread starts, it is closed here.
    if std::thread::Builder::new().name("close".to_owned()).spawn(work).is_ok() {
        let _ = is_closed.recv_timeout(CLOSING_PATIENCE);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render_gpu::tests::adapter;

    #[test]
    fn one_listed_backend_is_the_automatic_one() {
        let auto = |cpu| BackendChoice::auto(cpu, GpuOptions::of_adapter(Some("x"))).name();
        let listed: Vec<_> = list().into_iter().filter(|line| line.is_auto).map(|line| line.device).collect();
        assert_eq!(listed, [auto(CpuOptions::default())]);
        assert_eq!(auto(CpuOptions { threads: Some(3), ..CpuOptions::default() }), "cpu");
        let software = adapter("software", "Vulkan", true, None);
        let good = adapter("other", "Vulkan", false, None);
        let lacking = adapter("other", "Vulkan", false, Some("no compute shaders"));
        let chosen = |adapters: &[AdapterInfo]| {
            let list = listing(vec![Isa::Portable, Isa::Sse42], adapters);
            list.iter().map(|line| line.is_auto).collect::<Vec<_>>()
        };
        assert_eq!(chosen(&[software.clone(), lacking]), [false, true, false, false, false]);
        assert_eq!(chosen(&[software, good.clone(), good]), [false, false, false, true, false, false]);
    }

    #[test]
    fn each_fallback_is_tried_once_with_the_threads_and_the_priority() {
        let fallbacks = |first: BackendChoice| {
            let mut failed = vec![first];
            while let Some(next) = BackendChoice::fallback(&failed) {
                failed.push(next);
            }
            failed
        };
        let words: Vec<_> =
            fallbacks(BackendChoice::Gpu(GpuOptions::default())).iter().map(BackendChoice::words).collect();
        assert_eq!(words, ["the GPU", "the CPU", "the CPU's scalar code", "the reference"]);
        let best = CpuOptions { threads: Some(3), low_priority: true, ..CpuOptions::default() };
        let scalar = BackendChoice::Cpu(CpuOptions { lanes: Some(1), ..best });
        assert_eq!(BackendChoice::fallback(&[scalar]), Some(BackendChoice::Cpu(best)));
        let plainest = BackendChoice::Cpu(CpuOptions { isa: Some(Isa::Portable), lanes: Some(1), ..best });
        let failed = fallbacks(plainest.clone());
        assert_eq!(failed[1..], [BackendChoice::Cpu(best), BackendChoice::Reference { threads: Some(3) }]);
        // Of several, the latest options count; those of other backends have none.
        let failed = [BackendChoice::Cpu(best), BackendChoice::Gpu(GpuOptions::default())];
        assert_eq!(BackendChoice::fallback(&failed), Some(plainest));
    }
}
