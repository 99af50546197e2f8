//! Ending, pausing and replacing a render.

use super::common::{
    CPU, FAILING, Fake, PATIENCE, expected, idle, job, other_cpu, scripted, settled, started, started_with,
    stopped, wait_for, wait_until,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};
use weekender::film::{Film, PixelSum};
use weekender::job::render::{RenderError, Renderer};
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest, Status, Stop};

fn to_noise(noise: f64) -> Plan {
    Plan::until(Stop { noise: Some(noise), ..Stop::default() })
}

fn samples_of_history(status: &Status) -> Vec<u64> {
    status.history.iter().map(|point| point.samples_per_pixel).collect()
}

#[test]
fn unwatched_first_pass_has_full_length() {
    /// The samples in the film at the end of each pass that reaches another power of two.
    fn history(trial: Option<[u64; 2]>, plan: Plan) -> Vec<u64> {
        let trial = trial.map(|times| times.map(Duration::from_millis));
        let progressive = started_with(CPU, plan, move |choice| {
            Box::new(Fake { trial, pause: Duration::ZERO, ..Fake::new(choice.name()) })
        });
        let status = progressive.wait_until_over();
        assert_eq!(progressive.take_film(), Some(expected(status.samples_per_pixel)));
        samples_of_history(&status)
    }
    let batch = |stop| Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(stop) };
    let samples = batch(Stop::at_samples(200));
    let doubling = &[2, 4, 8, 16, 32, 64, 128][..];
    // 900 ms have room for 900, 90 and 9 samples, and for less than the two that a pass has at least. A quick trial
    // suffices if there is room for all samples even at a quarter of its speed.
    for (trial, expected) in [
        (Some([1, 1]), &[128][..]),
        (Some([10, 10]), &[64, 128]),
        (Some([100, 100]), &[8, 16, 32, 64, 128]),
        (Some([10_000, 10_000]), doubling),
        (Some([0, 0]), &[128]),
        (Some([1, 100]), &[128]),
        (Some([2, 100]), &[8, 16, 32, 64, 128]),
        (None, doubling),
    ] {
        assert_eq!(history(trial, samples.clone()), expected, "{trial:?}");
    }
    assert_eq!(history(Some([1, 1]), Plan::samples(200)), doubling, "someone watches");
    // The first pass takes no longer than the time limit allows: 20 samples.
    let in_time =
        Plan { pass_target: PATIENCE, ..batch(Stop { seconds: Some(20.0), ..Stop::at_samples(200) }) };
    assert_eq!(history(Some([1000, 1000]), in_time)[0], 16);
    // It must not go far beyond a noise target.
    let target = to_noise(expected(64).error().unwrap().rmse).stop;
    assert_eq!(history(Some([1, 1]), batch(target))[..4], [2, 4, 8, 16]);
}

#[test]
fn time_limit_includes_preparation_but_allows_one_pass() {
    for (limit, milliseconds) in [(1e-9, 0), (0.05, 100), (0.1, 0)] {
        let plan = Plan::until(Stop { seconds: Some(limit), ..Stop::default() });
        let preparation = Duration::from_millis(milliseconds);
        let progressive = started_with(CPU, plan, move |choice| {
            Box::new(Fake::new(choice.name()).preparing_for(preparation))
        });
        let status = progressive.wait_until_over();
        assert_eq!(status.phase, Phase::Done(EndReason::TimeLimit));
        let is_over_before_the_first_pass = limit != 0.1;
        assert!(status.samples_per_pixel >= 2, "{status:?}");
        assert!(!is_over_before_the_first_pass || status.samples_per_pixel == 2, "{status:?}");
        assert_eq!(progressive.take_film(), Some(expected(status.samples_per_pixel)));
    }
}

#[test]
fn noise_target_ends_the_render() {
    let target = expected(64).error().unwrap().rmse;
    let progressive = started(CPU, to_noise(target));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert!(status.error.unwrap().rmse <= target);
    assert_eq!(status.error, progressive.take_film().unwrap().error());
    // The first samples already meet this target, but their estimate is too rough to be trusted.
    assert_eq!(started(CPU, to_noise(1e9)).wait_until_over().samples_per_pixel, 16);
}

/// A render of up to 256 samples of this value that ends at an error of 0.01. If `is_late`, the samples of each pass
/// come with the next one.
fn ended(value: fn(u64) -> u64, is_late: bool) -> (Status, Film) {
    let stop = Stop { noise: Some(0.01), ..Stop::at_samples(256) };
    let progressive = started_with(CPU, Plan::until(stop), move |_| {
        let value = Box::new(move |_, index| PixelSum([value(index); 3]));
        Box::new(Fake { value, holds: usize::from(is_late), pause: Duration::ZERO, ..Fake::new("cpu") })
    });
    (progressive.wait_until_over(), progressive.take_film().unwrap())
}

