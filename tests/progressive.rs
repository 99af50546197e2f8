//! The progressive render with a renderer that can be told to fail: nothing is lost, whatever happens to it.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use weekender::backends::{BackendChoice, Together};
use weekender::film::{Film, PixelSum};
use weekender::progressive::{
    EndReason, Factory, NOISE_TARGET_FIRST_SAMPLES, Phase, Plan, Progressive, RenderRequest, Stop,
};
use weekender::recipe::Recipe;
use weekender::render::{BackendInfo, RenderError, RenderJob, RenderSettings, Renderer, SamplerKind, Stats};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::{Camera, Scene};
use weekender::stages::Rules;

/// What a sample of the fake takes at least.
const PAUSE: Duration = Duration::from_micros(100);

const PATIENCE: Duration = Duration::from_secs(60);

/// Adds to each pixel a number that depends on pixel and sample alone.
struct Fake {
    name: &'static str,
    pause: Duration,
    fails_at: Option<u64>,
    panics_at: Option<u64>,
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
        assert!(self.panics_at.is_none_or(|at| range.end <= at), "a slip of the tracer");
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
        Ok(Box::new(Fake { name: choice.name(), pause: PAUSE, fails_at, panics_at: None }))
    })
}

const CPU: BackendChoice = BackendChoice::Cpu(CpuOptions {
    isa: None,
    lanes: None,
    threads: None,
    low_priority: false,
    panics_after: None,
});
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
    let mut fake = Fake { name: "alone", pause: Duration::ZERO, fails_at: None, panics_at: None };
    fake.accumulate(&job(2), 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
    film
}

fn started(backend: BackendChoice, plan: Plan) -> Progressive {
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive.start(RenderRequest::new(job(2), backend, plan));
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
        let fake = Fake { name: "cpu", pause: Duration::ZERO, fails_at: Some(8), panics_at: None };
        Ok(Box::new(fake) as Box<dyn Renderer>)
    };
    let mut progressive = Progressive::with_factory(Box::new(fails)).unwrap();
    progressive.start(RenderRequest::new(job(2), other_cpu(), Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("pulled out")), "{status:?}");
    assert_eq!(progressive.finish(), Some(expected(8)));
}

/// The history of a render whose samples take a known time at least.
#[test]
fn a_point_of_the_history_has_the_seconds_of_its_own_samples() {
    let progressive = started(CPU, Plan::samples(128));
    let status = progressive.wait_until_over();
    for point in &status.history {
        let least = PAUSE.as_secs_f64() * point.samples_per_pixel as f64;
        assert!(point.trace_seconds >= least, "{point:?} before {least} s");
    }
    assert_eq!(status.history.last().map(|point| point.trace_seconds), Some(status.trace.as_secs_f64()));
}

#[test]
fn a_panic_keeps_the_film_and_another_backend_goes_on() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        let panics_at = (*choice == CPU).then_some(16);
        Ok(Box::new(Fake { name: choice.name(), pause: PAUSE, fails_at: None, panics_at }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    let [message] = status.messages.as_slice() else { unreachable!("{:?}", status.messages) };
    assert!(message.contains("a slip of the tracer") && message.contains("goes on"), "{message}");
    assert_eq!(progressive.finish(), Some(expected(100)));
}

#[test]
fn a_panic_of_every_backend_leaves_the_film_of_the_last_whole_pass() {
    let asked = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&asked);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        seen.lock().unwrap().push(choice.words());
        Ok(Box::new(Fake { name: choice.name(), pause: PAUSE, fails_at: None, panics_at: Some(16) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("a slip of the tracer")));
    assert_eq!(*asked.lock().unwrap(), ["the CPU", "the CPU's scalar code", "the reference"]);
    assert_eq!(progressive.finish(), Some(expected(16)));
}

#[test]
fn a_panic_while_preparing_or_looking_ends_nothing() {
    let mut is_first = true;
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        assert!(!std::mem::take(&mut is_first), "no such backend");
        Ok(Box::new(Fake { name: choice.name(), pause: PAUSE, fails_at: None, panics_at: None }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(2000)));
    wait_for(&progressive, 8);
    progressive.inspect(|_| unreachable!("a slip of the onlooker"));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    let said = status.messages.join("; ");
    assert!(said.contains("no such backend") && said.contains("a slip of the onlooker"), "{said}");
    assert_eq!(progressive.finish(), Some(expected(2000)));
}

/// Records what it has not added.
struct Forgetful;

impl Renderer for Forgetful {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "cpu", device: "fake".into(), lanes: 1, threads: 1 }
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        _: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        Ok(Stats::default())
    }
}

