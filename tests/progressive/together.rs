//! Several renderers at work on one film, of which some fail.

use super::common::{Fake, Forgetful, Spoiling, Waiting, expected, job};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::channel;
use weekender::backends::Together;
use weekender::render::{BackendInfo, RenderError, Renderer};

#[test]
fn a_member_that_spoils_its_film_leaves_all_its_samples_to_the_others() {
    let (spoilt, is_spoilt) = channel();
    // The other member takes the rest only once the film is spoilt.
    let cpu = Waiting { fake: Fake::new("cpu"), signal: Some(is_spoilt) };
    let gpu = Spoiling { spoilt: Some(spoilt), ..Spoiling::new("gpu") };
    let mut together = Together::new(vec![Box::new(cpu), Box::new(gpu)]);
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    assert!(film == expected(64));
    let credits: Vec<_> =
        together.credits(64).into_iter().map(|(info, samples)| (info.name, samples)).collect();
    assert_eq!(credits, [("cpu", 64)]);
}

#[test]
fn a_pass_that_is_cancelled_says_so() {
    let mut together = Together::new(vec![Box::new(Fake::new("cpu")), Box::new(Fake::new("gpu"))]);
    let mut film = job(2).new_film();
    let outcome = together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(true));
    assert!(matches!(outcome, Err(RenderError::Cancelled)), "{outcome:?}");
    assert!(film == job(2).new_film());
}

#[test]
fn when_every_member_has_failed_none_is_left() {
    let fake = |name| -> Box<dyn Renderer> { Box::new(Fake { fails_at: Some(0), ..Fake::new(name) }) };
    let mut together = Together::new(vec![fake("cpu"), fake("gpu")]);
    let mut film = job(2).new_film();
    let outcome = together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false));
    assert!(matches!(outcome, Err(RenderError::Backend { .. })), "{outcome:?}");
    assert!(film == job(2).new_film());
    let nobody = BackendInfo { name: "none", device: String::new(), lanes: 0, threads: 0 };
    assert_eq!(together.info(), nobody);
}

#[test]
fn a_member_that_adds_nothing_is_left_out() {
    let mut together = Together::new(vec![Box::new(Forgetful), Box::new(Fake::new("gpu"))]);
    let mut film = job(2).new_film();
    together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false)).unwrap();
    assert!(film == expected(64));
    let lost = "cpu failed: it did not add the samples that it was to trace";
    assert_eq!(together.take_messages(), [format!("{lost}; gpu continues the same picture")]);
    assert_eq!(together.info().name, "gpu");

    let mut together = Together::new(vec![Box::new(Forgetful)]);
    let outcome = together.accumulate(&job(2), 0..64, &mut job(2).new_film(), &AtomicBool::new(false));
    assert_eq!(outcome.unwrap_err().to_string(), lost);
}

#[test]
fn members_add_up_what_they_have_traced() {
    let mut together = Together::new(vec![Box::new(Fake::new("cpu")), Box::new(Fake::new("gpu"))]);
    let mut film = job(2).new_film();
    for range in [0..30, 30..30, 30..64] {
        let samples = range.end - range.start;
        let stats = together.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
        // Four paths and eight rays for each sample, whoever traced it.
        assert_eq!((stats.paths, stats.rays), (4 * samples, 8 * samples));
        assert_eq!(together.credits(0).iter().map(|(_, added)| added).sum::<u64>(), samples);
    }
    assert!(film == expected(64));
    let again = together.accumulate(&job(2), 60..66, &mut film, &AtomicBool::new(false));
    assert!(matches!(again, Err(RenderError::Film(_))), "{again:?}");
    assert!(film == expected(64));
}
