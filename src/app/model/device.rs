//! The devices that the window offers for tracing.

use crate::backends::BackendChoice;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, INTERACTIVE_TARGET, adapters};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// Options of the devices, from the command line.
#[derive(Clone, Debug, Default)]
pub struct DeviceOptions {
    cpu: CpuOptions,
    gpu: GpuOptions,
}

impl DeviceOptions {
    /// The options of a backend. Those that it does not use get their defaults.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(cpu) => DeviceOptions { cpu: *cpu, ..Self::default() },
            BackendChoice::Gpu(gpu) => DeviceOptions { gpu: gpu.clone(), ..Self::default() },
            BackendChoice::Reference { threads } => DeviceOptions {
                cpu: CpuOptions { threads: *threads, ..CpuOptions::default() },
                ..Self::default()
            },
        }
    }
}

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

    /// The name used by `--device`, the label in the window, and a short description.
    fn words(self) -> [&'static str; 3] {
        match self {
            Device::Cpu => ["cpu", "CPU", "Trace on the processor"],
            Device::Gpu => ["gpu", "GPU", "Trace on the graphics card, usually many times faster"],
            Device::Reference => [
                "reference",
                "Reference",
                "Trace with 16 digits instead of 7, slowly, to show rounding errors",
            ],
        }
    }

    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    pub fn label(self) -> &'static str {
        self.words()[1]
    }

    pub fn help(self) -> &'static str {
        match (self, adapter()) {
            (Device::Gpu, Ok(adapter)) if adapter.is_software => {
                "No graphics card: \"GPU\" runs on the processor and is slower"
            }
            _ => self.words()[2],
        }
    }

    /// The device of a backend.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(_) => Device::Cpu,
            BackendChoice::Gpu(_) => Device::Gpu,
            BackendChoice::Reference { .. } => Device::Reference,
        }
    }

    /// This other device, or the CPU again.
    pub fn toggled(self, other: Device) -> Device {
        if self == other { Device::Cpu } else { other }
    }

    /// The backend for the device.
    pub fn backend(self, options: &DeviceOptions) -> BackendChoice {
        let threads = options.cpu.threads.or_else(threads_of_window);
        let cpu = CpuOptions { threads, low_priority: true, ..options.cpu };
        // A user who presses the button wants it, so a software adapter is accepted.
        let dispatch_target = options.gpu.dispatch_target.min(INTERACTIVE_TARGET);
        match self {
            Device::Cpu => BackendChoice::Cpu(cpu),
            Device::Gpu => BackendChoice::Gpu(GpuOptions {
                allow_software: true,
                dispatch_target,
                ..options.gpu.clone()
            }),
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
        let options = DeviceOptions::default();
        for device in Device::ALL {
            let choice = device.backend(&options);
            assert_eq!((Device::of(&choice), choice.name()), (device, device.name()));
            assert!(device.unavailable().is_none_or(|reason| reason.len() > 10));
        }
    }

    #[test]
    fn each_device_takes_its_options() {
        let cpu = CpuOptions { threads: Some(3), ..CpuOptions::default() };
        let long = std::time::Duration::from_secs(9);
        let gpu =
            GpuOptions { adapter: Some("mine".to_owned()), dispatch_target: long, ..GpuOptions::default() };
        let options = DeviceOptions { cpu, gpu: gpu.clone() };
        let BackendChoice::Cpu(found) = Device::Cpu.backend(&options) else { panic!("no CPU") };
        assert_eq!((found.threads, found.lanes, found.low_priority), (Some(3), None, true));
        let BackendChoice::Gpu(found_gpu) = Device::Gpu.backend(&options) else { panic!("no GPU") };
        assert_eq!((found_gpu.adapter.as_deref(), found_gpu.allow_software), (Some("mine"), true));
        assert_eq!(found_gpu.dispatch_target, INTERACTIVE_TARGET, "the window stays responsive");
        let short = std::time::Duration::from_millis(1);
        let options = DeviceOptions::of(&BackendChoice::Gpu(GpuOptions { dispatch_target: short, ..gpu }));
        let BackendChoice::Gpu(found) = Device::Gpu.backend(&options) else { panic!("no GPU") };
        assert_eq!(found.dispatch_target, short);
        let options = DeviceOptions::of(&BackendChoice::Reference { threads: Some(5) });
        let found = Device::Reference.backend(&options);
        assert_eq!(found, BackendChoice::Reference { threads: Some(5) });
    }
}