#[test]
fn a_picture_without_light_meets_no_noise_target() {
    let (status, film) = ended(|_| 0, false);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 256));
    assert_eq!((status.error, film.error()), (None, None));
    assert!(status.history.is_empty(), "{:?}", status.history);
    let (status, _) = ended(|index| u64::from(index >= 64) << 24, false);
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
    assert!(status.samples_per_pixel > 64 && status.history[0].samples_per_pixel > 64, "{status:?}");
}

#[test]
fn late_samples_count_before_a_noise_target() {
    let (status, _) = ended(|index| if index < 16 { 1 << 24 } else { (1 - index % 2) << 25 }, true);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 256));
    assert!(status.error.unwrap().rmse > 0.01);
    let (status, _) = ended(|_| 1 << 24, true);
    assert_eq!(status.phase, Phase::Done(EndReason::NoiseTarget));
}

/// At the end, the error is that of all samples, even if estimates take so long that none is due.
#[test]
fn the_error_at_the_end_is_that_of_the_whole_film() {
    let mut progressive = idle(|choice| Box::new(Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) }));
    progressive.start(RenderRequest::new(job(16_384), CPU, Plan::samples(6)));
    let status = progressive.wait_until_over();
    assert_eq!(status.error, progressive.take_film().unwrap().error());
}

#[test]
fn stop_keeps_the_film_and_can_be_undone() {
    let progressive = started(CPU, Plan::samples(2000));
    wait_for(&progressive, 8);
    progressive.stop();
    assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Stopped));
    progressive.resume();
    wait_until(&progressive, |status| status.phase == Phase::Done(EndReason::Samples));
    progressive.set_plan(Plan::samples(2100));
    wait_for(&progressive, 2100);
    assert_eq!(progressive.status().planned_samples_per_pixel, 2100);
    assert_eq!(progressive.take_film(), Some(expected(2100)));
}

#[test]
fn stop_during_a_pass_keeps_the_earlier_film() {
    let progressive = started_with(CPU, Plan::endless(), |choice| {
        Box::new(Fake { waits_for_stop: true, ..Fake::new(choice.name()) })
    });
    wait_for(&progressive, 2);
    // A resumed render can be stopped again.
    for _ in 0..2 {
        progressive.stop();
        let status = progressive.wait_until_over();
        assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), 2));
        progressive.resume();
        wait_until(&progressive, |status| status.phase == Phase::Tracing);
    }
    stopped(progressive);
}

/// The length of the first pass is a guess, which can be far too long on a busy machine.
#[test]
fn a_stop_during_the_first_pass_leaves_the_fewest_samples() {
    let ((begun, has_begun), (ended, has_ended)) = (channel(), channel());
    let plan = Plan { preview: Some(64), ..Plan::endless() };
    let progressive = started_with(CPU, plan, move |_| {
        let (begun, ended) = (begun.clone(), ended.clone());
        scripted("cpu", move |fake, range, film, cancel| {
            if range != (0..64) {
                return fake.accumulate(&job(2), range, film, cancel);
            }
            film.halves_mut()[0][0].add(PixelSum([1; 3]));
            Err(until_cancelled(&begun, &ended, cancel))
        })
    });
    has_begun.recv_timeout(PATIENCE).unwrap();
    let status = stopped(progressive);
    assert_eq!((has_ended.recv_timeout(PATIENCE), status.samples_per_pixel), (Ok(true), 2));
}

/// Reports that it begins, waits until it is cancelled, and reports whether it was.
fn until_cancelled(begun: &Sender<()>, ended: &Sender<bool>, cancel: &AtomicBool) -> RenderError {
    let _ = begun.send(());
    let begin = Instant::now();
    while !cancel.load(Ordering::Relaxed) && begin.elapsed() < PATIENCE {
        std::thread::yield_now();
    }
    let _ = ended.send(cancel.load(Ordering::Relaxed));
    RenderError::Cancelled
}

#[test]
fn abandoning_and_dropping_cancel_the_pass() {
    for is_dropped in [false, true] {
        let ((begun, has_begun), (ended, has_ended)) = (channel(), channel());
        let mut progressive = started_with(CPU, Plan::endless(), move |_| {
            let (begun, ended) = (begun.clone(), ended.clone());
            scripted("cpu", move |_, _, _, cancel| Err(until_cancelled(&begun, &ended, cancel)))
        });
        has_begun.recv_timeout(PATIENCE).unwrap();
        if is_dropped {
            drop(progressive);
        } else {
            progressive.abandon();
            assert_eq!(progressive.wait_until_over().phase, Phase::Idle);
            assert_eq!(progressive.take_film(), None);
        }
        assert!(has_ended.recv_timeout(PATIENCE).unwrap(), "dropped: {is_dropped}");
    }
}

