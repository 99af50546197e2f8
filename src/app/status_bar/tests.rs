//! Tests of the status bar.

use super::*;
use crate::app::tests::{facts_of, part as dressed, rest_at};
use crate::film::ErrorEstimate;
use crate::render::Stats;
use egui::Rect;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::time::Duration;

#[test]
fn the_prediction_follows_the_root_of_the_time() {
    let mut status = Status {
        samples_per_pixel: 100,
        phase: Phase::Tracing,
        trace: Duration::from_secs(1),
        error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 0.0, rel_mse: 0.0 }),
        ..Status::default()
    };
    let words = error_words(&status, Some(0.002));
    assert!(words.starts_with("error 0.00400, 0.002 in about 3 s ("), "{words}");
    assert_eq!(error_words(&status, None), "error 0.00400");
    assert_eq!(error_words(&status, Some(0.01)), "error 0.00400, below 0.01");
    status.samples_per_pixel = 1;
    assert_eq!(error_words(&status, Some(0.002)), "error 0.00400", "too early for a prediction");
    status.error = None;
    assert_eq!(error_words(&status, Some(0.01)), "error –");
}

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
fn a_film_that_was_opened_brings_its_time() {
    let status = status_of(parts()[..1].to_vec());
    for (seconds_before, text, help) in [
        (Some(0.0), "2.0 s", "pauses"),
        (Some(90.5), "92.5 s", "90.5 of them before this film was opened"),
        (None, "over 2.0 s", "does not say how many it took"),
    ] {
        let figures = figures(&Bar { seconds_before, ..of(&status) });
        assert_eq!(figures[2].0, text);
        assert!(figures[2].2.ends_with(help), "{}", figures[2].2);
    }
}

#[test]
fn nothing_in_the_bar_covers_anything_else() {
    for width in [480.0, 640.0, 800.0, 960.0, 1120.0, 1280.0, 1440.0, 1920.0] {
        for count in 0..=3 {
            let status = status_of(parts()[..count].to_vec());
            let harness = Harness::builder().with_size([width, 200.0]).build_ui(|ui| bar(ui, &of(&status)));
            let rects: Vec<(String, Rect)> = harness
                .get_all_by_role(egui::Role::Label)
                .map(|node| (node.value().unwrap_or_default(), node.rect()))
                .collect();
            assert!(rects.len() >= 7, "{rects:?}");
            for (index, (text, rect)) in rects.iter().enumerate() {
                assert!(rect.right() <= width + 0.5, "{width}: {text} ends at {}", rect.right());
                for (other, theirs) in &rects[..index] {
                    assert!(!rect.shrink(1.0).intersects(*theirs), "{width}: {text} covers {other}");
                }
            }
        }
    }
}

#[test]
fn who_traced_is_said_in_few_words() {
    let [cpu, gpu, _] = parts();
    let one = status_of(vec![cpu.clone()]);
    assert_eq!(who(&one, None), ["cpu avx2, 2 threads", "cpu avx2"]);
    assert_eq!(who(&one, Some(Device::Gpu))[1], "cpu avx2; GPU is being prepared");
    let done = Status { phase: Phase::Done(crate::progressive::EndReason::Samples), ..one };
    assert_eq!(who(&done, Some(Device::Gpu))[1], "cpu avx2; GPU is next");
    assert_eq!(
        who(&status_of(vec![cpu, gpu]), None),
        ["cpu avx2 33 % + gpu A Graphics Adapter With Quite a Name 67 %", "cpu 33 % + gpu 67 %"]
    );
    let one_thread = BackendInfo { threads: 1, ..part("cpu", "avx2", 1).backend };
    let alone = Contribution { backend: one_thread, samples_per_pixel: 1 };
    assert_eq!(who(&status_of(vec![alone]), None)[0], "cpu avx2, 1 thread");
}

