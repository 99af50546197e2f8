//! What ends a render, pauses it, or starts another.

use super::common::{CPU, Fake, PATIENCE, expected, job, started, wait_for, wait_until};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};
use weekender::film::Film;
use weekender::progressive::{
    EndReason, NOISE_TARGET_FIRST_SAMPLES, Phase, Plan, Progressive, RenderRequest, Stop,
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