/// Prepares until cancelled this many times, and then works.
fn slow_to_prepare(
    name: &'static str,
    mut times: u32,
    begun: Sender<()>,
    ended: Sender<bool>,
) -> Box<dyn Renderer> {
    let prepares = move |cancel: &AtomicBool| {
        if times == 0 {
            return Ok(());
        }
        times -= 1;
        Err(until_cancelled(&begun, &ended, cancel))
    };
    Box::new(Fake { prepares: Some(Box::new(prepares)), ..Fake::new(name) })
}

#[test]
fn a_stop_does_not_wait_for_preparation() {
    let ((begun, has_begun), (ended, _has_ended)) = (channel(), channel());
    let progressive =
        started_with(CPU, Plan::samples(8), move |_| slow_to_prepare("cpu", 1, begun.clone(), ended.clone()));
    has_begun.recv_timeout(PATIENCE).unwrap();
    progressive.stop();
    let status = progressive.wait_until_over();
    assert!(status.messages.is_empty() && status.given_up.is_empty(), "{status:?}");
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), 0));
    progressive.resume();
    wait_until(&progressive, |status| status.phase == Phase::Done(EndReason::Samples));
    assert_eq!(progressive.take_film(), Some(expected(8)));
}

#[test]
fn abandoned_preparation_is_not_awaited() {
    for (is_pending, is_followed) in [(false, false), (false, true), (true, false), (true, true)] {
        let ((begun, has_begun), (ended, has_ended)) = (channel(), channel());
        let mut progressive = idle(move |choice| {
            let times = if *choice == FAILING { u32::MAX } else { 0 };
            slow_to_prepare(choice.name(), times, begun.clone(), ended.clone())
        });
        if is_pending {
            progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
            wait_for(&progressive, 2);
            progressive.switch_backend(FAILING);
        } else {
            progressive.start(RenderRequest::new(job(2), FAILING, Plan::samples(4)));
        }
        has_begun.recv_timeout(PATIENCE).unwrap();
        if is_followed {
            progressive.start(RenderRequest::new(job(2), other_cpu(), Plan::samples(4)));
            assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Samples));
            assert_eq!(progressive.take_film(), Some(expected(4)));
        } else {
            progressive.abandon();
            wait_until(&progressive, |status| status.phase == Phase::Idle);
            assert_eq!(progressive.take_film(), None);
        }
        assert_eq!(has_ended.recv_timeout(PATIENCE), Ok(true), "pending: {is_pending}");
    }
}

type Ask = fn(&Progressive);

const PAUSE: Ask = Progressive::pause;
const RESUME: Ask = Progressive::resume;
const STOP: Ask = Progressive::stop;

/// Sends these requests; phase and samples must not change.
fn changes_nothing(progressive: &Progressive, requests: &[Ask]) {
    let before = settled(progressive);
    for (number, ask) in requests.iter().enumerate() {
        ask(progressive);
        let after = settled(progressive);
        assert_eq!((after.phase, after.run), (before.phase.clone(), before.run), "request {number}");
        assert_eq!(after.samples_per_pixel, before.samples_per_pixel, "request {number}");
    }
}

/// A render without an end that was paused after some samples, and their number.
fn paused() -> (Progressive, u64) {
    let progressive = started(CPU, Plan::endless());
    wait_for(&progressive, 2);
    progressive.pause();
    let status = settled(&progressive);
    assert_eq!(status.phase, Phase::Paused);
    (progressive, status.samples_per_pixel)
}

#[test]
fn paused_render_obeys_other_commands() {
    let (progressive, held) = paused();
    changes_nothing(&progressive, &[PAUSE]);
    progressive.stop();
    let status = settled(&progressive);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), held));
    assert_eq!(status.error, expected(held).error());
    changes_nothing(&progressive, &[PAUSE, STOP]);
    progressive.resume();
    wait_for(&progressive, held + 2);
    stopped(progressive);

    let (progressive, held) = paused();
    progressive.set_plan(Plan::samples(held + 8));
    let status = settled(&progressive);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Paused, held));
    assert_eq!(status.planned_samples_per_pixel, held + 8);
    progressive.resume();
    assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Samples));
    assert_eq!(progressive.take_film(), Some(expected(held + 8)));

    let (progressive, held) = paused();
    assert_eq!(progressive.take_film(), Some(expected(held)));
    assert_eq!(progressive.status().phase, Phase::Idle);
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);

    let (mut progressive, _) = paused();
    progressive.abandon();
    assert_eq!(settled(&progressive).phase, Phase::Idle);
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);
    assert_eq!(progressive.take_film(), None);
}
