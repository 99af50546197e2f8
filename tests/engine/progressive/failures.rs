//! Failures and panics of backends, listeners and the render thread.

use super::common::{
    CPU, FAILING, Fake, PATIENCE, PAUSE, expected, forgetful, job, other_cpu, parts, said, spoiling, started,
    started_with, stopped, wait_for, wait_until,
};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest};
use weekender::render_gpu::GpuError;

#[test]
fn a_failing_backend_hands_its_film_to_the_cpu() {
    let progressive = started(FAILING, Plan::samples(100));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert_eq!(said(&status), ["reference failed: pulled out; the CPU continues the same picture"]);
    assert_eq!(status.given_up, ["reference"]);
    assert_eq!(parts(&status), [("reference", 16), ("cpu", 84)]);
    // A point of the history names its backend and has the error of its samples.
    for point in &status.history {
        let backend = if point.samples_per_pixel <= 16 { "reference" } else { "cpu" };
        let error = expected(point.samples_per_pixel).error().unwrap();
        assert_eq!((point.backend, point.rmse_estimate), (backend, error.rmse), "{point:?}");
    }
    assert_eq!(progressive.take_film(), Some(expected(100)));
}

#[test]
fn last_whole_pass_survives_when_all_backends_fail() {
    for panics in [false, true] {
        let asked = Arc::new(Mutex::new(Vec::new()));
        let seen = Arc::clone(&asked);
        let progressive = started_with(CPU, Plan::samples(100), move |choice| {
            seen.lock().unwrap().push(choice.words());
            let [fails_at, panics_at] = [!panics, panics].map(|is_so| is_so.then_some(16));
            Box::new(Fake { fails_at, panics_at, ..Fake::new(choice.name()) })
        });
        let status = progressive.wait_until_over();
        let reason = if panics { "a slip of the tracer" } else { "pulled out" };
        assert!(matches!(&status.phase, Phase::Failed(message) if message.contains(reason)), "{status:?}");
        assert_eq!(*asked.lock().unwrap(), ["the CPU", "the CPU's scalar code", "the reference"]);
        assert_eq!(progressive.take_film(), Some(expected(16)));
    }
}

#[test]
fn panics_do_not_end_the_render() {
    let mut is_first = true;
    let progressive = started_with(FAILING, Plan::samples(2000), move |choice| {
        assert!(!std::mem::take(&mut is_first), "no such backend");
        let panics_at = (*choice == CPU).then_some(16);
        Box::new(Fake { panics_at, ..Fake::new(choice.name()) })
    });
    wait_for(&progressive, 8);
    progressive.inspect(|_| unreachable!("a slip of the onlooker"));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    let messages = status.messages.join("; ");
    for slip in ["no such backend", "a slip of the tracer", "a slip of the onlooker"] {
        assert!(messages.contains(slip), "{messages}");
    }
    assert_eq!(progressive.take_film(), Some(expected(2000)));
}

#[test]
fn missing_samples_are_noticed() {
    let progressive = started_with(CPU, Plan::samples(64), |choice| {
        let fake = Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) };
        if *choice == CPU { forgetful() } else { Box::new(fake) }
    });
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert!(
        status.messages.iter().any(|said| said.contains("asked for 64 samples")),
        "{:?}",
        status.messages
    );
    assert_eq!(progressive.take_film(), Some(expected(64)));
}

