//! The progressive render with a renderer that can be told to fail: nothing is lost, whatever happens to it.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use weekender::backends::BackendChoice;
use weekender::film::{Film, PixelSum};
use weekender::progressive::{EndReason, Factory, Phase, Plan, Progressive, Work};
use weekender::render::{BackendInfo, RenderError, RenderJob, RenderSettings, Renderer, SamplerKind, Stats};
use weekender::render_cpu::CpuOptions;
use weekender::scene::{Camera, Scene};
use weekender::stages::Rules;

const PATIENCE: Duration = Duration::from_secs(60);

/// Adds to each pixel a number that depends on pixel and sample alone.
struct Fake {
    name: &'static str,
    pause: Duration,
    fails_at: Option<u64>,
}

fn sample(pixel: usize, index: u64) -> PixelSum {
    let mixed = (pixel as u64 * 0x9E37_79B9 + index).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 40;
    PixelSum([mixed, mixed / 2, mixed / 3])
}

impl Renderer for Fake {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: self.name, device: "fake".into(), lanes: 1, threads: 1 }
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        if self.fails_at.is_some_and(|at| range.end > at) {
            return Err(RenderError::Backend { backend: self.name, reason: "pulled out".into() });
        }
        for index in range.clone() {
            if cancel.load(Ordering::Relaxed) {
                return Err(RenderError::Cancelled);
            }
            std::thread::sleep(self.pause);
            let half_count = film.halves().len();
            let half = &mut film.halves_mut()[index as usize % half_count];
            half.iter_mut().enumerate().for_each(|(pixel, sum)| sum.add(sample(pixel, index)));
        }
        let samples = range.end - range.start;
        film.record(range, 0)?;
        Ok(Stats { paths: samples * 4, rays: samples * 8, ..Stats::default() })
    }
}

/// The reference of these tests fails past sample 16, every CPU backend works.
fn factory() -> Factory {
    Box::new(|choice| {
        let fails_at = matches!(choice, BackendChoice::Reference { .. }).then_some(16);
        Ok(Box::new(Fake { name: choice.name(), pause: Duration::from_micros(100), fails_at }))
    })
}

const CPU: BackendChoice =
    BackendChoice::Cpu(CpuOptions { isa: None, lanes: None, threads: None, gives_way: false });
const FAILING: BackendChoice = BackendChoice::Reference { threads: None };

fn other_cpu() -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { lanes: Some(1), ..CpuOptions::default() })
}

fn job(width: u32) -> RenderJob {
    let settings = RenderSettings {
        width,
        height: 2,
        max_depth: 5,
        sampler: SamplerKind::Sobol,
        seed: 0,
        estimate_error: true,
    };
    RenderJob::new(Scene::default(), Camera::default(), settings, Rules::default()).unwrap()
}

