//! Films, pictures and samples that pass between render, renderer and user.

use super::common::{
    CPU, FAILING, Fake, PATIENCE, PAUSE, expected, film, idle, job, other_cpu, parts, picture, said,
    scripted, started, started_with, stopped, usual, wait_for, wait_until,
};
use std::ops::Range;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use weekender::film::Film;
use weekender::job::render::Renderer;
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest, Stop, View};
use weekender::render_gpu::GpuError;
use weekender::stages::Transfer;

#[test]
fn another_backend_continues_the_same_film() {
    let progressive = started(CPU, Plan::samples(3000));
    for (backend, at) in [(other_cpu(), 4), (CPU, 100), (FAILING, 500), (other_cpu(), 600)] {
        wait_for(&progressive, at);
        progressive.switch_backend(backend);
    }
    let status = progressive.wait_until_over();
    assert_eq!(parts(&status).iter().map(|(_, samples)| samples).sum::<u64>(), 3000);
    assert_eq!(progressive.take_film(), Some(expected(3000)));
}

/// The pass in progress does not spoil it.
#[test]
fn a_render_that_is_replaced_hands_its_film_over() {
    let mut progressive = started(CPU, Plan::endless());
    for width in [3, 2] {
        wait_for(&progressive, 100);
        let (sender, receiver) = channel();
        progressive.hand_over(move |film, status| sender.send((film, status.samples_per_pixel)).unwrap());
        progressive.start(RenderRequest::new(job(width), CPU, Plan::endless()));
        let (film, samples) = receiver.recv_timeout(PATIENCE).unwrap();
        assert!(samples >= 100 && film.sample_count() == samples, "{samples}");
        assert!(film.width() != 2 || film == expected(samples));
    }
}

/// A user changes their mind while the other backend is still being made.
#[test]
fn switching_back_calls_the_switch_off() {
    let (made, is_made) = channel();
    let progressive = started_with(CPU, Plan::endless(), move |choice| {
        if *choice != CPU {
            std::thread::sleep(Duration::from_millis(50));
            made.send(()).unwrap();
        }
        Box::new(Fake::new(choice.name()))
    });
    wait_for(&progressive, 2);
    progressive.switch_backend(FAILING);
    progressive.switch_backend(CPU);
    is_made.recv_timeout(PATIENCE).unwrap();
    let samples = progressive.status().samples_per_pixel;
    wait_for(&progressive, samples + 2000);
    assert_eq!(parts(&stopped(progressive)).len(), 1);
}

#[test]
fn a_pause_adds_what_the_device_holds() {
    let traced = Arc::new(Mutex::new(0));
    let count = Arc::clone(&traced);
    // With short passes, samples accumulate while the test waits.
    let plan = Plan { pass_target: PAUSE, ..Plan::endless() };
    let progressive = started_with(CPU, plan, move |choice| {
        let fake = Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) };
        let count = Arc::clone(&count);
        let add = move |range: &Range<u64>, _| *count.lock().unwrap() += range.end - range.start;
        fake.holding(u32::MAX, add)
    });
    for more in [64, 512] {
        let first = *traced.lock().unwrap();
        wait_until(&progressive, |_| *traced.lock().unwrap() >= first + more);
        progressive.pause();
        wait_until(&progressive, |status| status.phase == Phase::Paused);
        // All traced samples are in the film and are reported.
        let held = *traced.lock().unwrap();
        let status = progressive.status();
        assert_eq!((status.samples_per_pixel, status.stats.paths), (held, 4 * held));
        progressive.resume();
    }
    assert_eq!(stopped(progressive).samples_per_pixel, *traced.lock().unwrap());
}

/// A render of a film that holds samples.
fn continued(film: Film, plan: Plan) -> Progressive {
    let mut progressive = idle(usual);
    progressive.start(RenderRequest { film: Some(film), ..RenderRequest::new(job(2), CPU, plan) });
    progressive
}

