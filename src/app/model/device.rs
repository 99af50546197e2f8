//! The devices that the window offers for tracing.

use crate::backends::BackendChoice;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, INTERACTIVE_TARGET, adapters};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// The adapter that the GPU device uses; hardware adapters come first. The result is cached, because the search takes a
/// while and adapters rarely change.
pub fn adapter() -> Result<&'static AdapterInfo, String> {
    static ADAPTERS: OnceLock<Vec<AdapterInfo>> = OnceLock::new();
    let all = ADAPTERS.get_or_init(adapters);
    match (all.iter().find(|adapter| adapter.lacks.is_none()), all.first()) {
        (Some(fit), _) => Ok(fit),
        (None, Some(unfit)) => {
            Err(format!("{} cannot be used: {}", unfit.name, unfit.lacks.as_deref().unwrap_or_default()))
        }
        (None, None) => Err("No graphics card was found, so the processor traces everything".to_owned()),
    }
}

/// A device that the user can choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Device {
    /// SIMD packets on all cores.
    #[default]
    Cpu,
    /// The graphics adapter.
    #[serde(alias = "Both")]
    Gpu,
    /// Scalar `f64` on the CPU.
    Reference,
}

impl Device {
    /// All devices, in the order of the toggle.
    pub const ALL: [Device; 3] = [Device::Cpu, Device::Gpu, Device::Reference];

    /// The name used by `--device`, and the label in the window.
    fn words(self) -> [&'static str; 2] {
        match self {
            Device::Cpu => ["cpu", "CPU"],
            Device::Gpu => ["gpu", "GPU"],
            Device::Reference => ["reference", "Reference"],
        }
    }

    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    pub fn label(self) -> &'static str {
        self.words()[1]
    }

    /// The device of a backend.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(_) => Device::Cpu,
            BackendChoice::Gpu(_) => Device::Gpu,
            BackendChoice::Reference { .. } => Device::Reference,
        }
    }

    /// The backend for the device, with the options of the one that was given on the command line as far as it has them.
    pub fn backend(self, given: &BackendChoice) -> BackendChoice {
        let (cpu, gpu) = match given {
            BackendChoice::Cpu(cpu) => (*cpu, GpuOptions::default()),
            BackendChoice::Gpu(gpu) => (CpuOptions::default(), gpu.clone()),
            BackendChoice::Reference { threads } => {
                (CpuOptions { threads: *threads, ..CpuOptions::default() }, GpuOptions::default())
            }
        };
        let threads = cpu.threads.or_else(threads_of_window);
        let cpu = CpuOptions { threads, low_priority: true, ..cpu };
        // A user who presses the button wants it, so a software adapter is accepted.
        let dispatch_target = gpu.dispatch_target.min(INTERACTIVE_TARGET);
        match self {
            Device::Cpu => BackendChoice::Cpu(cpu),
            Device::Gpu => BackendChoice::Gpu(GpuOptions { allow_software: true, dispatch_target, ..gpu }),
            Device::Reference => BackendChoice::Reference { threads },
        }
    }

    /// Whether it stands in the bar: the CPU alone where no graphics card is.
    pub fn is_shown(self) -> bool {
        self == Device::Cpu || self == Device::Gpu && adapter().is_ok_and(|adapter| !adapter.is_software)
    }

    /// Why the device is not available, in words; `None` if it is.
    pub fn unavailable(self) -> Option<String> {
        match self {
            Device::Cpu | Device::Reference => None,
            Device::Gpu => adapter().err(),
        }
    }
}

/// The default number of threads. With more than two cores, one is left to the window. With fewer, that would cost half
/// of the speed or more, and short passes keep the window responsive too.
fn threads_of_window() -> Option<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (cores > 2).then(|| cores - 1)
}

/// The best level of this processor.
pub fn best_isa() -> Isa {
    Isa::available().into_iter().max().unwrap_or(Isa::Portable)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_device_has_its_backend_and_says_what_is_wrong() {
        let given = BackendChoice::Cpu(CpuOptions::default());
        for device in Device::ALL {
            let choice = device.backend(&given);
            assert_eq!((Device::of(&choice), choice.name()), (device, device.name()));
            assert!(device.unavailable().is_none_or(|reason| reason.len() > 10));
        }
    }

    #[test]
    fn each_device_takes_its_options() {
        let given = BackendChoice::Cpu(CpuOptions { threads: Some(3), ..CpuOptions::default() });
        let BackendChoice::Cpu(found) = Device::Cpu.backend(&given) else { panic!("no CPU") };
        assert_eq!((found.threads, found.lanes, found.low_priority), (Some(3), None, true));
        for (seconds, expected) in [(9.0, INTERACTIVE_TARGET.as_secs_f64()), (0.001, 0.001)] {
            let dispatch_target = std::time::Duration::from_secs_f64(seconds);
            let adapter = Some("mine".to_owned());
            let given = BackendChoice::Gpu(GpuOptions { adapter, dispatch_target, ..GpuOptions::default() });
            let BackendChoice::Gpu(found) = Device::Gpu.backend(&given) else { panic!("no GPU") };
            assert_eq!((found.adapter.as_deref(), found.allow_software), (Some("mine"), true));
            assert_eq!(found.dispatch_target.as_secs_f64(), expected, "the window stays responsive");
        }
        let given = BackendChoice::Reference { threads: Some(5) };
        assert_eq!(Device::Reference.backend(&given), given);
    }
}
