//! The stiff scenes: the quick ones on every class of CPU arithmetic, and the program around them.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

mod exact;

use std::process::Command;
use std::sync::atomic::AtomicBool;
use weekender::backends::BackendChoice;
use weekender::measure::Candidate;
use weekender::measure::stress::{Case, Expected, Suite, cases};
use weekender::render_cpu::{CpuOptions, Isa};

fn suite() -> Suite {
    let available = Isa::available();
    let best = |is_fused: bool| available.iter().copied().rfind(|isa| isa.is_fused() == is_fused);
    let backend = |isa: Isa| {
        let options = CpuOptions { isa: Some(isa), threads: Some(1), ..CpuOptions::default() };
        Candidate::backend(isa.name(), BackendChoice::Cpu(options))
    };
    let reference = Candidate::backend("f64", BackendChoice::Reference { threads: Some(1) });
    Suite::new(best(true).into_iter().chain(best(false)).map(backend).chain([reference]).collect())
}

/// Fewer samples suffice, because an error in these cases affects many of them.
fn small(case: &Case) -> Case {
    let mut case = case.clone();
    case.recipe.samples_per_pixel = case.recipe.samples_per_pixel.min(8);
    if let Expected::Same(other) = &mut case.expected {
        other.samples_per_pixel = case.recipe.samples_per_pixel;
    }
    case
}

#[test]
fn quick_cases_are_right_on_every_level() {
    let (mut suite, go_on) = (suite(), AtomicBool::new(false));
    let mut wrong = Vec::new();
    for case in cases().iter().filter(|case| case.is_quick) {
        let report = suite.run(&small(case), &go_on);
        for measured in report.measured.iter().filter(|measured| !measured.verdict.is_right()) {
            wrong.push(format!(
                "{} {} {}: {}",
                case.id,
                measured.backend,
                measured.form,
                measured.verdict.reason()
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn book_threshold_breaks_small_scenes() {
    let (mut suite, go_on) = (suite(), AtomicBool::new(false));
    for id in ["scaled/1e-3", "cavity/white-touching-of-1e-3"] {
        let case = cases().iter().find(|case| case.id == id).unwrap();
        let report = suite.run(&small(case), &go_on);
        assert!(report.book.iter().all(|book| !book.verdict.is_right()), "{id}: {:#?}", report.book);
    }
}

fn weekender(arguments: &[&str]) -> std::process::Output {
    Command::new(env!("CARGO_BIN_EXE_weekender")).arg("stress").args(arguments).output().unwrap()
}

#[test]
fn program_prints_a_table_and_writes_json() {
    let directory = tempfile::tempdir().unwrap();
    let json = directory.path().join("figures.json");
    let arguments = ["--filter", "shells/1", "--json", json.to_str().unwrap()];
    let output = weekender(&[&arguments[..], &["--progress", "off"]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("shells/1 ") && text.contains("book's f32, f64"), "{text}");
    let figures: serde_json::Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let cases = figures["cases"].as_array().unwrap();
    let verdicts: Vec<_> = cases.iter().flat_map(|case| case["measured"].as_array().unwrap()).collect();
    let are_right = verdicts.iter().all(|measured| measured["verdict"] == "right");
    assert_eq!(output.status.code(), Some(i32::from(!are_right)), "{text}");
    assert_eq!(cases[0]["id"], "shells/1");
    assert_eq!(cases[0]["measured"][0]["mean"], 0.5);
}

#[test]
fn unknown_cases_and_adapters_are_refused() {
    let output = weekender(&["--filter", "nothing-like-it"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("\"nothing-like-it\"; use one of the families copies, shifts"), "{error}");
    let output = weekender(&["--adapter", "no such adapter", "--filter", "shells/1"]);
    assert_eq!(output.status.code(), Some(2), "{:?}", String::from_utf8(output.stderr));
}
