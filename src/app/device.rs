//! Who traces, as the window offers it.

use crate::backends::BackendChoice;
use crate::render_cpu::{CpuOptions, Isa};
use serde::{Deserialize, Serialize};

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
            Device::Both => "both",
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

    /// The device of a backend.
    pub fn of(choice: &BackendChoice) -> Self {
        match choice {
            BackendChoice::Cpu(_) => Device::Cpu,
            BackendChoice::Reference { .. } => Device::Reference,
        }
    }

    /// The backend that stands for it.
    ///
    /// # Errors
    /// Why it cannot be had, in words.
    pub fn backend(self, lanes: Option<usize>, threads: Option<usize>) -> Result<BackendChoice, String> {
        let threads = threads.or_else(threads_of_window);
        match self {
            Device::Cpu => Ok(BackendChoice::Cpu(CpuOptions { isa: None, lanes, threads })),
            Device::Reference => Ok(BackendChoice::Reference { threads }),
            Device::Gpu => Err("This build has no GPU backend".to_owned()),
            Device::Both => Err("This build has no GPU backend to share the work with".to_owned()),
        }
    }

    /// Why it cannot be had.
    pub fn unavailable(self) -> Option<String> {
        self.backend(None, None).err()
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
    fn every_device_is_there_or_says_why_not() {
        for device in Device::ALL {
            match device.backend(None, None) {
                Ok(choice) => assert_eq!((Device::of(&choice), choice.name()), (device, device.name())),
                Err(reason) => assert!(reason.len() > 10),
            }
        }
        assert!(!lane_counts().is_empty());
    }
}
