//! A device that fails in the middle of a render: the CPU completes the picture, and no sample is lost or counted twice.

use crate::common::gpu::{cpu, go_on, gpu, three_spheres};
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use weekender::backends::{self, BackendChoice};
use weekender::film::Film;
use weekender::job::render::{BackendInfo, Control, Outcome, RenderError, RenderJob, Renderer, Stats};
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest};
use weekender::render_gpu::{GpuOptions, GpuRenderer};

/// A call of a renderer; passes are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Prepare,
    Pass(u32),
    Finish,
}

/// A way to break a device.
type Fault = fn(&wgpu::Device);

/// What pulling the plug does.
fn lose(device: &wgpu::Device) {
    device.destroy();
}

fn misuse(device: &wgpu::Device) {
    let usage = wgpu::BufferUsages::empty();
    let _ = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage,
        mapped_at_creation: false,
    });
}

/// A GPU whose device breaks before a call.
struct Breaking {
    gpu: GpuRenderer,
    fault: Fault,
    at: Call,
    passes: u32,
}

impl Breaking {
    fn note(&self, call: Call) {
        if call == self.at {
            (self.fault)(self.gpu.device());
        }
    }
}

impl Renderer for Breaking {
    fn info(&self) -> BackendInfo {
        self.gpu.info()
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.note(Call::Prepare);
        self.gpu.prepare(job, cancel)
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        control: &Control,
    ) -> Result<Outcome, RenderError> {
        self.note(Call::Pass(self.passes));
        self.passes += 1;
        self.gpu.advance(job, range, film, control)
    }

    fn finish(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        self.note(Call::Finish);
        self.gpu.finish(film)
    }
}

fn job() -> RenderJob {
    three_spheres([64, 36], 8)
}

#[test]
fn the_cpu_completes_the_picture_of_a_broken_device() {
    const SAMPLES: u64 = 64;
    let Some(mut whole) = gpu(GpuOptions::default()) else { return };
    for (fault, word) in [(lose as Fault, "lost"), (misuse, "alidation")] {
        for at in [Call::Prepare, Call::Pass(0), Call::Pass(3), Call::Finish] {
            let broken = gpu(GpuOptions { samples_per_dispatch: Some(2), ..GpuOptions::default() }).unwrap();
            let mut broken = Some(Breaking { gpu: broken, fault, at, passes: 0 });
            let factory = move |choice: &BackendChoice| match broken.take() {
                Some(broken) => Ok(Box::new(broken) as Box<dyn Renderer>),
                None => backends::create(choice),
            };
            let mut progressive = Progressive::with_factory(Box::new(factory)).unwrap();
            let backend = BackendChoice::Gpu(GpuOptions::default());
            progressive.start(RenderRequest::new(job(), backend, Plan::samples(SAMPLES)));
            let status = progressive.wait_until_over();
            let case = format!("{word} at {at:?}: {status:?}");
            assert_eq!(status.phase, Phase::Done(EndReason::Samples), "{case}");
            let said = status.messages.join("; ");
            assert!(said.contains("the CPU continues"), "{case}");
            // Before the first pass, wgpu names what could not be made.
            assert!(at == Call::Prepare || said.contains(word), "{case}");
            let by_gpu = status.contributions.iter().find(|part| part.backend.name == "gpu");
            let by_gpu = by_gpu.map_or(0, |part| part.samples_per_pixel);
            let mut expected = job().new_film();
            if by_gpu > 0 {
                whole.accumulate(&job(), 0..by_gpu, &mut expected, &go_on()).unwrap();
            }
            cpu().accumulate(&job(), by_gpu..SAMPLES, &mut expected, &go_on()).unwrap();
            assert!(progressive.take_film() == Some(expected), "{case}");
        }
    }
}
