//! Device faults in each phase of a render: the picture still becomes complete, and the user gets a message.

use crate::common::gpu::{gpu, job_of};
use std::time::Duration;
use weekender::backends::BackendChoice;
use weekender::job::render::{RenderJob, SamplerKind};
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest};
use weekender::render_gpu::{Fault, FaultInjection, GpuOptions, InjectionPoint};
use weekender::scene::builtin::BuiltinScene;

fn job(size: [u32; 2]) -> RenderJob {
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    job_of(&scene, camera, size, 8, SamplerKind::Sobol, true)
}

/// A backend that will fail; `None` without an adapter.
fn failing(fault: Fault, point: InjectionPoint, after: u64) -> Option<BackendChoice> {
    let adapter = gpu(GpuOptions::default())?.adapter().name.clone();
    Some(BackendChoice::Gpu(GpuOptions {
        injection: Some(FaultInjection { fault, point, after }),
        patience: Duration::from_millis(300),
        samples_per_dispatch: Some(2),
        ..GpuOptions::of_adapter(Some(&adapter))
    }))
}

fn check(progressive: Progressive, case: &str) {
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples), "{case}: {status:?}");
    let joined = status.messages.join("; ");
    println!("{case}: {joined}");
    assert!(joined.contains("gpu failed") && joined.contains("the CPU continues"), "{case}: {joined}");
    assert!(!case.contains("Hang") || joined.contains("has not responded"), "{case}: {joined}");
    let by_cpu = status.contributions.iter().find(|part| part.backend.name == "cpu");
    assert!(by_cpu.is_some_and(|part| part.samples_per_pixel > 0), "{case}: {status:?}");
    assert_eq!(progressive.take_film().unwrap().samples().to_string(), "0..64", "{case}");
}

#[test]
fn fault_in_any_phase_completes_picture() {
    // A software adapter runs out of memory only when the program does: see tests/gpu/program.rs.
    for fault in [Fault::Lost, Fault::Invalid, Fault::Hang] {
        let points = [
            (InjectionPoint::Prepare, 0),
            (InjectionPoint::Dispatch, 0),
            (InjectionPoint::Dispatch, 5),
            (InjectionPoint::Readback, 0),
            (InjectionPoint::Readback, 1),
        ];
        for (point, after) in points {
            let Some(backend) = failing(fault, point, after) else { return };
            let mut progressive = Progressive::spawn().unwrap();
            progressive.start(RenderRequest::new(job([64, 36]), backend, Plan::samples(64)));
            check(progressive, &format!("{fault:?} at {point:?} {after}"));
        }
    }
}

#[test]
fn fault_during_pause_is_survived() {
    for fault in [Fault::Lost, Fault::Hang] {
        let Some(backend) = failing(fault, InjectionPoint::Readback, 1) else { return };
        let mut progressive = Progressive::spawn().unwrap();
        progressive.start(RenderRequest::new(job([64, 36]), backend, Plan::samples(64)));
        // A pause reads the samples back from the device.
        for _ in 0..3 {
            progressive.pause();
            std::thread::sleep(Duration::from_millis(5));
            progressive.resume();
        }
        check(progressive, &format!("{fault:?} in a pause"));
    }
}

/// As when the window is resized while the device hangs.
#[test]
fn new_job_starts_while_device_hangs() {
    let Some(backend) = failing(Fault::Hang, InjectionPoint::Dispatch, 5) else { return };
    let mut progressive = Progressive::spawn().unwrap();
    for (width, samples) in [(64, 100_000), (50, 100_000), (41, 100_000), (32, 64)] {
        progressive.start(RenderRequest::new(job([width, 20]), backend.clone(), Plan::samples(samples)));
        std::thread::sleep(Duration::from_millis(60));
    }
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples), "{status:?}");
    let film = progressive.take_film().unwrap();
    assert_eq!((film.width(), film.sample_count()), (32, 64));
}
