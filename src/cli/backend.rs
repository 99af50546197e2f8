//! The flags that choose a backend.

use super::error::CliError;
use super::raw::{RawBackend, RawDevice};
use super::values::{Level, Simd};
use crate::backends::BackendChoice;
use crate::render_cpu::CpuOptions;
use crate::render_gpu::{Fault, FaultInjection, GpuOptions, InjectionPoint};
use clap::ValueEnum;

/// Whether any flag chooses the backend.
pub(super) fn is_given(raw: &RawBackend) -> bool {
    raw.device != RawDevice::Auto
        || raw.threads.is_some()
        || raw.adapter.is_some()
        || (raw.simd, raw.isa) != (Simd(None), Level(None))
}

/// The flags as words, for the command of a part.
pub(super) fn words(raw: &RawBackend) -> Vec<String> {
    let device = (raw.device != RawDevice::Auto).then(|| raw.device.to_possible_value()).flatten();
    let simd = match raw.simd {
        Simd(Some(1)) => Some("off".to_owned()),
        Simd(lanes) => lanes.map(|lanes| lanes.to_string()),
    };
    let Level(isa) = raw.isa;
    let values = [
        ("--device", device.map(|device| device.get_name().to_owned())),
        ("--adapter", raw.adapter.clone()),
        ("--simd", simd),
        ("--isa", isa.map(|isa| isa.name().to_owned())),
        ("--threads", raw.threads.map(|threads| threads.to_string())),
    ];
    let given = values.into_iter().filter_map(|(flag, value)| Some(format!("{flag}={}", value?)));
    given.collect()
}

/// The backend that the flags choose.
pub(super) fn choice(raw: &RawBackend) -> Result<BackendChoice, CliError> {
    let (Simd(lanes), Level(isa)) = (raw.simd, raw.isa);
    let threads = raw.threads.and_then(|threads| usize::try_from(threads).ok());
    let cpu = CpuOptions { isa, lanes, threads, panics_after: raw.simulate_panic, ..CpuOptions::default() };
    let injections = [
        (raw.simulate_device_lost, Fault::Lost, "--simulate-device-lost"),
        (raw.simulate_out_of_memory, Fault::OutOfMemory, "--simulate-out-of-memory"),
        (raw.simulate_invalid_call, Fault::Invalid, "--simulate-invalid-call"),
        (raw.simulate_hang, Fault::Hang, "--simulate-hang"),
    ];
    let point = InjectionPoint::Dispatch;
    let injection = injections
        .into_iter()
        .find_map(|(after, fault, flag)| after.map(|after| (FaultInjection { fault, point, after }, flag)));
    let gpu = GpuOptions {
        injection: injection.map(|(injection, _)| injection),
        ..GpuOptions::of_adapter(raw.adapter.as_deref())
    };
    let gpu_flag = if raw.adapter.is_some() { Some("--adapter") } else { injection.map(|(_, flag)| flag) };
    let cpu_flag = match (lanes, isa) {
        (Some(_), _) => Some("--simd"),
        (None, Some(_)) => Some("--isa"),
        (None, None) => None,
    };
    choose(raw.device, cpu, gpu, [cpu_flag, gpu_flag])
}

/// The backend of `device`. The flags are those that only the CPU's packets or only the GPU understand, if any is given.
pub(super) fn choose(
    device: RawDevice,
    cpu: CpuOptions,
    gpu: GpuOptions,
    [cpu_flag, gpu_flag]: [Option<&'static str>; 2],
) -> Result<BackendChoice, CliError> {
    if let (Some(flag), RawDevice::Cpu | RawDevice::Reference) = (gpu_flag, device) {
        let other = if device == RawDevice::Cpu { "--device cpu" } else { "--device reference" };
        return Err(CliError::Together {
            flag,
            other,
            reason: "it applies only to the GPU; leave one of them out",
        });
    }
    match (device, cpu_flag) {
        (RawDevice::Auto, _) if gpu.adapter.is_some() => Ok(BackendChoice::Gpu(gpu)),
        (RawDevice::Auto, _) => Ok(BackendChoice::auto(cpu, gpu)),
        (RawDevice::Cpu, _) => Ok(BackendChoice::Cpu(cpu)),
        (RawDevice::Gpu, _) => Ok(BackendChoice::Gpu(gpu)),
        (RawDevice::Both, _) => Ok(BackendChoice::Both(cpu, gpu)),
        (RawDevice::Reference, Some(flag)) => Err(CliError::Together {
            flag,
            other: "--device reference",
            reason: "the reference is scalar; leave one of them out",
        }),
        (RawDevice::Reference, None) => Ok(BackendChoice::Reference { threads: cpu.threads }),
    }
}
