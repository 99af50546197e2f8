//! What reaches the render thread and its backends: requests to cancel, views, films, renderers, and what is told of them.

use super::common::{CPU, FAILING, Fake, PATIENCE, expected, job, other_cpu, started, wait_for, wait_until};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use weekender::backends::BackendError;
use weekender::film::Film;
use weekender::progressive::{EndReason, Phase, Picture, Plan, Progressive, RenderRequest, Stop, View};
use weekender::render::{BackendInfo, RenderError, RenderJob, Renderer, Stats, TileOccupancy};
use weekender::render_gpu::GpuError;
use weekender::stages::Transfer;

/// Prepares until it is cancelled; `ended` is told whether it was.
struct Preparing {
    begun: Sender<()>,
    ended: Sender<bool>,
}

impl Renderer for Preparing {
    fn info(&self) -> BackendInfo {
        Fake::new("preparing").info()
    }

    fn prepare(&mut self, _: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        let _ = self.begun.send(());
        let begin = Instant::now();
        while !cancel.load(Ordering::Relaxed) && begin.elapsed() < PATIENCE {
            std::thread::yield_now();
        }
        let _ = self.ended.send(cancel.load(Ordering::Relaxed));
        Err(RenderError::Cancelled)
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        _: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        Err(RenderError::Cancelled)
    }
}

#[test]
fn nobody_waits_for_a_preparation_whose_render_is_abandoned() {
    for (is_pending, is_followed) in [(false, false), (false, true), (true, false), (true, true)] {
        let ((begun, has_begun), (ended, has_ended)) = (channel(), channel());
        let progressive = Progressive::with_factory(Box::new(move |choice| {
            if *choice == FAILING {
                return Ok(Box::new(Preparing { begun: begun.clone(), ended: ended.clone() }));
            }
            Ok(Box::new(Fake::new(choice.name())))
        }));
        let mut progressive = progressive.unwrap();
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
            assert_eq!(progressive.finish(), Some(expected(4)));
        } else {
            progressive.abandon();
            wait_until(&progressive, |status| status.phase == Phase::Idle);
            assert_eq!(progressive.finish(), None);
        }
        assert_eq!(has_ended.recv_timeout(PATIENCE), Ok(true), "pending: {is_pending}");
    }
}

#[test]
fn a_pending_backend_that_panics_is_told_and_can_be_tried_again() {
    let mut is_first = true;
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        assert!(*choice == CPU || !std::mem::take(&mut is_first), "no such backend");
        Ok(Box::new(Fake::new(choice.name())))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 2);
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| !status.messages.is_empty());
    let status = progressive.status();
    assert_eq!(status.messages, ["its preparation ended by a panic; the cpu continues"]);
    assert_eq!(status.given_up, ["reference"]);
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| status.contributions.len() == 2);
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(progressive.finish(), Some(expected(status.samples_per_pixel)));
}

#[test]
fn what_preparing_took_adds_up() {
    const PREPARATION: Duration = Duration::from_millis(20);
    let progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Fake { preparation: PREPARATION, ..Fake::new(choice.name()) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 2);
    let first = progressive.status().prepare;
    assert!(first >= PREPARATION, "{first:?}");
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| status.contributions.len() == 2);
    let both = progressive.status().prepare;
    assert!(both >= first + PREPARATION, "{both:?} after {first:?}");
}

/// Rejects one of the samples of each index.
struct Rejecting;

impl Renderer for Rejecting {
    fn info(&self) -> BackendInfo {
        Fake::new("cpu").info()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn tile_occupancy(&self) -> Option<TileOccupancy> {
        Some(tiles())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        let rejected = range.end - range.start;
        film.record(range, rejected)?;
        Ok(Stats { rejected, ..Stats::default() })
    }
}

fn tiles() -> TileOccupancy {
    TileOccupancy { side: 1, columns: 2, tiles: vec![[1, 4], [2, 4], [3, 4], [4, 4]] }
}

#[test]
fn rejected_samples_and_the_occupancy_of_tiles_are_told() {
    let progressive = Progressive::with_factory(Box::new(|_| Ok(Box::new(Rejecting))));
    let mut progressive = progressive.unwrap();
    progressive.set_view(View::Occupancy);
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(8)));
    let status = progressive.wait_until_over();
    assert_eq!((status.rejected_samples, status.stats.rejected), (8, 8));
    let shown = View::Occupancy.resolve(&job(2).new_film(), Transfer::Gamma2, Some(&tiles()));
    assert_eq!(picture(&progressive).rgb8, shown);
}