#[test]
fn gaps_of_a_film_are_filled() {
    let progressive = continued(film([3..5, 10..30]), Plan::samples(100));
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.stats.paths), (100, (100 - 22) * 4));
    assert_eq!(progressive.take_film(), Some(expected(100)));

    // Ten of the twelve samples 8..20 are new, and thirteen others stay.
    let plan = |samples| Plan { first_sample: 8, ..Plan::samples(samples) };
    let progressive = continued(film([0..3, 12..14, 1000..1010]), plan(20));
    let status = progressive.wait_until_over();
    assert_eq!((status.planned_samples_per_pixel, status.samples_per_pixel), (25, 25));
    assert_eq!(parts(&status), [("cpu", 10)]);
    // A longer plan begins where the first one did.
    progressive.set_plan(plan(30));
    wait_for(&progressive, 35);
    assert_eq!(progressive.wait_until_over().planned_samples_per_pixel, 35);
    assert_eq!(progressive.take_film().unwrap().samples().to_string(), "0..3, 8..30, 1000..1010");
}

#[test]
fn a_film_that_needs_no_more_samples_needs_no_backend() {
    for (stop, reason) in [
        (Stop::at_samples(8), EndReason::Samples),
        (Stop { seconds: Some(0.0), ..Stop::at_samples(9) }, EndReason::TimeLimit),
    ] {
        let mut progressive = Progressive::with_factory(Box::new(|_| Err(GpuError::None.into()))).unwrap();
        let request = RenderRequest::new(job(2), CPU, Plan::until(stop));
        progressive.start(RenderRequest { film: Some(expected(8)), ..request });
        let status = progressive.wait_until_over();
        assert_eq!((status.phase, status.samples_per_pixel), (Phase::Done(reason), 8));
        assert!(status.given_up.is_empty(), "{:?}", status.messages);
        assert_eq!(progressive.take_film(), Some(expected(8)));
    }
}

/// A point for each power of two that the film's samples have passed, even where they never are one, with the time of
/// its own samples.
#[test]
fn the_history_misses_no_power_of_two() {
    let status = continued(film(std::iter::once(1000..1003)), Plan::samples(128)).wait_until_over();
    let history: Vec<u64> = status.history.iter().map(|point| point.samples_per_pixel).collect();
    // The passes end at 2, 4, 8 ... of the plan, to which the film has 3 more.
    assert_eq!(history, [5, 11, 19, 35, 67, 131]);
    for point in &status.history {
        let least = PAUSE.as_secs_f64() * (point.samples_per_pixel - 3) as f64;
        assert!(point.trace_seconds >= least, "{point:?} before {least} s");
    }
    assert_eq!(status.history.last().map(|point| point.trace_seconds), Some(status.trace.as_secs_f64()));
}

/// A pass of many samples by a fast backend can take a slow one minutes.
#[test]
fn another_backend_begins_with_short_passes() {
    for fails in [false, true] {
        let passes = Arc::new(Mutex::new(Vec::new()));
        let noted = Arc::clone(&passes);
        let progressive = started_with(CPU, Plan::endless(), move |choice| {
            if *choice == CPU {
                let fails_at = fails.then_some(4096);
                return Box::new(Fake { pause: Duration::ZERO, fails_at, ..Fake::new("cpu") });
            }
            let noted = Arc::clone(&noted);
            scripted("cpu", move |fake, range, film, cancel| {
                noted.lock().unwrap().push(range.end - range.start);
                fake.accumulate(&job(2), range, film, cancel)
            })
        });
        wait_for(&progressive, 4096);
        if !fails {
            progressive.switch_backend(other_cpu());
        }
        wait_until(&progressive, |_| passes.lock().unwrap().len() >= 4);
        progressive.take_film();
        let passes = passes.lock().unwrap();
        assert_eq!(passes[0], 2, "{passes:?}");
        assert!(passes.windows(2).all(|pair| pair[1] <= 2 * pair[0]), "{passes:?}");
    }
}

#[test]
fn given_renderer_is_used_and_kept() {
    let made = Arc::new(Mutex::new(Vec::new()));
    let noted = Arc::clone(&made);
    let mut progressive = idle(move |choice| {
        noted.lock().unwrap().push(choice.words());
        Box::new(Fake::new(choice.name()))
    });
    let mut who = |request: RenderRequest| {
        progressive.start(request);
        parts(&progressive.wait_until_over())[0].0
    };
    let request = |choice| RenderRequest::new(job(2), choice, Plan::samples(4));
    let renderer: Option<Box<dyn Renderer>> = Some(Box::new(Fake::new("given")));
    assert_eq!(who(RenderRequest { renderer, ..request(CPU) }), "given");
    assert_eq!(
        [who(request(CPU)), who(request(other_cpu())), who(request(other_cpu()))],
        ["given", "cpu", "cpu"]
    );
    assert_eq!(*made.lock().unwrap(), ["the CPU"], "only once");
}