#[test]
fn thousands_are_grouped() {
    assert_eq!(grouped(0), "0");
    assert_eq!(grouped(1234567), "1\u{a0}234\u{a0}567");
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
fn the_lanes_are_those_of_the_last_backend_that_has_packets() {
    let with = |name: &'static str, lanes: usize| {
        let Contribution { backend, samples_per_pixel } = part(name, "a device", 1);
        Contribution { backend: BackendInfo { lanes, ..backend }, samples_per_pixel }
    };
    let told = |parts: Vec<Contribution>| {
        let mut status = status_of(parts);
        (status.stats.busy_lanes, status.stats.offered_lanes) = (1, 4);
        figures(&of(&status)).into_iter().map(|(text, ..)| text).find(|text| text.contains("lanes"))
    };
    let (narrow, wide, gpu) = (with("cpu", 4), with("cpu", 16), with("gpu", 1));
    for (parts, expected) in [
        (vec![wide.clone(), narrow.clone()], Some("4 lanes 25 % full")),
        (vec![narrow.clone(), wide.clone()], Some("16 lanes 25 % full")),
        (vec![wide, narrow, gpu.clone()], Some("4 lanes 25 % full")),
        (vec![gpu], None),
    ] {
        assert_eq!(told(parts.clone()).as_deref(), expected, "{parts:?}");
    }
}

#[test]
fn a_chosen_device_is_next_until_it_traces_again() {
    let mut facts = facts_of("--stage metal");
    assert_eq!(next_device(&facts), None, "nothing has traced");
    for (chosen, next) in
        [(Device::Reference, None), (Device::Cpu, Some(Device::Cpu)), (Device::Gpu, Some(Device::Gpu))]
    {
        // The reference has traced last.
        facts.status = std::sync::Arc::new(status_of(parts().to_vec()));
        facts.model.remembered.device = chosen;
        assert_eq!(next_device(&facts), next);
    }
}

#[test]
fn the_bar_tells_what_the_window_knows() {
    let mut facts = facts_of("--stage metal --size 32x18 --samples 640");
    facts.status = std::sync::Arc::new(status_of(parts()[..1].to_vec()));
    (facts.speed, facts.seconds_before) = (None, None);
    let told = |facts: &Facts, text: &str| {
        let harness = dressed([2400.0, 200.0], |ui| super::ui(ui, facts));
        harness.query_by_label(text).is_some()
    };
    for text in ["tracing", "100 of 640 spp", "over 2.0 s", "0.5 Mpaths/s", "cpu avx2, 2 threads"] {
        assert!(told(&facts, text), "{text}");
    }
    (facts.speed, facts.seconds_before) = (Some(3e6), Some(90.5));
    facts.model.is_paused = true;
    facts.model.document.stop = Stop::default();
    facts.model.remembered.device = Device::Reference;
    let next = "cpu avx2, 2 threads; f64 is being prepared";
    for text in ["paused", "100 spp", "92.5 s", "3.0 Mpaths/s", next] {
        assert!(told(&facts, text), "{text}");
    }
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

#[test]
fn a_backend_is_told_before_it_has_traced_and_a_gpu_has_no_threads() {
    let [cpu, gpu, _] = parts();
    let first = Status { backend: Some(cpu.backend.clone()), ..Status::default() };
    assert_eq!(who(&first, None), ["cpu avx2"]);
    assert_eq!(who(&Status::default(), Some(Device::Gpu)), [""; 0], "nothing is known");
    let alone = "gpu A Graphics Adapter With Quite a Name";
    assert_eq!(who(&status_of(vec![gpu.clone()]), None), [alone]);
    let failed = Status { phase: Phase::Failed("no memory".to_owned()), ..status_of(vec![gpu.clone()]) };
    assert_eq!(who(&failed, Some(Device::Cpu)), [format!("{alone}; CPU is next")]);
    let three = vec![cpu, gpu, part("reference", "f64", 700)];
    assert_eq!(who(&status_of(three), None)[1], "cpu 10 % + gpu 20 % + reference 70 %");
}

#[test]
fn the_help_of_the_error_tells_its_doubt_and_its_deviation() {
    let status = status_of(parts()[..1].to_vec());
    assert!(error_help(&status).contains("the film, random deviation "), "{}", error_help(&status));
    assert!(error_help(&status).ends_with("no path has found yet."));
    let doubtful = Status { doubt: Some("few pixels".to_owned()), error: None, ..status };
    let help = error_help(&doubtful);
    assert!(help.ends_with("no path has found yet.\nDoubtful: few pixels."), "{help}");
    assert!(!help.contains("random deviation"), "{help}");
}