/// The next picture.
fn picture(progressive: &Progressive) -> Picture {
    progressive.ask_for_picture();
    let begin = Instant::now();
    loop {
        if let Some(picture) = progressive.newest_picture() {
            return picture;
        }
        assert!(begin.elapsed() < PATIENCE, "no picture: {:?}", progressive.status());
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_film_that_stays_as_it_is_is_shown_again_only_in_another_view() {
    let mut progressive = started(CPU, Plan::samples(64));
    progressive.wait_until_over();
    let film = expected(64);
    assert_eq!(picture(&progressive).rgb8, film.to_rgb8(Transfer::Gamma2));
    progressive.ask_for_picture();
    let (seen, is_seen) = channel();
    progressive.inspect(move |_| seen.send(()).unwrap());
    is_seen.recv_timeout(PATIENCE).unwrap();
    assert_eq!(progressive.newest_picture(), None);
    let view = View::Luminance([-8.0, 4.0]);
    progressive.set_view(view.clone());
    assert_eq!(picture(&progressive).rgb8, view.resolve(&film, Transfer::Gamma2, None));
    // A render that starts anew keeps the view.
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(4)));
    progressive.wait_until_over();
    // What was asked for before may have been answered after its first pass.
    let shown =
        std::iter::repeat_with(|| picture(&progressive)).find(|picture| picture.samples_per_pixel == 4);
    let picture = shown.unwrap();
    assert_eq!(picture.run, 2);
    assert_eq!(picture.rgb8, view.resolve(&expected(4), Transfer::Gamma2, None));
}

#[test]
fn the_film_of_a_render_that_is_over_is_taken_once_and_its_end_stays() {
    let progressive = started(CPU, Plan::samples(8));
    progressive.wait_until_over();
    assert_eq!(progressive.take_film(), Some(expected(8)));
    assert_eq!(progressive.take_film(), None);
    assert_eq!(progressive.status().phase, Phase::Done(EndReason::Samples));
}

#[test]
fn a_film_that_needs_no_more_samples_needs_no_backend() {
    for (stop, reason) in [
        (Stop::at_samples(8), EndReason::Samples),
        (Stop { seconds: Some(0.0), ..Stop::at_samples(9) }, EndReason::TimeLimit),
    ] {
        let mut progressive =
            Progressive::with_factory(Box::new(|_| Err(BackendError::Gpu(GpuError::None)))).unwrap();
        let request = RenderRequest::new(job(2), CPU, Plan::until(stop));
        progressive.start(RenderRequest { film: Some(expected(8)), ..request });
        let status = progressive.wait_until_over();
        assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(reason), 8));
        assert!(status.given_up.is_empty() && status.contributions.is_empty(), "{:?}", status.messages);
        assert_eq!(progressive.finish(), Some(expected(8)));
    }
}

#[test]
fn a_renderer_that_is_given_is_used_and_kept_for_the_next_render() {
    let made = Arc::new(Mutex::new(Vec::new()));
    let noted = Arc::clone(&made);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        noted.lock().unwrap().push(choice.words());
        Ok(Box::new(Fake::new(choice.name())))
    }));
    let mut progressive = progressive.unwrap();
    let mut who = |request: RenderRequest| -> Vec<&'static str> {
        progressive.start(request);
        let status = progressive.wait_until_over();
        status.contributions.into_iter().map(|part| part.backend.name).collect()
    };
    let request = |choice| RenderRequest::new(job(2), choice, Plan::samples(4));
    let renderer: Option<Box<dyn Renderer>> = Some(Box::new(Fake::new("given")));
    assert_eq!(who(RenderRequest { renderer, ..request(CPU) }), ["given"]);
    assert_eq!(who(request(CPU)), ["given"]);
    assert_eq!(who(request(other_cpu())), ["cpu"]);
    assert_eq!(who(request(other_cpu())), ["cpu"]);
    assert_eq!(*made.lock().unwrap(), ["the CPU"], "only once");
}

#[test]
fn a_watch_sees_the_render_and_ends_with_it() {
    let mut progressive = Progressive::with_factory(super::common::factory()).unwrap();
    let looks = AtomicU32::new(0);
    let status =
        progressive.watch(RenderRequest::new(job(2), CPU, Plan::endless()), |progressive, status| {
            looks.fetch_add(1, Ordering::Relaxed);
            if status.samples_per_pixel >= 2 {
                progressive.stop();
            }
        });
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    assert!(looks.load(Ordering::Relaxed) >= 2 && status.samples_per_pixel >= 2, "{status:?}");
    // A render whose film is taken away is over, too.
    let status = progressive.watch(RenderRequest::new(job(2), CPU, Plan::endless()), |progressive, _| {
        progressive.take_film();
    });
    assert_eq!((status.phase, status.run), (Phase::Idle, 2));
}

#[test]
fn a_point_of_the_history_names_its_backend_and_has_the_error_of_its_samples() {
    // The reference fails after sample 16.
    let progressive = started(FAILING, Plan::samples(100));
    let history = progressive.wait_until_over().history;
    for point in &history {
        let backend = if point.samples_per_pixel <= 16 { "reference" } else { "cpu" };
        assert_eq!(point.backend, backend, "{point:?}");
        let error = expected(point.samples_per_pixel).error().unwrap();
        assert_eq!((point.rmse_estimate, point.rel_mse_estimate), (error.rmse, error.rel_mse), "{point:?}");
    }
    let of = |name: &str| history.iter().filter(|point| point.backend == name).count();
    assert_eq!([of("reference"), of("cpu")], [4, 2], "{history:?}");
}