#[test]
fn uncollected_samples_are_rendered_by_the_next_backend() {
    let short_passes = Plan { pass_target: PAUSE, ..Plan::endless() };
    for is_switch in [false, true] {
        let (traced, is_traced) = channel();
        // The new backend becomes ready once the old one holds samples that it will lose: those after the first
        // collection.
        let (release, is_released) = channel();
        let progressive = started_with(CPU, short_passes.clone(), move |choice| {
            let fake = Fake::new(choice.name());
            if *choice == CPU {
                let traced = traced.clone();
                // The test may have stopped listening.
                let tell = move |_: &_, good_collections| _ = traced.send(good_collections);
                return fake.holding(u32::from(is_switch), tell);
            }
            if is_switch {
                is_released.recv_timeout(PATIENCE).unwrap();
            }
            Box::new(fake)
        });
        is_traced.recv_timeout(PATIENCE).unwrap();
        if is_switch {
            progressive.switch_backend(other_cpu());
            while is_traced.recv_timeout(PATIENCE).unwrap() != 0 {}
            release.send(()).unwrap();
            wait_until(&progressive, |status| !status.messages.is_empty());
        } else {
            progressive.pause();
            wait_until(&progressive, |status| status.phase == Phase::Paused);
            progressive.resume();
        }
        let samples = progressive.status().samples_per_pixel;
        wait_for(&progressive, samples + 64);
        let messages = said(&stopped(progressive));
        assert!(messages.len() == 1 && messages[0].starts_with("cpu failed: pulled out"), "{messages:?}");
    }
}

#[test]
fn old_backend_continues_if_another_is_unavailable() {
    let mut progressive = Progressive::with_factory(Box::new(|choice| match *choice == FAILING {
        true => Err(GpuError::None.into()),
        false => Ok(Box::new(Fake::new("cpu"))),
    }))
    .unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 4);
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| !status.messages.is_empty());
    let message = format!("reference failed: {}; the cpu continues", GpuError::None);
    assert_eq!(progressive.status().given_up, ["reference"]);
    // So it does for a new render.
    progressive.start(RenderRequest::new(job(2), FAILING, Plan::endless()));
    wait_for(&progressive, 4);
    assert_eq!(said(&stopped(progressive)), [message]);
}

#[test]
fn spoilt_film_is_restarted() {
    let progressive = started_with(CPU, Plan::samples(100), |choice| match *choice == CPU {
        true => spoiling("cpu", || ()),
        false => Box::new(Fake::new(choice.name())),
    });
    let status = progressive.wait_until_over();
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 100));
    let traced: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    assert_eq!(traced, 100, "lost samples do not count");
    assert_eq!(progressive.take_film(), Some(expected(100)));

    let progressive = started_with(CPU, Plan::samples(100), |choice| spoiling(choice.name(), || ()));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("pulled out")), "{status:?}");
    assert_eq!(status.samples_per_pixel, 0);
    assert_eq!(progressive.take_film(), Some(job(2).new_film()));
}

/// A paused render with a listener that panics the next `times` it is called.
fn paused_with_a_listener_that_panics(times: u32) -> Progressive {
    let progressive = started(CPU, Plan::endless());
    wait_for(&progressive, 2);
    progressive.pause();
    wait_until(&progressive, |status| status.phase == Phase::Paused);
    listen_and_panic(&progressive, times);
    progressive
}

fn listen_and_panic(progressive: &Progressive, times: u32) {
    let calls = AtomicU32::new(0);
    progressive.set_notice(move || {
        assert!(calls.fetch_add(1, Ordering::Relaxed) >= times, "a slip of the listener");
    });
}

#[test]
fn a_listener_that_panics_does_not_end_the_render() {
    let progressive = paused_with_a_listener_that_panics(1);
    let held = progressive.status().samples_per_pixel;
    progressive.resume();
    wait_for(&progressive, held + 16);
    let messages = stopped(progressive).messages.join("; ");
    assert!(messages.contains("a slip of the listener"), "{messages}");

    let progressive = started(CPU, Plan::samples(8));
    progressive.wait_until_over();
    listen_and_panic(&progressive, 1);
    progressive.ask_for_picture();
    // The next command delivers the message.
    progressive.inspect(|_| ());
    wait_until(&progressive, |status| !status.messages.is_empty());
    assert_eq!(progressive.take_film(), Some(expected(8)));
}

#[test]
fn dead_render_thread_reports_the_lost_film() {
    // It panics again while the first panic is handled.
    let progressive = paused_with_a_listener_that_panics(2);
    progressive.resume();
    wait_until(&progressive, |status| status.phase.is_over());
    let lost = "the render thread failed; its film is lost";
    assert_eq!(progressive.status().phase, Phase::Failed(lost.to_owned()));
    assert_eq!(progressive.take_film(), None);
}