#[test]
fn samples_that_were_asked_for_and_not_added_are_missed() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        let fake = Fake { name: choice.name(), pause: Duration::ZERO, fails_at: None, panics_at: None };
        Ok(if *choice == CPU { Box::new(Forgetful) as Box<dyn Renderer> } else { Box::new(fake) })
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(64)));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert!(status.messages.iter().any(|said| said.contains("of 64 samples")), "{:?}", status.messages);
    assert_eq!(progressive.finish(), Some(expected(64)));
}

#[test]
fn a_member_that_panics_leaves_its_samples_to_the_others() {
    let fake = |name, panics_at| -> Box<dyn Renderer> {
        Box::new(Fake { name, pause: PAUSE, fails_at: None, panics_at })
    };
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", Some(4))]);
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    assert!(film == expected(64));
    let said = together.take_messages().join("; ");
    assert!(said.contains("a slip of the tracer") && said.contains("cpu goes on"), "{said}");
}

/// The tracer itself, which panics in the middle of a tile.
#[test]
fn a_panic_in_a_tile_leaves_the_film_as_it_was() {
    let recipe = Recipe::find("three-spheres").unwrap();
    for (half_count, estimate_error) in [(1, false), (2, true)] {
        let size = RenderSettings { width: 100, height: 70, estimate_error, ..recipe.settings };
        let job = recipe.job().unwrap().seen_by(*recipe.job().unwrap().camera(), size).unwrap();
        let never = AtomicBool::new(false);
        let mut film = job.new_film();
        assert_eq!(film.halves().len(), half_count);
        CpuRenderer::new(CpuOptions::default()).unwrap().accumulate(&job, 0..6, &mut film, &never).unwrap();
        let before = film.clone();
        let options = CpuOptions { panics_after: Some(3), threads: Some(2), ..CpuOptions::default() };
        let mut renderer = CpuRenderer::new(options).unwrap();
        let error = renderer.accumulate(&job, 6..40, &mut film, &never).unwrap_err();
        println!("{error}");
        assert!(matches!(error, RenderError::Backend { backend: "cpu", .. }), "{error}");
        assert!(error.to_string().contains("panicked") && error.to_string().contains("blocks"), "{error}");
        assert!(film == before);
        // It was one slip.
        renderer.accumulate(&job, 6..40, &mut film, &never).unwrap();
        let mut whole = job.new_film();
        CpuRenderer::new(CpuOptions::default()).unwrap().accumulate(&job, 0..40, &mut whole, &never).unwrap();
        assert!(film == whole);
    }
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
    for limit in [1e-9, 0.1] {
        let progressive = started(CPU, Plan::until(Stop { seconds: Some(limit), ..Stop::default() }));
        let status = progressive.wait_until_over();
        assert_eq!(status.phase, Phase::Done(EndReason::TimeLimit));
        assert!(status.samples_per_pixel >= 2 && status.elapsed < Duration::from_secs(5), "{status:?}");
        assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
    }
}

#[test]
fn the_noise_target_ends_it() {
    let target = expected(64).error().unwrap().rmse;
    let progressive = started(CPU, Plan::until(Stop { noise: Some(target), ..Stop::default() }));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert!(status.error.unwrap().rmse <= target);
    assert_eq!(status.error, progressive.finish().unwrap().error());
}

/// A target that the first samples meet: their estimate is too rough to be trusted.
#[test]
fn a_noise_target_is_not_looked_at_before_its_first_samples() {
    let progressive =
        started(CPU, Plan { stop: Stop { noise: Some(1e9), ..Stop::default() }, ..Plan::endless() });
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert_eq!((status.samples_per_pixel, NOISE_TARGET_FIRST_SAMPLES), (16, 16));
}

