//! Films, pictures and samples that pass between render, renderer and user.

use super::common::{
    CPU, FAILING, Fake, Holding, PATIENCE, PAUSE, expected, factory, job, other_cpu, started, wait_for,
};
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use weekender::film::Film;
use weekender::progressive::{Phase, Plan, Progressive, RenderRequest};
use weekender::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};

/// The history of a render whose samples take at least a known time.
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

/// A user changes their mind while the other backend is still being made.
#[test]
fn switching_back_calls_the_switch_off() {
    let (made, is_made) = std::sync::mpsc::channel();
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        if *choice != CPU {
            std::thread::sleep(Duration::from_millis(50));
            made.send(()).unwrap();
        }
        Ok(Box::new(Fake::new(choice.name())))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 2);
    progressive.switch_backend(FAILING);
    progressive.switch_backend(CPU);
    is_made.recv_timeout(PATIENCE).unwrap();
    let samples = progressive.status().samples_per_pixel;
    wait_for(&progressive, samples + 2000);
    let status = progressive.status();
    let at_work: Vec<&str> = status.contributions.iter().map(|part| part.backend.name).collect();
    assert_eq!(at_work, [CPU.name()]);
}

#[test]
fn a_pause_brings_home_what_the_device_holds() {
    let traced = Arc::new(Mutex::new(0));
    let count = Arc::clone(&traced);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let fake = Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) };
        let count = Arc::clone(&count);
        let add = move |range: &Range<u64>, _| *count.lock().unwrap() += range.end - range.start;
        Ok(Box::new(Holding::new(fake, u32::MAX, add)))
    }));
    let mut progressive = progressive.unwrap();
    // With short passes, samples accumulate while the test waits.
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
        // All traced samples are in the film and are reported.
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
fn a_film_goes_on_where_it_has_gaps() {
    let mut film = job(2).new_film();
    let mut fake = Fake { pause: Duration::ZERO, ..Fake::new("before") };
    for range in [3..5, 10..30] {
        fake.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
    }
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive
        .start(RenderRequest { film: Some(film), ..RenderRequest::new(job(2), CPU, Plan::samples(100)) });
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.stats.paths), (100, (100 - 22) * 4));
    // The history covers only this render, since the film's earlier samples have no times.
    let history: Vec<u64> = status.history.iter().map(|point| point.samples_per_pixel).collect();
    assert!(history.first().is_some_and(|first| (32..40).contains(first)), "{history:?}");
    assert!(status.history.iter().all(|point| point.trace_seconds > 0.0), "{:?}", status.history);
    assert_eq!(progressive.finish(), Some(expected(100)));
}

/// A point for each power of two that the film's samples have passed, even where they never are one.
#[test]
fn the_history_of_a_film_with_other_samples_misses_no_power_of_two() {
    let mut film = job(2).new_film();
    let mut fake = Fake { pause: Duration::ZERO, ..Fake::new("before") };
    fake.accumulate(&job(2), 1000..1003, &mut film, &AtomicBool::new(false)).unwrap();
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive
        .start(RenderRequest { film: Some(film), ..RenderRequest::new(job(2), CPU, Plan::samples(128)) });
    let status = progressive.wait_until_over();
    let history: Vec<u64> = status.history.iter().map(|point| point.samples_per_pixel).collect();
    // The passes end at 2, 4, 8 ... of the plan, to which the film has 3 more.
    assert_eq!(history, [5, 11, 19, 35, 67, 131]);
}

/// A film that has samples before, in and behind those of the plan.
#[test]
fn what_is_planned_counts_the_samples_that_the_film_has_elsewhere() {
    let mut film = job(2).new_film();
    let mut fake = Fake { pause: Duration::ZERO, ..Fake::new("before") };
    for range in [0..3, 12..14, 1000..1010] {
        fake.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
    }
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    let plan = Plan { first_sample: 8, ..Plan::samples(20) };
    progressive.start(RenderRequest { film: Some(film), ..RenderRequest::new(job(2), CPU, plan) });
    let status = progressive.wait_until_over();
    // Ten of the twelve samples 8..20 are new, and thirteen others stay.
    assert_eq!((status.planned_samples_per_pixel, status.samples_per_pixel), (25, 25));
    assert_eq!(status.contributions.iter().map(|part| part.samples_per_pixel).sum::<u64>(), 10);
    // A longer plan begins where the first one did.
    progressive.set_plan(Plan { first_sample: 8, ..Plan::samples(30) });
    wait_for(&progressive, 35);
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.samples_per_pixel), (35, 35));
    let film = progressive.finish().unwrap();
    assert_eq!(film.samples().to_string(), "0..3, 8..30, 1000..1010");
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

/// Notes how many samples its passes have.
struct Noting {
    fake: Fake,
    passes: Arc<Mutex<Vec<u64>>>,
}

impl Renderer for Noting {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.fake.prepare(job, cancel)
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.passes.lock().unwrap().push(range.end - range.start);
        self.fake.accumulate(job, range, film, cancel)
    }
}

#[test]
fn the_history_has_each_power_of_two_once() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        // Passes stay at two samples.
        Ok(Box::new(Fake { pause: Plan::INTERACTIVE_PASS / 2, ..Fake::new(choice.name()) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(12)));
    let history = progressive.wait_until_over().history;
    let samples: Vec<u64> = history.iter().map(|point| point.samples_per_pixel).collect();
    assert_eq!(samples, [2, 4, 8]);
}

#[test]
fn after_a_failure_passes_are_short_again() {
    let passes = Arc::new(Mutex::new(Vec::new()));
    let noted = Arc::clone(&passes);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        if *choice == FAILING {
            let pause = Duration::ZERO;
            return Ok(Box::new(Fake { pause, fails_at: Some(1024), ..Fake::new(choice.name()) }));
        }
        Ok(Box::new(Noting { fake: Fake::new(choice.name()), passes: Arc::clone(&noted) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), FAILING, Plan::samples(2048)));
    assert_eq!(progressive.wait_until_over().samples_per_pixel, 2048);
    assert_eq!(passes.lock().unwrap()[0], 2);
}

/// A pass of many samples by a fast backend can take a slow one minutes.
#[test]
fn another_backend_begins_with_short_passes() {
    let passes = Arc::new(Mutex::new(Vec::new()));
    let noted = Arc::clone(&passes);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let pause = if *choice == CPU { Duration::ZERO } else { PAUSE };
        let fake = Fake { pause, ..Fake::new(choice.name()) };
        if *choice == CPU {
            return Ok(Box::new(fake));
        }
        Ok(Box::new(Noting { fake, passes: Arc::clone(&noted) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 4096);
    progressive.switch_backend(other_cpu());
    let begin = std::time::Instant::now();
    while passes.lock().unwrap().len() < 4 {
        assert!(begin.elapsed() < PATIENCE, "stuck: {:?}", progressive.status());
        std::thread::sleep(PAUSE);
    }
    progressive.finish();
    let passes = passes.lock().unwrap();
    assert_eq!(passes[0], 2, "{passes:?}");
    assert!(passes.windows(2).all(|pair| pair[1] <= 2 * pair[0]), "{passes:?}");
}
