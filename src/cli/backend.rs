//! The flags that choose a backend.

use super::values::{Auto, parse_isa, parse_simd, whole};
use crate::backends::BackendChoice;
use crate::render_cpu::{CpuOptions, Isa};
use crate::render_gpu::GpuOptions;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Device {
    Auto,
    Cpu,
    Gpu,
    Reference,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Device")]
pub(super) struct BackendFlags {
    /// What renders; auto: the fastest available
    #[arg(long, value_enum, default_value = "auto")]
    device: Device,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Lanes of the CPU's packets: auto, off (1), 4, 8, 16
    #[arg(long, value_name = "LANES", value_parser = parse_simd, default_value = "auto")]
    simd: Auto<usize>,
    /// Instruction level of the CPU, for tests and benchmarks: auto, portable, sse4.2, avx2, avx512, neon, simd128
    #[arg(long, value_name = "LEVEL", value_parser = parse_isa, default_value = "auto")]
    isa: Auto<Isa>,
    /// CPU threads, 1 to 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = whole::<usize>(1..=1024))]
    threads: Option<usize>,
}

impl BackendFlags {
    pub fn choice(&self) -> Result<BackendChoice> {
        let (isa, lanes, threads) = (self.isa, self.simd, self.threads);
        let cpu = CpuOptions { isa, lanes, threads, ..CpuOptions::default() };
        let gpu = GpuOptions::of_adapter(self.adapter.as_deref());
        // Flags that only one kind of device understands.
        let (for_gpu, for_packets) = (gpu.adapter.is_some(), lanes.is_some() || isa.is_some());
        let device =
            self.device.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
        let refuse = |flags: &str, limit: &str| {
            bail!("{flags} cannot be used with --device {device}: {limit}; leave one of them out")
        };
        match self.device {
            Device::Cpu | Device::Reference if for_gpu => refuse("--adapter", "it applies only to the GPU"),
            Device::Reference if for_packets => refuse("--simd or --isa", "the reference is scalar"),
            Device::Reference => Ok(BackendChoice::Reference { threads }),
            Device::Cpu => Ok(BackendChoice::Cpu(cpu)),
            Device::Auto if gpu.adapter.is_none() => Ok(BackendChoice::auto(cpu, gpu)),
            Device::Auto | Device::Gpu => Ok(BackendChoice::Gpu(gpu)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};

    fn backend(flags: &str) -> std::result::Result<BackendChoice, String> {
        match parse(format!("weekender --batch {flags}").split(' ').map(Into::into)) {
            Ok(Request::Batch(options)) => Ok(options.backend),
            other => Err(other.unwrap_err().to_string()),
        }
    }

    #[test]
    fn each_device_gets_only_its_own_options() {
        let cpu = CpuOptions { threads: Some(3), ..CpuOptions::default() };
        let gpu = || GpuOptions::of_adapter(Some("some"));
        for (flags, expected) in [
            ("--adapter some", BackendChoice::Gpu(gpu())),
            ("--device gpu --adapter some --threads 3", BackendChoice::Gpu(gpu())),
            ("--device cpu --threads 3", BackendChoice::Cpu(cpu)),
            ("--device reference --threads 3", BackendChoice::Reference { threads: Some(3) }),
        ] {
            assert_eq!(backend(flags), Ok(expected), "{flags}");
        }
    }

    #[test]
    fn flags_of_other_devices_are_refused() {
        for (flags, parts) in [
            ("--device cpu --adapter some", ["--adapter", "the GPU"]),
            ("--device reference --adapter some", ["--adapter", "the GPU"]),
            ("--device reference --isa portable", ["--isa", "reference"]),
            ("--device reference --simd 4", ["--simd", "reference"]),
        ] {
            let error = backend(flags).unwrap_err();
            assert!(parts.iter().all(|part| error.contains(part)), "{error}");
        }
        assert!(backend("--device gpu --simd 4").is_ok(), "for the CPU that it may fall back to");
    }
}
