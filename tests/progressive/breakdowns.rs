//! What the device holds, and breakdowns in the middle of a switch, a pause or a picture, and of those that look on.

use super::common::{
    CPU, FAILING, Fake, Holding, PATIENCE, PAUSE, Spoiling, Waiting, expected, job, other_cpu, started,
    wait_for, wait_until,
};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};
use weekender::backends::BackendError;
use weekender::film::Film;
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest};
use weekender::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats};
use weekender::render_gpu::GpuError;

/// Tells a test, after every pass, how many collections will still go well.
fn tell(traced: &Sender<u32>) -> impl FnMut(&Range<u64>, u32) + Send + 'static {
    let traced = traced.clone();
    move |_, good_collections| {
        // The test may have heard enough.
        let _ = traced.send(good_collections);
    }
}

/// Short passes without end.
fn short_passes() -> Plan {
    Plan { pass_target: PAUSE, ..Plan::endless() }
}

/// Stops the render; returns what it said. All samples must be there.
fn stopped(progressive: Progressive) -> Vec<String> {
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
    status.messages
}

/// The first picture is worth the wait for what the device holds.
#[test]
fn the_first_picture_is_collected() {
    let (traced, _is_traced) = channel();
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let fake = Fake::new(choice.name());
        Ok(Box::new(Holding::new(fake, 1000, tell(&traced))))
    }));
    let mut progressive = progressive.unwrap();
    progressive.ask_for_picture();
    progressive.start(RenderRequest::new(job(2), CPU, short_passes()));
    wait_for(&progressive, 2);
    progressive.stop();
    progressive.wait_until_over();
    assert_eq!(progressive.newest_picture().map(|picture| picture.width), Some(2));
}

#[test]
fn the_backend_is_told_before_its_first_pass() {
    let (go_on, is_let_go_on) = channel();
    let mut signal = Some(is_let_go_on);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        Ok(Box::new(Waiting { fake: Fake::new(choice.name()), signal: signal.take() }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(8)));
    wait_until(&progressive, |status| status.phase == Phase::Tracing);
    assert_eq!(progressive.status().backend.map(|backend| backend.name), Some("cpu"));
    go_on.send(()).unwrap();
    assert_eq!(progressive.wait_until_over().samples_per_pixel, 8);
}

/// Gives up a thread in its first pass.
struct Shrinking {
    fake: Fake,
    threads: usize,
}

impl Renderer for Shrinking {
    fn info(&self) -> BackendInfo {
        BackendInfo { threads: self.threads, ..self.fake.info() }
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
        self.threads = 1;
        self.fake.accumulate(job, range, film, cancel)
    }
}

#[test]
fn a_backend_that_changes_is_told_anew() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Shrinking { fake: Fake::new(choice.name()), threads: 2 }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(8)));
    assert_eq!(progressive.wait_until_over().backend.map(|backend| backend.threads), Some(1));
}

#[test]
fn samples_that_a_pause_cannot_collect_are_rendered_by_the_next_backend() {
    let (traced, is_traced) = channel();
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let fake = Fake::new(choice.name());
        if *choice != CPU {
            return Ok(Box::new(fake));
        }
        Ok(Box::new(Holding::new(fake, 0, tell(&traced))))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, short_passes()));
    is_traced.recv_timeout(PATIENCE).unwrap();
    progressive.pause();
    wait_until(&progressive, |status| status.phase == Phase::Paused);
    progressive.resume();
    wait_for(&progressive, 64);
    assert_eq!(
        stopped(progressive),
        ["cpu failed: pulled out; the CPU's scalar code continues the same picture"]
    );
}