fn expected(samples: u64) -> Film {
    let mut film = job(2).new_film();
    let mut fake = Fake { name: "alone", pause: Duration::ZERO, fails_at: None };
    fake.accumulate(&job(2), 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
    film
}

fn started(backend: BackendChoice, plan: Plan) -> Progressive {
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive.start(Work::new(job(2), backend, plan));
    progressive
}

fn wait_for(progressive: &Progressive, samples: u64) {
    let begin = std::time::Instant::now();
    while progressive.wait(Duration::from_millis(20)).samples_per_pixel < samples {
        assert!(begin.elapsed() < PATIENCE, "stuck: {:?}", progressive.status());
    }
}

#[test]
fn a_plan_of_samples_is_met_exactly() {
    let progressive = started(CPU, Plan::samples(200));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert_eq!((status.samples_per_pixel, status.stats.paths), (200, 800));
    let history: Vec<u64> = status.history.iter().map(|point| point.samples_per_pixel).collect();
    assert_eq!(history, [2, 4, 8, 16, 32, 64, 128]);
    assert_eq!(progressive.finish(), Some(expected(200)));
}

#[test]
fn a_failing_backend_hands_its_film_to_the_cpu() {
    let progressive = started(FAILING, Plan::samples(100));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert_eq!(status.messages.len(), 1, "{:?}", status.messages);
    assert!(status.messages[0].contains("pulled out"));
    let parts: Vec<_> = status.contributions.iter().map(|c| (c.backend.name, c.samples_per_pixel)).collect();
    assert_eq!(parts, [("reference", 16), ("cpu", 84)]);
    assert_eq!(progressive.finish(), Some(expected(100)));
}

#[test]
fn a_failing_fallback_ends_with_what_there_is() {
    let fails = |_: &BackendChoice| {
        let fake = Fake { name: "cpu", pause: Duration::ZERO, fails_at: Some(8) };
        Ok(Box::new(fake) as Box<dyn Renderer>)
    };
    let mut progressive = Progressive::with_factory(Box::new(fails)).unwrap();
    progressive.start(Work::new(job(2), other_cpu(), Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("pulled out")), "{status:?}");
    assert_eq!(progressive.finish(), Some(expected(8)));
}

#[test]
fn another_backend_goes_on_with_the_same_film() {
    let progressive = started(CPU, Plan::samples(3000));
    for (backend, at) in [(other_cpu(), 4), (CPU, 100), (FAILING, 500), (other_cpu(), 600)] {
        wait_for(&progressive, at);
        progressive.switch_backend(backend);
    }
    let status = progressive.wait_until_over();
    assert_eq!(status.contributions.iter().map(|c| c.samples_per_pixel).sum::<u64>(), 3000);
    assert_eq!(progressive.finish(), Some(expected(3000)));
}

#[test]
fn pauses_lose_nothing() {
    let progressive = started(CPU, Plan::samples(1000));
    for at in [2, 10, 300] {
        wait_for(&progressive, at);
        progressive.pause();
        while progressive.wait(Duration::from_millis(20)).phase == Phase::Tracing {}
        let held = progressive.status().samples_per_pixel;
        std::thread::sleep(Duration::from_millis(30));
        assert_eq!(progressive.status().samples_per_pixel, held);
        progressive.resume();
    }
    progressive.wait_until_over();
    assert_eq!(progressive.finish(), Some(expected(1000)));
}

#[test]
fn the_time_limit_ends_it_with_at_least_one_pass() {
    for limit in [Duration::from_nanos(1), Duration::from_millis(100)] {
        let progressive = started(CPU, Plan { time_limit: Some(limit), ..Plan::endless() });
        let status = progressive.wait_until_over();
        assert_eq!(status.phase, Phase::Done(EndReason::TimeLimit));
        assert!(status.samples_per_pixel >= 2 && status.elapsed < Duration::from_secs(5), "{status:?}");
        assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
    }
}

#[test]
fn the_noise_target_ends_it() {
    let target = expected(64).error().unwrap().rmse;
    let progressive = started(CPU, Plan { noise_target: Some(target), ..Plan::endless() });
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert!(status.error.unwrap().rmse <= target);
    assert_eq!(status.error, progressive.finish().unwrap().error());
}

#[test]
fn a_stop_keeps_the_film_and_can_be_taken_back() {
    let progressive = started(CPU, Plan::samples(2000));
    wait_for(&progressive, 8);
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    progressive.resume();
    while progressive.status().phase != Phase::Done(EndReason::Samples) {
        progressive.wait(Duration::from_millis(20));
    }
    progressive.set_plan(Plan::samples(2100));
    wait_for(&progressive, 2100);
    assert_eq!(progressive.finish(), Some(expected(2100)));
}

#[test]
fn a_new_job_takes_over_in_the_middle_of_a_pass() {
    let mut progressive = Progressive::with_factory(Box::new(|_| {
        Ok(Box::new(Fake { name: "cpu", pause: Duration::from_millis(1), fails_at: None }))
    }))
    .unwrap();
    progressive.start(Work::new(job(7), CPU, Plan { pass_target: PATIENCE, ..Plan::endless() }));
    wait_for(&progressive, 16);
    progressive.start(Work::new(job(2), CPU, Plan::samples(4)));
    let status = progressive.wait_until_over();
    assert_eq!((status.run, status.samples_per_pixel), (2, 4));
    assert_eq!(progressive.finish(), Some(expected(4)));
}

#[test]
fn a_film_goes_on_where_it_has_gaps() {
    let mut film = job(2).new_film();
    let mut fake = Fake { name: "before", pause: Duration::ZERO, fails_at: None };
    for range in [3..5, 10..30] {
        fake.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
    }
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive.start(Work { film: Some(film), ..Work::new(job(2), CPU, Plan::samples(100)) });
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.stats.paths), (100, (100 - 22) * 4));
    assert_eq!(progressive.finish(), Some(expected(100)));
}

#[test]
fn pictures_come_when_asked_for_and_films_can_be_looked_at() {
    let progressive = started(CPU, Plan::samples(64));
    progressive.wait_until_over();
    assert_eq!(progressive.take_picture(), None);
    let begin = std::time::Instant::now();
    let picture = loop {
        if let Some(picture) = progressive.take_picture() {
            break picture;
        }
        assert!(begin.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(1));
    };
    assert_eq!(
        (picture.width, picture.height, picture.samples_per_pixel, picture.rgb8.len()),
        (2, 2, 64, 12)
    );
    let (sender, receiver) = std::sync::mpsc::channel();
    progressive.inspect(move |film| sender.send(film.clone()).unwrap());
    assert_eq!(receiver.recv_timeout(PATIENCE).unwrap(), expected(64));
}

#[test]
fn abandoned_work_leaves_nothing() {
    let mut progressive = started(CPU, Plan::endless());
    wait_for(&progressive, 2);
    progressive.abandon();
    assert_eq!(progressive.wait_until_over().phase, Phase::Idle);
    assert_eq!(progressive.finish(), None);
}
