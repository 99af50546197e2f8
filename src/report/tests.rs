//! Everything that a report makes of measurements, which are made up.

use super::*;
use crate::backends::BackendChoice;
use crate::cli::ProgressChoice;

use crate::render_cpu::CpuOptions;
use data::{Measured, ReferenceUsed, Rounding, Run};
use std::path::PathBuf;
use tempfile::TempDir;

/// Numbers of 0 to 1 that are the same in every run.
fn noise(index: u64) -> f64 {
    let x = (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// A picture of a curve with this number of samples. No scene is like another.
fn measured(scene: u32, curve: u32, seed: u32, samples: u64) -> Measured {
    let picture = u64::from((scene * 8 + curve) * 8 + seed);
    let noise = |which: u64| noise((picture * 128 + samples) * 4 + which);
    let seconds = 0.01 * f64::from((scene + 1) * (curve + 1)) * samples as f64 * (0.9 + 0.2 * noise(0));
    // The picture with the most samples is better than its reference in one case.
    let mse = 0.04 / f64::from(4 * scene + 1) / samples as f64 * (0.8 + 0.4 * noise(1))
        - if samples == 64 { 7e-4 } else { 0.0 };
    Measured {
        samples,
        trace_seconds: seconds,
        wall_seconds: 1.125 * seconds,
        device_seconds: (curve == 3).then_some(0.75 * seconds),
        mse,
        rel_mse: 3.0 * mse,
        flip: 0.25 * noise(2),
        mse_estimate: (curve > 0 && samples > 1).then_some(mse.abs() * (0.9 + 0.2 * noise(3))),
        rejected: u64::from(seed == 1),
    }
}

/// A small picture.
pub(super) fn small() -> Recipe {
    let mut recipe = Recipe::find("metals").unwrap();
    (recipe.settings.width, recipe.settings.height) = (16, 9);
    recipe
}

/// One thread of the CPU, which panics after so many tiles.
pub(super) fn cpu(panics_after: Option<u64>) -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { threads: Some(1), panics_after, ..CpuOptions::default() })
}

/// A place for a reference in a directory of its own.
pub(super) fn place() -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("reference.exr");
    (directory, path)
}

/// The settings of small, made-up reports.
pub(super) fn settings() -> Settings {
    Settings {
        software: "Weekender 1.2.3".to_owned(),
        size: (48, 27),
        seeds: 4,
        time_limit: 10.0,
        max_samples: 64,
        estimate_error: true,
        reference_samples: 512,
        reference: "cpu".to_owned(),
    }
}

/// The name of the second scene.
const OTHER: &str = "two, of \"three\"";

fn made_up() -> Data {
    let mut runs = Vec::new();
    let curves = [("c89", "independent"), ("cpu", "sobol"), ("cpu", "independent"), ("gpu", "sobol")];
    for (scene, name) in (0_u32..).zip(["book", OTHER]) {
        for (curve, (backend, sampler)) in (0_u32..).zip(curves) {
            for seed in 0..4_u32 {
                // Some pictures of the slowest end early.
                let most = if curve == 0 && seed > 1 { 5 } else { 7 };
                runs.push(Run {
                    curve: Curve {
                        scene: name.to_owned(),
                        backend: backend.to_owned(),
                        sampler: sampler.to_owned(),
                    },
                    seed,
                    about: format!("{backend} of a machine"),
                    prepare_seconds: 0.125,
                    points: (0..most).map(|power| measured(scene, curve, seed, 1 << power)).collect(),
                });
            }
        }
    }
    let rounding = |scene: &str, backend: &str, floor: Option<f64>| Rounding {
        scene: scene.to_owned(),
        backend: backend.to_owned(),
        samples: 64,
        bias: -1.5e-6,
        rms: 2.5e-3,
        floor,
        floor_limit: 3e-5,
    };
    let reference = ReferenceUsed {
        scene: "book".to_owned(),
        about: "cpu of a machine".to_owned(),
        samples: 512,
        mse: 1e-6,
        rel_mse: 2e-6,
    };
    let rounding = vec![
        rounding("book", "cpu", Some(0.03)),
        rounding("book", "gpu", None),
        rounding(OTHER, "cpu", Some(0.05)),
    ];
    Data { schema: SCHEMA, settings: settings(), references: vec![reference], runs, rounding }
}

