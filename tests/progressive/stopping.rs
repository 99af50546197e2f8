//! What ends a render, pauses it, or starts another.

use super::common::{CPU, Fake, PATIENCE, expected, job, started, wait_for, wait_until};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};
use weekender::backends::{BackendChoice, BackendError};
use weekender::film::{Film, PixelSum};
use weekender::progressive::{
    EndReason, NOISE_TARGET_FIRST_SAMPLES, Phase, Plan, Progressive, RenderRequest, Status, Stop,
};
use weekender::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};

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

/// The samples in the film at the end of each pass that reaches another power of two.
fn history(trial: Option<[Duration; 2]>, plan: Plan) -> Vec<u64> {
    let factory = move |choice: &BackendChoice| -> Result<Box<dyn Renderer>, BackendError> {
        Ok(Box::new(Fake { trial, pause: Duration::ZERO, ..Fake::new(choice.name()) }))
    };
    let mut progressive = Progressive::with_factory(Box::new(factory)).unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, plan));
    let status = progressive.wait_until_over();
    assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
    status.history.iter().map(|point| point.samples_per_pixel).collect()
}

#[test]
fn the_first_pass_is_as_long_as_the_others_where_nobody_watches() {
    let trial = |milliseconds| Some([Duration::from_millis(milliseconds); 2]);
    let batch = |stop| Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(stop) };
    let samples = batch(Stop::at_samples(200));
    let doubling = [2, 4, 8, 16, 32, 64, 128];
    // 900 ms have room for 900, 90 and 9 samples, and for less than the two that a pass has at least.
    assert_eq!(history(trial(1), samples.clone()), [128]);
    assert_eq!(history(trial(10), samples.clone()), [64, 128]);
    assert_eq!(history(trial(100), samples.clone()), [8, 16, 32, 64, 128]);
    assert_eq!(history(trial(10_000), samples.clone()), doubling);
    assert_eq!(history(Some([Duration::ZERO; 2]), samples.clone()), [128]);
    // A quick trial suffices if there is room for all samples even at a quarter of its speed.
    let two_trials = |quick, thorough| Some([quick, thorough].map(Duration::from_millis));
    assert_eq!(history(two_trials(1, 100), samples.clone()), [128]);
    assert_eq!(history(two_trials(2, 100), samples.clone()), [8, 16, 32, 64, 128]);
    assert_eq!(history(None, samples), doubling, "the renderer cannot tell");
    assert_eq!(history(trial(1), Plan::samples(200)), doubling, "someone watches");
    // Of a time limit the first pass takes no more than there is: 20 samples.
    let in_time = batch(Stop { seconds: Some(0.2), ..Stop::at_samples(200) });
    assert_eq!(history(trial(10), in_time)[0], 16);
    // It must not go far beyond a noise target.
    let target = Stop { noise: Some(expected(64).error().unwrap().rmse), ..Stop::default() };
    assert_eq!(history(trial(1), batch(target))[..4], [2, 4, 8, 16]);
}

