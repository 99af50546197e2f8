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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};
    use crate::failure::Failure;

    fn request(line: &str) -> Result<Request, Failure> {
        parse(format!("weekender {line}").split(' ').map(Into::into))
    }

    #[test]
    fn the_command_of_a_part_has_the_flags_of_the_backend() {
        for (flags, expected) in [
            ("--simd off", &["--simd=off"][..]),
            ("--device auto --simd auto --isa auto", &[]),
            ("--isa portable --simd 1", &["--simd=off", "--isa=portable"]),
            ("--threads 3 --simd 4", &["--simd=4", "--threads=3"]),
            ("--device cpu,gpu", &["--device=cpu,gpu"]),
            ("--adapter some --device gpu", &["--device=gpu", "--adapter=some"]),
        ] {
            match request(&format!("plan --samples 4 --parts 2 --out no-such-plan {flags}")) {
                Ok(Request::Plan(options)) => assert_eq!(options.flags, expected, "{flags}"),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn any_flag_of_the_backend_chooses_one_for_the_window() {
        for (flags, is_given) in [
            ("--fresh", false),
            ("--device auto --simd auto --isa auto", false),
            ("--vfov 30 --samples 3", false),
            ("--device cpu", true),
            ("--adapter some", true),
            ("--threads 3", true),
            ("--simd 1", true),
            ("--isa portable", true),
        ] {
            match request(flags) {
                Ok(Request::Window(options)) => assert_eq!(options.is_device_given, is_given, "{flags}"),
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_device_gets_the_options_that_are_its_own() {
        let cpu = CpuOptions { threads: Some(3), ..CpuOptions::default() };
        let gpu = GpuOptions::of_adapter(Some("some"));
        for (device, expected) in [
            (RawDevice::Auto, BackendChoice::Gpu(gpu.clone())),
            (RawDevice::Gpu, BackendChoice::Gpu(gpu.clone())),
            (RawDevice::Cpu, BackendChoice::Cpu(cpu)),
            (RawDevice::Both, BackendChoice::Both(cpu, gpu.clone())),
            (RawDevice::Reference, BackendChoice::Reference { threads: Some(3) }),
        ] {
            assert_eq!(choose(device, cpu, gpu.clone(), [None, None]).unwrap(), expected);
        }
        // Without a name of a GPU, the options of the CPU choose that.
        let unnamed = choose(RawDevice::Auto, cpu, GpuOptions::default(), [None, None]).unwrap();
        assert_eq!(unnamed, BackendChoice::Cpu(cpu));
    }

    #[test]
    fn flags_of_another_device_are_refused() {
        let only_gpu = "it applies only to the GPU; leave one of them out";
        let scalar = "the reference is scalar; leave one of them out";
        for (flags, flag, other, reason) in [
            ("--device cpu --adapter some", "--adapter", "cpu", only_gpu),
            ("--device reference --adapter some", "--adapter", "reference", only_gpu),
            ("--device cpu --simulate-invalid-call 2", "--simulate-invalid-call", "cpu", only_gpu),
            ("--device reference --isa portable", "--isa", "reference", scalar),
            ("--device reference --simd 4 --isa portable", "--simd", "reference", scalar),
        ] {
            let told = request(&format!("--batch {flags}")).unwrap_err().to_string();
            assert_eq!(told, format!("error: {flag} cannot be used with --device {other}: {reason}"));
        }
        assert!(request("--batch --device gpu --simd 4").is_ok(), "for the CPU that it may fall back to");
    }
}