#[test]
fn a_report_goes_on_only_with_the_same_settings() {
    let at = tempfile::tempdir().unwrap();
    let path = at.path().join("report.json");
    let data = made_up();
    write_json(&data, &JsonTarget::File(path.clone())).unwrap();
    assert_eq!(resumed(&path, &data.settings), Some(data.clone()));
    let other = Settings { max_samples: 128, ..data.settings.clone() };
    assert_eq!(resumed(&path, &other), None);
    let older = Data { schema: SCHEMA + 1, ..data.clone() };
    write_json(&older, &JsonTarget::File(path.clone())).unwrap();
    assert_eq!(resumed(&path, &data.settings), None);
    assert_eq!(resumed(&at.path().join("nothing.json"), &data.settings), None);
}

#[test]
fn what_was_measured_against_another_reference_is_discarded() {
    let mut data = made_up();
    let old = data.references[0].clone();
    let second = ReferenceUsed { scene: data.runs[16].curve.scene.clone(), ..old.clone() };
    data.take_references(vec![old.clone(), second.clone()]);
    assert_eq!((data.runs.len(), data.rounding.len()), (32, 3), "nothing is known to have changed");
    assert_eq!(data.references, [old.clone(), second.clone()]);
    let better = ReferenceUsed { samples: 1024, ..old };
    data.take_references(vec![better.clone()]);
    assert_eq!((data.runs.len(), data.rounding.len()), (16, 1));
    assert!(data.runs.iter().all(|run| run.curve.scene == second.scene));
    assert_eq!(data.rounding[0].scene, second.scene);
    assert_eq!(data.references, [better, second]);
}

#[test]
fn what_a_report_depends_on_is_in_its_settings() {
    let make = || ReferenceChoice::Make { name: "portable".to_owned(), choice: cpu(None), samples: 512 };
    let options = |reference| ReportOptions {
        scenes: vec![small()],
        backends: Vec::new(),
        samplers: vec![SamplerKind::Sobol],
        seeds: 3,
        size: (16, 9),
        time_limit: 2.5,
        max_samples: 64,
        estimate_error: false,
        targets: vec![0.01],
        reference,
        out: PathBuf::from("found"),
        progress: ProgressChoice::Off,
        command: "weekender report".to_owned(),
    };
    let expected = Settings {
        software: SOFTWARE.to_owned(),
        size: (16, 9),
        seeds: 3,
        time_limit: 2.5,
        max_samples: 64,
        estimate_error: false,
        reference_samples: 512,
        reference: "portable".to_owned(),
    };
    assert_eq!(super::settings(&options(make())), expected);
    let of_file = Settings { reference_samples: 0, reference: "given/a.exr".to_owned(), ..expected.clone() };
    assert_eq!(super::settings(&options(ReferenceChoice::File(PathBuf::from("given/a.exr")))), of_file);
    let with_estimates = ReportOptions { estimate_error: true, ..options(make()) };
    assert_eq!(super::settings(&with_estimates), Settings { estimate_error: true, ..expected });
}

#[test]
fn a_curve_has_its_own_sampler_and_each_of_its_pictures_its_own_seed() {
    let mut recipe = small();
    recipe.settings.max_depth = 7;
    for (sampler, seed, estimate_error) in
        [(SamplerKind::Sobol, 0, true), (SamplerKind::Independent, 5, false), (SamplerKind::Sobol, 2, false)]
    {
        let job = job(&recipe, sampler, seed, estimate_error).unwrap();
        let expected = RenderSettings { sampler, seed, estimate_error, ..recipe.settings };
        assert_eq!((*job.settings(), job.scene()), (expected, &*recipe.scene));
        let film = film(backends::create(&cpu(None)).unwrap().as_mut(), &job, 3).unwrap();
        assert_eq!(
            (film.samples().to_string(), film.halves().len()),
            ("0..3".to_owned(), job.settings().half_count())
        );
    }
}
