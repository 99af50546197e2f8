//! Several renderers working on one film, where some fail.

use super::common::{Fake, PATIENCE, expected, forgetful, job, scripted, spoiling};
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use weekender::backends::Together;
use weekender::film::Film;
use weekender::job::render::{BackendInfo, Control, Outcome, RenderError, Renderer, Stats};

fn fake(name: &'static str, fails_at: Option<u64>) -> Box<dyn Renderer> {
    Box::new(Fake { fails_at, ..Fake::new(name) })
}

/// Traces nothing before it has received a signal.
fn waiting(name: &'static str, signal: Receiver<()>) -> Box<dyn Renderer> {
    let mut signal = Some(signal);
    scripted(name, move |fake, range, film, cancel| {
        if let Some(signal) = signal.take() {
            signal.recv_timeout(PATIENCE).unwrap();
        }
        fake.accumulate(&job(2), range, film, cancel)
    })
}

/// Adds samples to a film. Returns the statistics, and who added how many of them.
fn traced(together: &mut Together, range: Range<u64>, film: &mut Film) -> (Stats, Vec<(BackendInfo, u64)>) {
    let outcome = together.advance(&job(2), range, film, &Control::new(&AtomicBool::new(false)));
    let Ok(Outcome::Added { stats, credits }) = outcome else { panic!("{outcome:?}") };
    (stats, credits)
}

/// The film of 64 samples and who added how many of them.
fn rendered(together: &mut Together) -> (Film, Vec<(&'static str, u64)>) {
    let mut film = job(2).new_film();
    let (_, credits) = traced(together, 0..64, &mut film);
    (film, credits.into_iter().map(|(info, samples)| (info.name, samples)).collect())
}

#[test]
fn samples_of_all_members_add_up() {
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", None)]);
    let BackendInfo { name, threads, .. } = together.info();
    assert_eq!((name, threads), ("cpu,gpu", 2));
    let mut film = job(2).new_film();
    for range in [0..30, 30..30, 30..64] {
        let samples = range.end - range.start;
        let (stats, credits) = traced(&mut together, range, &mut film);
        // Four paths and eight rays for each sample, whoever traced it.
        assert_eq!((stats.paths, stats.rays), (4 * samples, 8 * samples));
        assert_eq!(credits.iter().map(|(_, added)| added).sum::<u64>(), samples);
    }
    assert!(film == expected(64));
    let again = together.accumulate(&job(2), 60..66, &mut film, &AtomicBool::new(false));
    assert!(matches!(again, Err(RenderError::Film(_))), "{again:?}");
    let cancelled = together.accumulate(&job(2), 64..66, &mut film, &AtomicBool::new(true));
    assert!(matches!(cancelled, Err(RenderError::Cancelled)), "{cancelled:?}");
    assert!(film == expected(64));
}

#[test]
fn a_member_that_fails_leaves_its_samples_to_the_others() {
    // One has a share until it fails, but not if it fails before its first sample.
    let mut together = Together::new(vec![fake("cpu", None), fake("gpu", Some(48))]);
    let (film, credits) = rendered(&mut together);
    assert!(film == expected(64));
    assert_eq!(credits.iter().map(|(_, samples)| samples).sum::<u64>(), 64);
    for broken in [
        fake("gpu", Some(0)),
        Box::new(Fake { panics_at: Some(0), ..Fake::new("gpu") }),
        scripted("gpu", |_, _, _, _| Ok(Stats::default())),
    ] {
        // The other one begins only once it has failed.
        let (called, is_called) = channel();
        let mut broken = broken;
        let gpu = scripted("gpu", move |_, range, film, cancel| {
            called.send(()).unwrap();
            broken.accumulate(&job(2), range, film, cancel)
        });
        let mut together = Together::new(vec![waiting("cpu", is_called), gpu]);
        let (film, credits) = rendered(&mut together);
        assert!(film == expected(64));
        assert_eq!(credits, [("cpu", 64)]);
        let said = together.take_messages();
        assert!(
            said.len() == 1 && said[0].starts_with("gpu failed") && said[0].contains("cpu continues"),
            "{said:?}"
        );
        assert_eq!(together.info().name, "cpu");
    }
}

#[test]
fn spoiling_member_leaves_its_samples_to_the_others() {
    let (spoilt, is_spoilt) = channel();
    // The other member takes the rest only once the film is spoilt.
    let cpu = waiting("cpu", is_spoilt);
    let gpu = spoiling("gpu", move || spoilt.send(()).unwrap());
    let (film, credits) = rendered(&mut Together::new(vec![cpu, gpu]));
    assert!(film == expected(64));
    assert_eq!(credits, [("cpu", 64)]);
}

#[test]
fn film_is_unchanged_when_every_member_fails() {
    for members in [vec![fake("cpu", Some(0)), fake("gpu", Some(0))], vec![forgetful()]] {
        let mut together = Together::new(members);
        let mut film = job(2).new_film();
        let outcome = together.accumulate(&job(2), 0..64, &mut film, &AtomicBool::new(false));
        assert!(matches!(outcome, Err(RenderError::Backend { .. })), "{outcome:?}");
        assert!(film == job(2).new_film());
        assert_eq!(together.info().name, "none");
    }
}
