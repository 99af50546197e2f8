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

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Device")]
pub struct BackendFlags {
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
    /// The backend that these flags choose.
    ///
    /// # Errors
    /// If a flag applies to another kind of device.
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
    use crate::cli::tests::{batch, refused};

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
            assert_eq!(batch(flags).backend, expected, "{flags}");
        }
        batch("--device gpu --simd 4"); // for the CPU that it may fall back to
        for (flag, device) in
            [("--adapter some", "cpu"), ("--adapter some", "reference"), ("--simd 4", "reference")]
        {
            let error = refused(&format!("--batch --device {device} {flag}"));
            assert!(error.contains(&flag[..6]) && error.contains(device), "{error}");
        }
    }
}