#[test]
fn film_is_shown_on_request_and_again_only_in_another_view() {
    let mut progressive = started(CPU, Plan::samples(64));
    progressive.wait_until_over();
    assert_eq!(progressive.newest_picture(), None);
    assert_eq!(picture(&progressive, 64).rgb8, expected(64).to_rgb8(Transfer::Gamma2));
    progressive.ask_for_picture();
    let (seen, is_seen) = channel();
    progressive.inspect(move |film| seen.send(film.clone()).unwrap());
    assert_eq!(is_seen.recv_timeout(PATIENCE).unwrap(), expected(64));
    assert_eq!(progressive.newest_picture(), None);
    let view = View::Luminance([-8.0, 4.0]);
    progressive.set_view(view.clone());
    assert_eq!(picture(&progressive, 64).rgb8, view.resolve(&expected(64), Transfer::Gamma2));
    // A restarted render keeps the view.
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(4)));
    progressive.wait_until_over();
    let picture = picture(&progressive, 4);
    assert_eq!(picture.run, 2);
    assert_eq!(picture.rgb8, view.resolve(&expected(4), Transfer::Gamma2));
}

/// The first picture is worth waiting for the device's samples.
#[test]
fn the_first_picture_is_collected() {
    let mut progressive = idle(|choice| Fake::new(choice.name()).holding(1000, |_, _| ()));
    progressive.ask_for_picture();
    let plan = Plan { pass_target: PAUSE, ..Plan::endless() };
    progressive.start(RenderRequest::new(job(2), CPU, plan));
    wait_for(&progressive, 2);
    progressive.stop();
    progressive.wait_until_over();
    assert_eq!(progressive.newest_picture().map(|picture| picture.width), Some(2));
}

#[test]
fn a_preview_is_smooth_and_has_no_error() {
    let film = expected(4);
    let transfer = Transfer::Gamma2;
    let shown = |preview: Option<u64>, view: View| {
        let progressive = started(CPU, Plan { preview, ..Plan::samples(4) });
        progressive.set_view(view);
        let first = progressive.wait_until_over().history.first().map(|point| point.samples_per_pixel);
        (picture(&progressive, 4).rgb8, first)
    };
    assert_ne!(film.smoothed().to_rgb8(transfer), film.to_rgb8(transfer), "there is noise to smooth");
    assert_eq!(shown(Some(4), View::Picture), (film.smoothed().to_rgb8(transfer), None));
    assert_eq!(shown(None, View::Picture), (film.to_rgb8(transfer), Some(2)));
    assert_eq!(shown(Some(4), View::Exposed(1.0)).0, film.smoothed().exposed(transfer, 1.0));
    // Heat maps are not smoothed.
    let view = View::Luminance([-8.0, 4.0]);
    assert_eq!(shown(Some(4), view.clone()).0, view.resolve(&film, transfer));
}

#[test]
fn status_describes_the_current_backend() {
    const PREPARATION: Duration = Duration::from_millis(20);
    let progressive = started_with(CPU, Plan::endless(), |choice| {
        let fake = Fake::new(choice.name()).preparing_for(PREPARATION);
        Box::new(Fake { message: Some("a layer is too thin"), ..fake })
    });
    wait_for(&progressive, 2);
    let first = progressive.status();
    assert!(first.prepare >= PREPARATION, "{first:?}");
    progressive.switch_backend(FAILING);
    wait_until(&progressive, |status| status.contributions.len() == 2);
    let status = stopped(progressive);
    assert!(status.prepare >= first.prepare + PREPARATION, "{status:?}");
    let names =
        [first.backend.clone(), status.backend.clone()].map(|backend| backend.map(|backend| backend.name));
    assert_eq!(names, [Some("cpu"), Some("reference")]);
    // The history of a backend ends where the other one takes over.
    let last = status.history.iter().rfind(|point| point.backend == "cpu");
    assert_eq!(last.map(|point| point.samples_per_pixel), Some(parts(&status)[0].1));
    assert_eq!(said(&status), ["a layer is too thin"], "only once");

    // A backend can give up a thread during use.
    let progressive = started_with(CPU, Plan::samples(8), |_| {
        scripted("cpu", |fake, range, film, cancel| {
            fake.threads += 1;
            fake.accumulate(&job(2), range, film, cancel)
        })
    });
    let status = progressive.wait_until_over();
    assert!(status.backend.is_some_and(|backend| backend.threads > 1));
}