#[test]
fn pauses_lose_nothing() {
    let progressive = started(CPU, Plan::samples(1000));
    for at in [2, 10, 300] {
        wait_for(&progressive, at);
        progressive.pause();
        wait_until(&progressive, |status| status.phase != Phase::Tracing);
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

/// Adds samples of this value to every pixel, with `is_late` each pass when the next one comes or is waited for, as a GPU
/// does.
struct Valued {
    value: fn(u64) -> u64,
    is_late: bool,
    held: Option<Range<u64>>,
}

impl Renderer for Valued {
    fn info(&self) -> BackendInfo {
        Fake::new("cpu").info()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        for index in range.clone() {
            let half = &mut film.halves_mut()[index as usize % 2];
            half.iter_mut().for_each(|sum| sum.add(PixelSum([(self.value)(index); 3])));
        }
        film.record(range, 0)?;
        Ok(Stats::default())
    }

    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        let due = if self.is_late { self.held.replace(range) } else { Some(range) };
        due.map_or(Ok(Stats::default()), |due| self.accumulate(job, due, film, cancel))
    }

    fn collect(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let due = self.held.take();
        due.map_or(Ok(Stats::default()), |due| self.accumulate(&job(2), due, film, &AtomicBool::new(false)))
    }
}

/// A render of up to 256 samples of this value that ends at an error of .01.
fn ended(value: fn(u64) -> u64, is_late: bool) -> (Status, Film) {
    let factory = move |_: &BackendChoice| -> Result<Box<dyn Renderer>, BackendError> {
        Ok(Box::new(Valued { value, is_late, held: None }))
    };
    let mut progressive = Progressive::with_factory(Box::new(factory)).unwrap();
    let stop = Stop { noise: Some(0.01), ..Stop::at_samples(256) };
    progressive.start(RenderRequest::new(job(2), CPU, Plan::until(stop)));
    (progressive.wait_until_over(), progressive.finish().unwrap())
}

#[test]
fn a_picture_without_light_meets_no_noise_target() {
    let (status, film) = ended(|_| 0, false);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 256));
    assert_eq!((status.error, film.error()), (None, None));
    assert!(status.history.is_empty(), "{:?}", status.history);
    assert!(status.messages.iter().any(|message| message.contains("cannot be estimated")));
    let (status, _) = ended(|index| u64::from(index >= 64) << 24, false);
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert!(status.samples_per_pixel > 64 && status.history[0].samples_per_pixel > 64, "{status:?}");
}

#[test]
fn samples_that_come_late_are_heard_before_a_noise_target_ends_it() {
    let (status, _) = ended(|index| if index < 16 { 1 << 24 } else { (1 - index % 2) << 25 }, true);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 256));
    assert!(status.error.unwrap().rmse > 0.01);
    let (status, _) = ended(|_| 1 << 24, true);
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
}

/// At the end, the error is that of all samples, even if estimates take so long that none is due.
#[test]
fn the_error_at_the_end_is_that_of_the_whole_film() {
    let mut progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) }))
    }))
    .unwrap();
    progressive.start(RenderRequest::new(job(16_384), CPU, Plan::samples(6)));
    let status = progressive.wait_until_over();
    assert_eq!(status.error, progressive.finish().unwrap().error());
}

/// The first samples already meet this target, but their estimate is too rough to be trusted.
#[test]
fn a_noise_target_is_not_looked_at_before_its_first_samples() {
    let progressive =
        started(CPU, Plan { stop: Stop { noise: Some(1e9), ..Stop::default() }, ..Plan::endless() });
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert_eq!((status.samples_per_pixel, NOISE_TARGET_FIRST_SAMPLES), (16, 16));
}

#[test]
fn a_stop_keeps_the_film_and_can_be_taken_back() {
    let progressive = started(CPU, Plan::samples(2000));
    wait_for(&progressive, 8);
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    progressive.resume();
    wait_until(&progressive, |status| status.phase == Phase::Done(EndReason::Samples));
    progressive.set_plan(Plan::samples(2100));
    wait_for(&progressive, 2100);
    assert_eq!(progressive.status().planned_samples_per_pixel, 2100);
    assert_eq!(progressive.finish(), Some(expected(2100)));
}

#[test]
fn a_stop_during_a_pass_leaves_what_was_there_before_it() {
    let factory = |choice: &BackendChoice| -> Result<Box<dyn Renderer>, BackendError> {
        Ok(Box::new(Fake { waits_for_stop: true, ..Fake::new(choice.name()) }))
    };
    let mut progressive = Progressive::with_factory(Box::new(factory)).unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 2);
    // A render that goes on can be stopped again.
    for _ in 0..2 {
        progressive.stop();
        let status = progressive.wait_until_over();
        assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), 2));
        progressive.resume();
        wait_until(&progressive, |status| status.phase == Phase::Tracing);
    }
    progressive.stop();
    progressive.wait_until_over();
    assert_eq!(progressive.finish(), Some(expected(2)));
}

