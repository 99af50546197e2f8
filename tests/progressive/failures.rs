//! Failures and panics of backends.

use super::common::{CPU, FAILING, Fake, Forgetful, expected, job, other_cpu, started, wait_for};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use weekender::backends::{BackendChoice, Together};
use weekender::progressive::{EndReason, Phase, Plan, Progressive, RenderRequest};
use weekender::recipe::Recipe;
use weekender::render::{BackendInfo, RenderError, RenderSettings, Renderer};
use weekender::render_cpu::{CpuOptions, CpuRenderer};

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
        let fake = Fake { pause: Duration::ZERO, fails_at: Some(8), ..Fake::new("cpu") };
        Ok(Box::new(fake) as Box<dyn Renderer>)
    };
    let mut progressive = Progressive::with_factory(Box::new(fails)).unwrap();
    progressive.start(RenderRequest::new(job(2), other_cpu(), Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert!(matches!(&status.phase, Phase::Failed(reason) if reason.contains("pulled out")), "{status:?}");
    assert_eq!(progressive.finish(), Some(expected(8)));
}

#[test]
fn a_panic_keeps_the_film_and_another_backend_goes_on() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        let panics_at = (*choice == CPU).then_some(16);
        Ok(Box::new(Fake { panics_at, ..Fake::new(choice.name()) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(100)));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    let [message] = status.messages.as_slice() else { unreachable!("{:?}", status.messages) };
    assert!(message.contains("a slip of the tracer") && message.contains("continues"), "{message}");
    assert_eq!(progressive.finish(), Some(expected(100)));
}

#[test]
fn a_panic_of_every_backend_leaves_the_film_of_the_last_whole_pass() {
    let asked = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&asked);
    let progressive = Progressive::with_factory(Box::new(move |choice| {
        seen.lock().unwrap().push(choice.words());
        Ok(Box::new(Fake { panics_at: Some(16), ..Fake::new(choice.name()) }))
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
        Ok(Box::new(Fake::new(choice.name())))
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

#[test]
fn samples_that_were_asked_for_and_not_added_are_missed() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        let fake = Fake { pause: Duration::ZERO, ..Fake::new(choice.name()) };
        Ok(if *choice == CPU { Box::new(Forgetful) as Box<dyn Renderer> } else { Box::new(fake) })
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(64)));
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Samples));
    assert!(status.messages.iter().any(|said| said.contains("trace 64 samples")), "{:?}", status.messages);
    assert_eq!(progressive.finish(), Some(expected(64)));
}

#[test]
fn a_member_that_panics_leaves_its_samples_to_the_others() {
    let fake = |name, panics_at| -> Box<dyn Renderer> { Box::new(Fake { panics_at, ..Fake::new(name) }) };
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", Some(4))]);
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    assert!(film == expected(64));
    let said = together.take_messages().join("; ");
    assert!(said.contains("a slip of the tracer") && said.contains("cpu continues"), "{said}");
}

#[test]
fn members_are_described_and_credited_together() {
    let fake = |name, fails_at| -> Box<dyn Renderer> { Box::new(Fake { fails_at, ..Fake::new(name) }) };
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", None)]);
    let BackendInfo { name, threads, .. } = together.info();
    assert_eq!((name, threads), ("cpu,gpu", 2));
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    let credits = together.credits(64);
    assert_eq!(credits.iter().map(|(_, samples)| samples).sum::<u64>(), 64);
    assert_eq!(credits.iter().map(|(info, _)| info.name).collect::<Vec<_>>(), ["cpu", "gpu"]);
    // Who has failed has a share in the samples until then, but not in later ones.
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", Some(48))]);
    let mut film = job(2).new_film();
    for range in [0..64, 64..128] {
        together.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
        let sum: u64 = together.credits(64).iter().map(|(_, samples)| samples).sum();
        assert_eq!(sum, 64);
    }
    // Who fails before its first sample has no share in the picture.
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", Some(0))]);
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    let credits: Vec<_> =
        together.credits(64).into_iter().map(|(info, samples)| (info.name, samples)).collect();
    assert_eq!(credits, [("cpu", 64)]);
}

#[test]
fn what_is_said_after_every_pass_is_told_once() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(Fake { message: Some("a layer is too thin"), ..Fake::new(choice.name()) }))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::samples(64)));
    assert_eq!(progressive.wait_until_over().messages, ["a layer is too thin"]);
}

/// A panic of the real tracer in the middle of a tile.
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
        // The next attempt works.
        renderer.accumulate(&job, 6..40, &mut film, &never).unwrap();
        let mut whole = job.new_film();
        CpuRenderer::new(CpuOptions::default()).unwrap().accumulate(&job, 0..40, &mut whole, &never).unwrap();
        assert!(film == whole);
    }
}
