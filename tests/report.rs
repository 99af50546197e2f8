//! `weekender report`: its files, how it resumes after an interruption, and what it refuses.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn command(arguments: &[&str], directory: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    command.arg("report").args(arguments).current_dir(directory).stdin(Stdio::null());
    command
}

fn report(arguments: &[&str], directory: &Path) -> (i32, String, String) {
    let mut command = command(&[&["--progress", "off"], arguments].concat(), directory);
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

const SMALL: [&str; 12] = [
    "--out",
    "found",
    "--scenes",
    "three-spheres",
    "--size",
    "48x27",
    "--seeds",
    "4",
    "--max-samples",
    "32",
    "--time-limit",
    "600",
];

fn data(at: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(at.join("found/report.json")).unwrap()).unwrap()
}

/// The raw runs of a report, and the denoised ones.
fn runs(found: &serde_json::Value) -> (Vec<&serde_json::Value>, Vec<&serde_json::Value>) {
    let is_raw = |run: &&serde_json::Value| !run["backend"].as_str().unwrap().ends_with("denoised");
    found["runs"].as_array().unwrap().iter().partition(is_raw)
}

#[test]
fn report_has_files_and_plausible_figures() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let (code, text, errors) =
        report(&[&SMALL[..], &["--backends", "cpu,portable", "--target", "0.02"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    assert!(text.contains("error-vs-time.png"), "{text}");
    let data_found = data(at);
    let (runs, denoised) = runs(&data_found);
    assert_eq!((runs.len(), denoised.len()), (2 * 2 * 4, 2 * 4));
    for run in &runs {
        let points = run["points"].as_array().unwrap();
        let samples: Vec<u64> = points.iter().map(|p| p["samples"].as_u64().unwrap()).collect();
        assert_eq!(samples, [1, 2, 4, 8, 16, 32]);
        let of = |point: usize, key: &str| points[point][key].as_f64().unwrap();
        // With 16 times as many samples, true and estimated errors are at least 3 times smaller.
        for key in ["mse", "mse_estimate", "rel_mse"] {
            assert!(of(5, key) < of(1, key) / 9.0, "{key}: {} to {}", of(1, key), of(5, key));
        }
        assert!(of(5, "flip") < of(0, "flip") && of(5, "wall_seconds") >= of(5, "trace_seconds"));
        assert_eq!(of(5, "rejected"), 0.0);
        let ratio = (of(5, "mse_estimate") / of(5, "mse")).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    let rounding = data_found["rounding"].as_array().unwrap();
    assert_eq!(rounding.len(), 2);
    assert!(
        rounding
            .iter()
            .all(|row| row["rms"].as_f64().unwrap() < 1e-3 && row["bias"].as_f64().unwrap().abs() < 1e-4)
    );

    let csv = fs::read_to_string(at.join("found/report.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 16 * 6 + 8 * 5);
    let fields = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == fields));
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    for part in [
        "| cpu | sobol |",
        "| to RMSE 0.02 | to RMSE 0.01 | to RMSE 0.001 |",
        "Sobol points against",
        "Is the error estimate accurate",
        "The effect of rounding",
        "weekender report --progress",
    ] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(image::open(at.join("found/error-vs-time.png")).unwrap().width() > 500);
    assert!(fs::read_to_string(at.join("found/error-vs-time.svg")).unwrap().contains("cpu, sobol"));
}

#[test]
fn baseline_has_own_curve() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let (code, _, errors) =
        report(&[&SMALL[..], &["--backends", "cpu,c89", "--samplers", "independent"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    let found = data(at);
    let (runs, _) = runs(&found);
    // Independent samples of the same picture have the same error on every backend: compares all runs at 32 samples.
    let mean = |backend: &str| {
        let of = runs.iter().filter(|run| run["backend"] == backend);
        let errors: Vec<f64> = of.map(|run| run["points"][5]["mse"].as_f64().unwrap()).collect();
        assert_eq!(errors.len(), 4, "{backend}");
        errors.iter().sum::<f64>() / 4.0
    };
    let ratio = mean("c89") / mean("cpu");
    assert!((0.85..1.18).contains(&ratio), "{ratio}");
    assert!(found["calibration"].as_array().unwrap().iter().all(|row| row["backend"] == "cpu"));
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    assert!(table.contains("times c89") && table.contains("| c89 | independent |"), "{table}");
    // Without a compiler there is no baseline, which is an error if it was asked for.
    let failing = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .args(["report", "--out", "other", "--backends", "c89"])
        .env("CC", "no-such-compiler")
        .current_dir(at)
        .output()
        .unwrap();
    let message = String::from_utf8(failing.stderr).unwrap();
    assert_eq!(failing.status.code(), Some(2), "{message}");
    assert!(message.contains("no-such-compiler") && message.contains("CC"), "{message}");
}

#[test]
fn calibration_compares_estimates_with_errors() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let small =
        ["--out", "found", "--calibration", "--size", "48x27", "--max-samples", "32", "--seeds", "12"];
    let (code, _, errors) =
        report(&[&small[..], &["--scenes", "three-spheres", "--backends", "cpu"]].concat(), at);
    assert_eq!(code, 0, "{errors}");
    let found = data(at);
    assert_eq!(found["settings"]["reference_samples"], 512);
    let rows = found["calibration"].as_array().unwrap();
    let what: Vec<_> =
        rows.iter().map(|row| (row["sampler"].as_str().unwrap(), row["samples"].as_u64().unwrap())).collect();
    assert_eq!(what, [("independent", 16), ("independent", 32), ("sobol", 16), ("sobol", 32)]);
    for row in rows {
        let of = |key: &str| row[key].as_f64().unwrap();
        assert_eq!(of("seeds"), 12.0);
        assert!((of("predicted_rmse") / of("actual_rmse") - of("ratio")).abs() < 1e-9, "{row}");
        // The deviation is itself uncertain, hence 4 deviations, but at least a hundredth.
        assert!(
            (of("ratio") - 1.0).abs() < 4.0 * of("deviation").max(0.01) && of("deviation") < 0.05,
            "{row}"
        );
    }
    let table = fs::read_to_string(at.join("found/report.md")).unwrap();
    assert!(table.contains("4 of 4 ratios are within 1 ± 0.05"), "{table}");
    // A single half gives no estimate to check.
    let (code, _, message) = report(&[&small[..], &["--estimate-error", "off"]].concat(), at);
    assert_eq!(code, 2, "{message}");
    assert!(message.contains("--estimate-error") && message.contains("--calibration"), "{message}");
}

#[test]
fn report_resumes() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let sobol = [&SMALL[..], &["--backends", "cpu", "--samplers", "sobol"]].concat();
    assert_eq!(report(&sobol, at).0, 0);
    let first = data(at);
    // More curves with the same settings: existing ones stay the same bit for bit, even their times.
    let both = [&SMALL[..], &["--backends", "cpu", "--samplers", "sobol,independent"]].concat();
    assert_eq!(report(&both, at).0, 0);
    let second = data(at);
    assert_eq!(runs(&second).0.len(), 8);
    assert_eq!(second["runs"].as_array().unwrap()[..8], first["runs"].as_array().unwrap()[..]);
    // A missing run is measured again, with the saved reference.
    let mut cut = second.clone();
    cut["runs"].as_array_mut().unwrap().truncate(6);
    fs::write(at.join("found/report.json"), cut.to_string()).unwrap();
    let kept = fs::metadata(at.join("found/reference-three-spheres.exr")).unwrap().modified().unwrap();
    assert_eq!(report(&sobol, at).0, 0);
    let third = data(at);
    assert_eq!(third["runs"].as_array().unwrap().len(), 8);
    assert_eq!(third["runs"][6]["points"][5]["mse"], first["runs"][6]["points"][5]["mse"]);
    assert_eq!(fs::metadata(at.join("found/reference-three-spheres.exr")).unwrap().modified().unwrap(), kept);
}

#[test]
fn changed_scene_is_measured_again() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let scene = |radius: &str| {
        let camera = "[camera]\nlook_from = [0, 0, 3]\nlook_at = [0, 0, 0]\nvfov_degrees = 40\n";
        let material = "{ kind = \"lambertian\", albedo = [0.5, 0.5, 0.5] }";
        let sphere = format!("[[spheres]]\ncenter = [0, 0, 0]\nradius = {radius}\nmaterial = {material}\n");
        let render = "[render]\nsampler = \"independent\"\n";
        fs::write(at.join("ball.toml"), format!("{camera}{render}{sphere}")).unwrap();
    };
    let usual = ["--backends", "cpu", "--samplers", "sobol", "--reference-backend", "cpu"];
    let arguments = [&SMALL[..2], &["--scenes", "ball.toml"], &SMALL[4..], &usual[..]].concat();
    let run = || {
        let (code, _, errors) = report(&arguments, at);
        assert_eq!(code, 0, "{errors}");
        data(at)["runs"].clone()
    };
    scene("1");
    let first = run();
    assert_eq!(run(), first);
    scene("0.9");
    let second = run();
    assert_eq!(second.as_array().unwrap().len(), 8);
    assert_ne!(second[0]["points"][5]["mse"], first[0]["points"][5]["mse"]);
}

#[cfg(unix)]
mod interrupted {
    use super::{command, report};
    use std::fs;
    use std::io::{BufRead, BufReader, Read};
    use std::path::Path;
    use std::process::{Command, Stdio};
    use std::sync::atomic::AtomicBool;
    use tempfile::TempDir;
    use weekender::backends::{BackendChoice, create};
    use weekender::film::{FilmFile, PixelSum, checkpoint};
    use weekender::job::recipe::file::parse;

    /// A reference with many samples, and little else.
    fn long() -> Vec<&'static str> {
        let flags = "--out found --scenes three-spheres --size 48x27 --seeds 1 --max-samples 2 --time-limit 600 \
                     --backends cpu --samplers sobol --reference-backend cpu --reference-samples 16384";
        flags.split(' ').collect()
    }

    /// Starts a report and presses Ctrl-C while its reference is rendered. Returns the saved film.
    fn interrupted_reference(directory: &Path, film: &Path, samples: u64) -> FilmFile {
        // Try again if the key was pressed before the first pass or after the last.
        for _ in 0..30 {
            let mut command = command(&[&["--progress", "on"], long().as_slice()].concat(), directory);
            let mut child = command.stderr(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
            // The first line appears when the reference starts.
            let mut stderr = BufReader::new(child.stderr.take().unwrap());
            let mut line = String::new();
            stderr.read_line(&mut line).unwrap();
            assert!(line.contains("reference of three-spheres"), "{line}");
            Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
            let mut rest = String::new();
            stderr.read_to_string(&mut rest).unwrap();
            let code = child.wait().unwrap().code().unwrap();
            match checkpoint::load(film) {
                Ok(kept) if kept.film.sample_count() < samples => {
                    assert!(code == 130 && rest.contains("run the same command again"), "{code}: {rest}");
                    return kept;
                }
                Ok(_) => fs::remove_dir_all(directory.join("found")).unwrap(),
                Err(_) => {}
            }
        }
        panic!("no reference was caught half-made");
    }

    #[test]
    fn interrupted_reference_resumes() {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let path = at.join("found/reference-three-spheres.exr");
        let kept = interrupted_reference(at, &path, 16_384);
        let (code, _, errors) = report(&long(), at);
        assert_eq!(code, 0, "{errors}");
        let whole = checkpoint::load(&path).unwrap();
        let job = parse(whole.description.recipe(), "the reference").unwrap().job().unwrap();
        let mut uninterrupted = job.new_film();
        let mut renderer = create(&BackendChoice::named("cpu", None).unwrap()).unwrap();
        renderer.accumulate(&job, 0..16_384, &mut uninterrupted, &AtomicBool::new(false)).unwrap();
        assert!(whole.film == uninterrupted, "{} and {}", kept.film.samples(), whole.film.samples());

        // With the saved samples zeroed, the result only contains the missing ones.
        let mut black = kept.film.clone();
        black.halves_mut().iter_mut().flatten().for_each(|sum| *sum = PixelSum::default());
        checkpoint::save(&path, &black, &kept.description).unwrap();
        let (code, _, errors) = report(&long(), at);
        assert_eq!(code, 0, "{errors}");
        let rest = checkpoint::load(&path).unwrap().film;
        assert_eq!(rest.samples(), uninterrupted.samples());
        for (half, sums) in rest.halves().iter().enumerate() {
            for (pixel, sum) in sums.iter().enumerate() {
                let mut both = *sum;
                both.add(kept.film.halves()[half][pixel]);
                assert_eq!(both, uninterrupted.halves()[half][pixel], "half {half}, pixel {pixel}");
            }
        }
    }
}

#[test]
fn bad_requests_fail_before_rendering() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("file"), "").unwrap();
    let cases: [(&[&str], &[&str]); 6] = [
        (&[], &["--out"]),
        (&["--out", "file"], &["file", "choose another"]),
        (&["--out", "o", "--scenes", "three-sphere"], &["three-sphere", "three-spheres"]),
        (&["--out", "o", "--scenes", "book,metals,book"], &["two scenes called book", "leave one out"]),
        (&["--out", "o", "--backends", "cpu,tpu"], &["tpu", "scalar", "c89"]),
        (&["--out", "o", "--backends", "cpu", "--adapter", "x"], &["--adapter", "gpu"]),
    ];
    for (arguments, parts) in cases {
        let (code, text, message) = report(arguments, at);
        assert_eq!((code, text.as_str()), (2, ""), "{arguments:?}: {message}");
        for part in parts {
            assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
        }
    }
}