/// Keeps samples to itself until they are collected, as a graphics device does.
struct Holding {
    fake: Fake,
    held: Vec<Range<u64>>,
    traced: Arc<Mutex<u64>>,
}

impl Renderer for Holding {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        self.held.clear();
        Ok(())
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.fake.accumulate(job, range, film, cancel)
    }

    fn advance(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        std::thread::sleep(PAUSE);
        *self.traced.lock().unwrap() += range.end - range.start;
        self.held.push(range);
        Ok(Stats::default())
    }

    fn collect(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let mut stats = Stats::default();
        for range in std::mem::take(&mut self.held) {
            stats.add(&self.fake.accumulate(&job(2), range, film, &AtomicBool::new(false))?);
        }
        Ok(stats)
    }
}

#[test]
fn a_pause_brings_home_what_the_device_holds() {
    let traced = Arc::new(Mutex::new(0));
    let count = Arc::clone(&traced);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let fake = Fake { name: choice.name(), pause: Duration::ZERO, fails_at: None, panics_at: None };
        Ok(Box::new(Holding { fake, held: Vec::new(), traced: Arc::clone(&count) }))
    }));
    let mut progressive = progressive.unwrap();
    // Passes stay short enough for the samples to be added up while they are waited for.
    let plan = Plan { pass_target: PAUSE, ..Plan::endless() };
    progressive.start(RenderRequest::new(job(2), CPU, plan));
    for more in [64, 512] {
        let begin = std::time::Instant::now();
        let first = *traced.lock().unwrap();
        while *traced.lock().unwrap() < first + more {
            assert!(begin.elapsed() < PATIENCE, "stuck: {:?}", progressive.status());
            std::thread::sleep(PAUSE);
        }
        progressive.pause();
        while progressive.wait(Duration::from_millis(20)).phase != Phase::Paused {
            assert!(begin.elapsed() < PATIENCE, "no pause: {:?}", progressive.status());
        }
        // All that was traced is in the film, and is told.
        let held = *traced.lock().unwrap();
        let status = progressive.status();
        assert_eq!((status.samples_per_pixel, status.stats.paths), (held, 4 * held));
        progressive.resume();
    }
    progressive.stop();
    let status = progressive.wait_until_over();
    let held = *traced.lock().unwrap();
    assert_eq!(status.samples_per_pixel, held);
    assert_eq!(progressive.finish(), Some(expected(held)));
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
    assert_eq!(progressive.status().planned_samples_per_pixel, 2100);
    assert_eq!(progressive.finish(), Some(expected(2100)));
}

#[test]
fn a_new_job_takes_over_in_the_middle_of_a_pass() {
    let mut progressive = Progressive::with_factory(Box::new(|_| {
        let pause = Duration::from_millis(1);
        Ok(Box::new(Fake { name: "cpu", pause, fails_at: None, panics_at: None }))
    }))
    .unwrap();
    progressive.start(RenderRequest::new(job(7), CPU, Plan { pass_target: PATIENCE, ..Plan::endless() }));
    wait_for(&progressive, 16);
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(4)));
    let status = progressive.wait_until_over();
    assert_eq!((status.run, status.samples_per_pixel), (2, 4));
    assert_eq!(progressive.finish(), Some(expected(4)));
}

#[test]
fn a_film_goes_on_where_it_has_gaps() {
    let mut film = job(2).new_film();
    let mut fake = Fake { name: "before", pause: Duration::ZERO, fails_at: None, panics_at: None };
    for range in [3..5, 10..30] {
        fake.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
    }
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive
        .start(RenderRequest { film: Some(film), ..RenderRequest::new(job(2), CPU, Plan::samples(100)) });
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.stats.paths), (100, (100 - 22) * 4));
    // The history is that of this render: what the film held before has no seconds.
    let history: Vec<u64> = status.history.iter().map(|point| point.samples_per_pixel).collect();
    assert!(history.first().is_some_and(|first| (32..40).contains(first)), "{history:?}");
    assert!(status.history.iter().all(|point| point.trace_seconds > 0.0), "{:?}", status.history);
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