#[test]
fn samples_that_a_switch_cannot_collect_are_rendered_by_the_new_backend() {
    let (traced, is_traced) = channel();
    // The new backend is ready once the old one holds samples that it will lose: those after the first collection.
    let (go_on, is_let_go_on) = channel();
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        let fake = Fake::new(choice.name());
        if *choice == CPU {
            return Ok(Box::new(Holding::new(fake, 1, tell(&traced))));
        }
        is_let_go_on.recv_timeout(PATIENCE).unwrap();
        Ok(Box::new(fake))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, short_passes()));
    is_traced.recv_timeout(PATIENCE).unwrap();
    progressive.switch_backend(other_cpu());
    while is_traced.recv_timeout(PATIENCE).unwrap() != 0 {}
    go_on.send(()).unwrap();
    wait_until(&progressive, |status| !status.messages.is_empty() || status.samples_per_pixel > 4096);
    let samples = progressive.status().samples_per_pixel;
    wait_for(&progressive, samples + 64);
    assert!(progressive.status().given_up.is_empty());
    assert_eq!(stopped(progressive), ["cpu failed: pulled out"]);
}

#[test]
fn a_backend_that_cannot_be_switched_to_is_told_and_the_old_one_goes_on() {
    let progressive = Progressive::with_factory(Box::new(|choice| match *choice == FAILING {
        true => Err(BackendError::Gpu(GpuError::None)),
        false => Ok(Box::new(Fake::new(choice.name()))),
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 4);
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| !status.messages.is_empty() || !status.given_up.is_empty());
    assert_eq!(progressive.status().given_up, ["reference"]);
    assert_eq!(stopped(progressive), [format!("{}; the cpu continues", GpuError::None)]);
}

#[test]
fn a_new_render_whose_backend_is_not_available_keeps_the_one_before() {
    let mut is_first = true;
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        if *choice == FAILING && std::mem::take(&mut is_first) {
            return Err(BackendError::Gpu(GpuError::None));
        }
        Ok(Box::new(Fake::new(choice.name())))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(4)));
    progressive.wait_until_over();
    progressive.start(RenderRequest::new(job(2), FAILING, Plan::endless()));
    wait_for(&progressive, 4);
    // It is not the backend of this render, so it can be switched to.
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| status.contributions.len() == 2);
    let parts: Vec<_> =
        progressive.status().contributions.into_iter().map(|part| part.backend.name).collect();
    assert_eq!(parts, ["cpu", "reference"]);
    assert_eq!(stopped(progressive), [format!("{}; the cpu continues", GpuError::None)]);
}

#[test]
fn a_film_that_was_spoilt_is_begun_again() {
    let progressive = Progressive::with_factory(Box::new(|choice| match *choice == CPU {
        true => Ok(Box::new(Spoiling::new("cpu"))),
        false => Ok(Box::new(Fake::new(choice.name()))),
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Samples), 100));
    assert_eq!(progressive.finish(), Some(expected(100)));
}

#[test]
fn if_every_backend_spoils_the_film_it_is_empty() {
    let progressive =
        Progressive::with_factory(Box::new(|choice| Ok(Box::new(Spoiling::new(choice.name())))));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("pulled out")), "{status:?}");
    assert_eq!(status.samples_per_pixel, 0);
    assert_eq!(progressive.finish(), Some(job(2).new_film()));
}

/// A paused render and a listener that panics the next times that it is called.
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
    let said = stopped(progressive).join("; ");
    assert!(said.contains("a slip of the listener") && said.contains("continues the same picture"), "{said}");
}

#[test]
fn a_render_thread_that_dies_says_that_the_film_is_lost() {
    // It panics again while the first panic is handled.
    let progressive = paused_with_a_listener_that_panics(2);
    progressive.resume();
    wait_until(&progressive, |status| status.phase.is_over());
    let lost = "the render thread failed; its film is lost";
    assert_eq!(progressive.status().phase, Phase::Failed(lost.to_owned()));
    assert_eq!(progressive.finish(), None);
}

#[test]
fn a_panic_while_a_picture_is_shown_is_told() {
    let progressive = started(CPU, Plan::samples(8));
    progressive.wait_until_over();
    listen_and_panic(&progressive, 1);
    progressive.ask_for_picture();
    // The next command brings the news.
    progressive.inspect(|_| ());
    wait_until(&progressive, |status| !status.messages.is_empty());
    let said = progressive.status().messages;
    assert!(said.len() == 1 && said[0].contains("a slip of the listener"), "{said:?}");
    assert_eq!(progressive.finish(), Some(expected(8)));
}
