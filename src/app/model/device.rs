//! Who traces, as the window offers it.

use crate::backends::BackendChoice;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::{AdapterInfo, GpuOptions, INTERACTIVE_TARGET, adapters};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// What the devices are to use, as the command line has it.
#[derive(Clone, Debug, Default)]
pub struct DeviceOptions {
    cpu: CpuOptions,
    gpu: GpuOptions,
}

impl DeviceOptions {
    /// Those of a backend; for what it does not use, the usual ones.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(cpu) => DeviceOptions { cpu: *cpu, ..Self::default() },
            BackendChoice::Gpu(gpu) => DeviceOptions { gpu: gpu.clone(), ..Self::default() },
            BackendChoice::Both(cpu, gpu) => DeviceOptions { cpu: *cpu, gpu: gpu.clone() },
            BackendChoice::Reference { threads } => DeviceOptions {
                cpu: CpuOptions { threads: *threads, ..CpuOptions::default() },
                ..Self::default()
            },
        }
    }
}

/// The adapter that the GPU stands for; hardware first. Looking for it takes a while, and adapters seldom come
/// and go.
pub fn adapter() -> Result<&'static AdapterInfo, String> {
    static ADAPTERS: OnceLock<Vec<AdapterInfo>> = OnceLock::new();
    let all = ADAPTERS.get_or_init(adapters);
    match (all.iter().find(|adapter| adapter.lacks.is_none()), all.first()) {
        (Some(fit), _) => Ok(fit),
        (None, Some(unfit)) => {
            Err(format!("{} cannot be used: {}", unfit.name, unfit.lacks.as_deref().unwrap_or_default()))
        }
        (None, None) => Err("No graphics adapter was found; the CPU does everything".to_owned()),
    }
}

/// A device that the user can choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Device {
    /// SIMD packets on all cores.
    #[default]
    Cpu,
    /// The graphics adapter.
    Gpu,
    /// Both on one picture.
    Both,
    /// Scalar `f64` on the CPU.
    Reference,
}

impl Device {
    /// All of them, in the order of the toggle.
    pub const ALL: [Device; 4] = [Device::Cpu, Device::Gpu, Device::Both, Device::Reference];

    /// As `--device` names it.
    pub fn name(self) -> &'static str {
        match self {
            Device::Cpu => "cpu",
            Device::Gpu => "gpu",
            Device::Both => "cpu,gpu",
            Device::Reference => "reference",
        }
    }

    /// As the window names it.
    pub fn label(self) -> &'static str {
        match self {
            Device::Cpu => "CPU",
            Device::Gpu => "GPU",
            Device::Both => "Both",
            Device::Reference => "f64",
        }
    }

    /// What it is.
    pub fn help(self) -> &'static str {
        match self {
            Device::Cpu => "Trace on the processor, in packets of as many rays as it has lanes",
            Device::Gpu => "Trace on the graphics adapter",
            Device::Both => "Let processor and graphics adapter work on one picture",
            Device::Reference => {
                "Trace in double precision, one ray at a time: slow, and what rounding is measured against"
            }
        }
    }

    /// What it is, with the adapter's name.
    pub fn long_help(self) -> String {
        match (self, adapter()) {
            (Device::Gpu | Device::Both, Ok(adapter)) => {
                let note =
                    if adapter.is_software { ", which computes on the processor and is slower" } else { "" };
                format!("{} ({}{note})", self.help(), adapter.name)
            }
            _ => self.help().to_owned(),
        }
    }

    /// The device of a backend.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(_) => Device::Cpu,
            BackendChoice::Gpu(_) => Device::Gpu,
            BackendChoice::Both(..) => Device::Both,
            BackendChoice::Reference { .. } => Device::Reference,
        }
    }

    /// The backend that stands for it, with lanes and threads in place of those of the options.
    pub fn backend(
        self,
        options: &DeviceOptions,
        lanes: Option<usize>,
        threads: Option<usize>,
    ) -> BackendChoice {
        let threads = threads.or(options.cpu.threads).or_else(threads_of_window);
        let lanes = lanes.or(options.cpu.lanes);
        let cpu = CpuOptions { lanes, threads, low_priority: true, ..options.cpu };
        // Whoever presses the button means it: software will do.
        let dispatch_target = options.gpu.dispatch_target.min(INTERACTIVE_TARGET);
        let gpu = || GpuOptions { allow_software: true, dispatch_target, ..options.gpu.clone() };
        match self {
            Device::Cpu => BackendChoice::Cpu(cpu),
            Device::Gpu => BackendChoice::Gpu(gpu()),
            Device::Both => BackendChoice::Both(cpu, gpu()),
            Device::Reference => BackendChoice::Reference { threads },
        }
    }

    /// Why it cannot be had, in words.
    pub fn unavailable(self) -> Option<String> {
        match self {
            Device::Cpu | Device::Reference => None,
            Device::Gpu | Device::Both => adapter().err(),
        }
    }
}

/// Cores of this machine.
pub fn core_count() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// With more than two cores one is left to the window. With fewer that would cost half of the speed and more,
/// and short passes keep the window going as well.
fn threads_of_window() -> Option<usize> {
    let cores = core_count();
    (cores > 2).then(|| cores - 1)
}

/// The numbers of lanes that this processor has kernels for.
pub fn lane_counts() -> Vec<usize> {
    Isa::available().last().map_or_else(Vec::new, |isa| isa.lane_counts().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_device_has_its_backend_and_says_what_is_wrong() {
        let options = DeviceOptions::default();
        for device in Device::ALL {
            let choice = device.backend(&options, None, None);
            assert_eq!((Device::of(&choice), choice.name()), (device, device.name()));
            assert!(device.unavailable().is_none_or(|reason| reason.len() > 10));
        }
        assert!(!lane_counts().is_empty());
    }

    #[test]
    fn the_command_lines_options_are_kept() {
        let cpu =
            CpuOptions { lanes: Some(1), threads: Some(1), low_priority: true, ..CpuOptions::default() };
        let options = DeviceOptions::of(&BackendChoice::Cpu(cpu));
        assert_eq!(Device::Cpu.backend(&options, None, None), BackendChoice::Cpu(cpu));
        let changed = Device::Cpu.backend(&options, Some(4), None);
        assert_eq!(changed, BackendChoice::Cpu(CpuOptions { lanes: Some(4), ..cpu }));
    }
}
