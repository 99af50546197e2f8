//! The stiff scenes: the small ones on every class of CPU arithmetic, a third of them on the GPU, and the program around them.

use crate::common::program::{json_file, outcome, refused, weekender};
use std::sync::atomic::AtomicBool;
use weekender::backends::BackendChoice;
use weekender::job::recipe::Recipe;
use weekender::measure::Candidate;
use weekender::measure::stress::{Case, Suite, cases};
use weekender::render_cpu::{CpuOptions, Isa};
use weekender::render_gpu::GpuOptions;

/// The best levels with and without fused multiply and add.
fn levels() -> Vec<Candidate> {
    let available = Isa::available();
    let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
    let backend = |isa: Isa| {
        let options = CpuOptions { isa: Some(isa), threads: Some(1), ..CpuOptions::default() };
        Candidate::new(isa.name(), BackendChoice::Cpu(options))
    };
    best(true).into_iter().chain(best(false)).map(backend).collect()
}

fn gpu() -> Option<Candidate> {
    let gpu = crate::common::gpu::gpu(GpuOptions::default())?;
    let options = GpuOptions::of_adapter(Some(&gpu.adapter().name));
    Some(Candidate::new("gpu", BackendChoice::Gpu(options)))
}

fn suite(mut tracers: Vec<Candidate>) -> Suite {
    tracers.push(Candidate::new("f64", BackendChoice::Reference { threads: Some(1) }));
    Suite::new(tracers)
}

/// Fewer samples suffice, because an error in these cases affects many of them.
fn small(case: &Case) -> Case {
    let mut case = case.clone();
    case.recipe.samples_per_pixel = case.recipe.samples_per_pixel.min(8);
    if let Some(other) = &mut case.twin {
        other.samples_per_pixel = case.recipe.samples_per_pixel;
    }
    case
}

/// The faults in these cases.
fn wrong<'a>(mut suite: Suite, cases: impl Iterator<Item = &'a Case>) -> Vec<String> {
    let mut wrong = Vec::new();
    for case in cases {
        let report = suite.run(&small(case), &AtomicBool::new(false));
        for measured in report.measured.iter().filter(|measured| !measured.verdict.is_right()) {
            let reason = measured.verdict.reason();
            wrong.push(format!("{} {} {}: {reason}", case.id, measured.backend, measured.form));
        }
    }
    wrong
}

fn small_cases() -> impl Iterator<Item = &'static Case> {
    cases().iter().filter(|case| {
        let Recipe { settings, scene, samples_per_pixel, .. } = &case.recipe;
        scene.spheres.len() <= 1000 && settings.width * settings.height <= 400 && *samples_per_pixel <= 32
    })
}

#[test]
fn small_cases_are_right_on_every_level() {
    let wrong = wrong(suite(levels()), small_cases());
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn some_small_cases_are_right_on_the_gpu() {
    let Some(gpu) = gpu() else { return };
    // A software adapter is slow. Ties are only tested by both orders of two copies.
    let chosen = |(index, case): &(usize, &'static Case)| index % 3 == 0 || case.id.starts_with("copies/");
    let wrong = wrong(suite(vec![gpu]), small_cases().enumerate().filter(chosen).map(|(_, case)| case));
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn book_threshold_breaks_small_scenes() {
    let mut suite = suite(levels());
    for id in ["scaled/1e-3", "cavity/white-touching-of-1e-3"] {
        let case = cases().iter().find(|case| case.id == id).unwrap();
        let report = suite.run(&small(case), &AtomicBool::new(false));
        assert!(report.book.iter().all(|book| !book.verdict.is_right()), "{id}: {:#?}", report.book);
    }
}

#[test]
fn program_prints_a_table_and_writes_json() {
    let directory = tempfile::tempdir().unwrap();
    let flags = ["stress", "--filter", "shells/1", "--json", "figures.json", "--progress", "off"];
    let (code, text, _) = outcome(&weekender(directory.path(), &flags).output().unwrap());
    assert!(text.contains("shells/1 ") && text.contains("book's f32, f64"), "{text}");
    let figures = json_file(&directory.path().join("figures.json"));
    let cases = figures["cases"].as_array().unwrap();
    let verdicts: Vec<_> = cases.iter().flat_map(|case| case["measured"].as_array().unwrap()).collect();
    let are_right = verdicts.iter().all(|measured| measured["verdict"] == "right");
    assert_eq!(code, Some(i32::from(!are_right)), "{text}");
    assert_eq!(cases[0]["id"], "shells/1");
    assert_eq!(cases[0]["measured"][0]["mean"], 0.5);
}

#[test]
fn unknown_cases_and_adapters_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let families = "\"nothing-like-it\"; use one of the families copies, shifts";
    refused(directory.path(), &["stress", "--filter", "nothing-like-it"], &[families]);
    let adapter = ["stress", "--adapter", "no such adapter", "--filter", "shells/1"];
    refused(directory.path(), &adapter, &["adapter"]);
}
