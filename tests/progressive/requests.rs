//! What becomes of a request in each phase of a render.

use super::common::{CPU, Fake, PATIENCE, expected, job, other_cpu, started, wait_for};
use std::sync::mpsc::channel;
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest, Status};

type Ask = fn(&Progressive);

/// The status when all requests so far are obeyed.
fn settled(progressive: &Progressive) -> Status {
    let (seen, is_seen) = channel();
    progressive.inspect(move |_| seen.send(()).unwrap());
    // Without a film, the request is dropped, which ends the wait, too.
    let _ = is_seen.recv_timeout(PATIENCE);
    progressive.status()
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

/// Asks for each of these; the phase and the samples must stay as they are.
fn changes_nothing(progressive: &Progressive, requests: &[(&str, Ask)]) {
    let before = settled(progressive);
    for (name, ask) in requests {
        ask(progressive);
        let after = settled(progressive);
        assert_eq!(
            (after.phase, after.samples_per_pixel, after.run),
            (before.phase.clone(), before.samples_per_pixel, before.run),
            "{name}"
        );
    }
}

const PAUSE: (&str, Ask) = ("pause", Progressive::pause);
const RESUME: (&str, Ask) = ("resume", Progressive::resume);
const STOP: (&str, Ask) = ("stop", Progressive::stop);

#[test]
fn a_paused_render_can_be_stopped_and_then_goes_on() {
    let (progressive, held) = paused();
    changes_nothing(&progressive, &[PAUSE]);
    progressive.stop();
    let status = settled(&progressive);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(EndReason::Stopped), held));
    assert_eq!(status.error, expected(held).error());
    changes_nothing(&progressive, &[PAUSE, STOP]);
    progressive.resume();
    wait_for(&progressive, held + 2);
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
}

#[test]
fn a_paused_render_takes_a_new_plan_but_goes_on_only_when_it_is_resumed() {
    let (progressive, held) = paused();
    progressive.set_plan(Plan::samples(held + 8));
    let status = settled(&progressive);
    assert_eq!((status.phase, status.samples_per_pixel), (Phase::Paused, held));
    assert_eq!(status.planned_samples_per_pixel, held + 8);
    progressive.resume();
    assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Samples));
    assert_eq!(progressive.finish(), Some(expected(held + 8)));
}

#[test]
fn the_film_of_a_paused_render_can_be_taken() {
    let (progressive, held) = paused();
    assert_eq!(progressive.take_film(), Some(expected(held)));
    assert_eq!(progressive.status().phase, Phase::Idle);
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);
    assert_eq!(progressive.finish(), None);
}

#[test]
fn a_paused_render_can_be_abandoned_or_give_way_to_another() {
    let (mut progressive, _) = paused();
    progressive.abandon();
    assert_eq!(settled(&progressive).phase, Phase::Idle);
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);
    assert_eq!(progressive.finish(), None);

    let (mut progressive, _) = paused();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(4)));
    let status = progressive.wait_until_over();
    assert_eq!((status.phase, status.run), (Phase::Done(EndReason::Samples), 2));
    assert_eq!(progressive.finish(), Some(expected(4)));
}

#[test]
fn a_render_can_be_paused_before_its_first_samples() {
    let progressive = started(CPU, Plan::endless());
    progressive.pause();
    let status = settled(&progressive);
    assert_eq!(status.phase, Phase::Paused);
    changes_nothing(&progressive, &[PAUSE]);
    progressive.resume();
    wait_for(&progressive, status.samples_per_pixel + 2);
    let film = progressive.finish().unwrap();
    assert!(film == expected(film.sample_count()));
}

#[test]
fn a_render_that_has_ended_is_neither_paused_nor_resumed_nor_stopped() {
    let progressive = started(CPU, Plan::samples(8));
    assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Samples));
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);
    assert_eq!(progressive.finish(), Some(expected(8)));

    let failing = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Fake { fails_at: Some(8), ..Fake::new(choice.name()) }))
    }));
    let mut failing = failing.unwrap();
    failing.start(RenderRequest::new(job(2), other_cpu(), Plan::samples(100)));
    let status = failing.wait_until_over();
    assert!(matches!(status.phase, Phase::Failed(_)), "{status:?}");
    changes_nothing(&failing, &[PAUSE, RESUME, STOP]);
    assert_eq!(failing.finish(), Some(expected(status.samples_per_pixel)));
}

#[test]
fn requests_before_the_first_render_are_not_kept_for_it() {
    let mut progressive = Progressive::with_factory(super::common::factory()).unwrap();
    changes_nothing(&progressive, &[PAUSE, RESUME, STOP]);
    assert_eq!(progressive.status(), Status::default());
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(8)));
    assert_eq!(progressive.wait_until_over().phase, Phase::Done(EndReason::Samples));
    assert_eq!(progressive.finish(), Some(expected(8)));
}