#[test]
fn a_new_job_takes_over_in_the_middle_of_a_pass() {
    let mut progressive = Progressive::with_factory(Box::new(|_| {
        let pause = Duration::from_millis(1);
        Ok(Box::new(Fake { pause, ..Fake::new("cpu") }))
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
fn abandoned_work_leaves_nothing() {
    let mut progressive = started(CPU, Plan::endless());
    wait_for(&progressive, 2);
    progressive.abandon();
    assert_eq!(progressive.wait_until_over().phase, Phase::Idle);
    assert_eq!(progressive.finish(), None);
}

/// A pass of it ends only when it is cancelled; `ended` is told whether it was.
struct Endless {
    begun: Sender<()>,
    ended: Sender<bool>,
}

impl Renderer for Endless {
    fn info(&self) -> BackendInfo {
        Fake::new("cpu").info()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        _: Range<u64>,
        _: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        let _ = self.begun.send(());
        let begin = Instant::now();
        while !cancel.load(Ordering::Relaxed) && begin.elapsed() < PATIENCE {
            std::thread::yield_now();
        }
        let _ = self.ended.send(cancel.load(Ordering::Relaxed));
        Err(RenderError::Cancelled)
    }
}

#[test]
fn abandoning_and_dropping_cancel_the_pass() {
    for is_dropped in [false, true] {
        let ((begun, has_begun), (ended, has_ended)) = (channel(), channel());
        let progressive = Progressive::with_factory(Box::new(move |_| {
            Ok(Box::new(Endless { begun: begun.clone(), ended: ended.clone() }))
        }));
        let mut progressive = progressive.unwrap();
        progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
        has_begun.recv_timeout(PATIENCE).unwrap();
        if is_dropped {
            drop(progressive);
        } else {
            progressive.abandon();
            assert_eq!(progressive.wait_until_over().phase, Phase::Idle);
            assert_eq!(progressive.finish(), None);
        }
        assert!(has_ended.recv_timeout(PATIENCE).unwrap(), "dropped: {is_dropped}");
    }
}

/// The first time, it prepares until it is cancelled.
struct SlowToPrepare {
    fake: Fake,
    begun: Option<Sender<()>>,
}

impl Renderer for SlowToPrepare {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, _: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        let Some(begun) = self.begun.take() else { return Ok(()) };
        begun.send(()).unwrap();
        let begin = Instant::now();
        while !cancel.load(Ordering::Relaxed) && begin.elapsed() < PATIENCE {
            std::thread::yield_now();
        }
        if cancel.load(Ordering::Relaxed) { Err(RenderError::Cancelled) } else { Ok(()) }
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        assert!(!cancel.load(Ordering::Relaxed), "a stop does not cancel a pass");
        self.fake.accumulate(job, range, film, cancel)
    }
}

#[test]
fn a_stop_does_not_wait_for_preparation() {
    let (begun, has_begun) = channel();
    let mut progressive = Progressive::with_factory(Box::new(move |_| {
        Ok(Box::new(SlowToPrepare { fake: Fake::new("cpu"), begun: Some(begun.clone()) }))
    }))
    .unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(8)));
    has_begun.recv_timeout(PATIENCE).unwrap();
    progressive.stop();
    let status = progressive.wait_until_over();
    assert!(status.messages.is_empty() && status.given_up.is_empty(), "{status:?}");
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), 0));
    progressive.resume();
    wait_until(&progressive, |status| status.phase == Phase::Done(EndReason::Samples));
    assert_eq!(progressive.finish(), Some(expected(8)));
}

#[test]
fn a_preparation_that_was_cancelled_can_begin_again() {
    let mut renderer = weekender::backends::create(&CPU).unwrap();
    let outcome = renderer.prepare(&job(2), &AtomicBool::new(true));
    assert!(matches!(outcome, Err(RenderError::Cancelled)), "{outcome:?}");
    assert_eq!(renderer.kernel(), "");
    renderer.prepare(&job(2), &AtomicBool::new(false)).unwrap();
    assert_ne!(renderer.kernel(), "");
}

#[test]
fn the_time_limit_includes_preparation() {
    const PREPARATION: Duration = Duration::from_millis(100);
    let progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Fake { preparation: PREPARATION, ..Fake::new(choice.name()) }))
    }));
    let mut progressive = progressive.unwrap();
    let stop = Stop { seconds: Some(PREPARATION.as_secs_f64() / 2.0), ..Stop::default() };
    progressive.start(RenderRequest::new(job(2), CPU, Plan::until(stop)));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::TimeLimit));
    assert_eq!(status.samples_per_pixel, 2, "only the first pass, which is always rendered");
}
