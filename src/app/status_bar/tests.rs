//! Tests of the status bar.

use super::*;
use crate::film::ErrorEstimate;
use crate::job::render::Stats;
use egui_kittest::Harness;
use std::time::Duration;

fn part(name: &'static str, device: &str, samples_per_pixel: u64) -> Contribution {
    let backend = BackendInfo { name, device: device.to_owned(), lanes: 16, threads: 2 };
    Contribution { backend, samples_per_pixel }
}

/// The status of a film with these contributions.
fn status_of(contributions: Vec<Contribution>) -> Status {
    Status {
        run: 3,
        phase: Phase::Tracing,
        backend: contributions.last().map(|part| part.backend.clone()),
        samples_per_pixel: contributions.iter().map(|part| part.samples_per_pixel).sum(),
        stats: Stats { paths: 1_000_000, rays: 2_560_000, ..Stats::default() },
        trace: Duration::from_secs(2),
        error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 1e-5, rel_mse: 0.0 }),
        contributions,
        ..Status::default()
    }
}

fn parts() -> [Contribution; 3] {
    let gpu = "A Graphics Adapter With Quite a Name (discrete, Vulkan, driver 550.54 (of a vendor))";
    [part("cpu", "avx2", 100), part("gpu", gpu, 200), part("reference", "f64", 20)]
}

const STOP: Stop = Stop { samples: None, seconds: None, noise: Some(0.002) };

fn of(status: &Status) -> Bar<'_> {
    Bar {
        status,
        stop: STOP,
        is_paused: false,
        speed: status.paths_per_second(),
        seconds_before: Some(0.0),
        next: None,
    }
}

#[test]
fn the_figures_are_those_of_the_status() {
    let mut status = status_of(parts()[..1].to_vec());
    (status.stats.busy_lanes, status.stats.offered_lanes) = (3, 4);
    let texts: Vec<String> = figures(&of(&status)).into_iter().map(|(text, ..)| text).collect();
    let figures = ["tracing", "100 spp", "2.0 s", "0.5 Mpaths/s", "2.56 rays/path", "16 lanes 75 % full"];
    assert_eq!(texts[..6], figures);
    assert!(texts[6].starts_with("error 0.00400, 0.002 in about"), "{texts:?}");
}

#[test]
fn what_a_film_does_not_say_is_no_zero() {
    let status =
        Status { stats: Stats::default(), trace: Duration::ZERO, ..status_of(parts()[..1].to_vec()) };
    let figures = figures(&of(&status));
    assert_eq!((figures[3].0.as_str(), figures[4].0.as_str()), ("– Mpaths/s", "– rays/path"));
    assert!(!figures[3].2.contains("average"), "{}", figures[3].2);
}

#[test]
fn rejected_samples_stand_out() {
    let colour = |rejected_samples| {
        let status = Status { rejected_samples, ..Status::default() };
        let harness = Harness::new_ui(|ui| rejected(ui, &status));
        let colour = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) => text.galley.job.sections.first().map(|part| part.format.color),
            _ => None,
        });
        colour.unwrap()
    };
    assert_ne!(colour(0), colour(1));
}

#[test]
fn every_phase_has_its_word_and_a_pause_is_told_where_something_could_go_on() {
    let done = || Phase::Done(crate::progressive::EndReason::Samples);
    for (phase, word, paused) in [
        (Phase::Idle, "preparing", "preparing"),
        (Phase::Preparing, "preparing", "preparing"),
        (Phase::Tracing, "tracing", "paused"),
        (Phase::Paused, "paused", "paused"),
        (done(), "done", "paused"),
        (Phase::Failed("no memory".to_owned()), "failed", "failed"),
    ] {
        assert_eq!([false, true].map(|is_paused| phase_word(&phase, is_paused)), [word, paused], "{phase:?}");
    }
}
