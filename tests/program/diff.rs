//! Recorded paths of the backends, and `weekender diff`, which compares two of them.

use crate::common::gpu::{gpu, job_of, jobs};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use weekender::comparison::diff::{Pair, PathComparison};
use weekender::film::Film;
use weekender::job::render::{RenderJob, Renderer, SamplerKind, Stats};
use weekender::render_cpu::{Isa, PathRecord, record_path};
use weekender::render_gpu::GpuOptions;
use weekender::scene::builtin::BuiltinScene;
use weekender::stages::SurfaceRule;

fn rendered(renderer: &mut dyn Renderer, job: &RenderJob, samples: std::ops::Range<u64>) -> (Film, Stats) {
    let mut film = job.new_film();
    let stats = renderer.accumulate(job, samples, &mut film, &AtomicBool::new(false)).unwrap();
    (film, stats)
}

fn pixels(job: &RenderJob) -> impl Iterator<Item = [u32; 2]> + use<> {
    let (width, height) = (job.settings().width, job.settings().height);
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

fn compare(job: &RenderJob, paths: [&PathRecord; 2], tolerance: f64) -> PathComparison {
    Pair { job, names: ["first", "second"], paths, tolerance }.compare()
}

#[test]
fn gpu_records_match_film() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    let (scene, camera) = (BuiltinScene::ALL[0].build)();
    let halves = job_of(&scene, camera, [12, 7], 24, SamplerKind::Sobol, true);
    let independent = job_of(&scene, camera, [12, 7], 24, SamplerKind::Independent, true);
    let more = [("two halves".to_owned(), halves), ("independent".to_owned(), independent)];
    for (name, job) in jobs(12, 7).into_iter().chain(more) {
        for sample in [0, 37] {
            let (before, stats) = rendered(&mut gpu, &job, sample..sample + 1);
            let mut rays = 0;
            for (number, pixel) in pixels(&job).enumerate() {
                let record = gpu.record_path(&job, pixel, sample).unwrap();
                assert_eq!(record.radiance, before.pixel_sum(number).radiance(), "{name} {pixel:?} {sample}");
                let last = record.rays.last().and_then(|ray| ray.hit).and_then(|hit| hit.position);
                assert_eq!(last, None, "{name}: the path ends");
                rays += record.rays.len() as u64;
            }
            assert_eq!(rays, stats.rays, "{name}");
            let (after, _) = rendered(&mut gpu, &job, sample..sample + 1);
            assert_eq!(before, after, "{name}: recording changes nothing");
        }
    }
}

#[test]
fn gpu_and_cpu_record_same_paths() {
    let Some(mut gpu) = gpu(GpuOptions::default()) else { return };
    for (name, job) in jobs(16, 9) {
        if job.rules().surface != SurfaceRule::Exact {
            // These stages show rounding errors on purpose.
            continue;
        }
        let mut parted = 0;
        for pixel in pixels(&job) {
            let on_gpu = gpu.record_path(&job, pixel, 2).unwrap();
            let on_cpu = record_path(&job, pixel, 2, Isa::available().last().copied());
            parted += usize::from(compare(&job, [&on_cpu, &on_gpu], 1e-2).first.is_some());
        }
        assert!(parted <= 4, "{name}: {parted} of 144 paths part");
    }
}

/// Exit code, standard output and messages.
fn diff(arguments: &[&str]) -> (i32, String, String) {
    let mut command = crate::common::program::weekender(Path::new("."), &[&["diff"], arguments].concat());
    let (code, text, errors) = crate::common::program::outcome(&command.output().unwrap());
    (code.unwrap(), text, errors)
}

#[test]
fn difference_is_found_and_marked() {
    let sides = ["--scene", "book", "--sides", "portable,reference"];
    let (code, found, errors) = diff(&[&sides[..], &["--find", "2"]].concat());
    assert_eq!(code, 1, "{errors}");
    for part in ["▶ ", "≠", "is allowed", "the paths diverge", "verdict", "cpu portable", "reference, f64"]
    {
        assert!(found.contains(part), "{part}: {found}");
    }
    assert!(!found.contains('\x1b'), "no colours in a file");
    // The line "again" leads to the same path.
    let again = found.lines().find_map(|line| line.strip_prefix("again")).unwrap();
    let (code, repeated, _) = diff(&[&sides[..], &again.split_whitespace().collect::<Vec<_>>()].concat());
    assert_eq!(code, 1);
    let paths = |text: &str| text.split_once("\n\n").unwrap().1.to_owned();
    assert_eq!(paths(&found), paths(&repeated));
}

#[test]
fn sides_agree_to_the_bit_or_within_tolerance() {
    let (code, text, errors) = diff(&["--sides", "cpu,cpu", "--pixel", "400,220", "--sample", "7"]);
    assert_eq!(code, 0, "{errors}");
    assert!(text.contains("the paths agree to the bit"), "{text}");
    let pair = ["--sides", "cpu,reference", "--pixel", "400,220"];
    let (code, text, errors) = diff(&pair);
    assert_eq!(code, 0, "{text}{errors}");
    assert!(text.contains("the paths agree: the largest difference is"), "{text}");
    assert_eq!(diff(&[&pair[..], &["--tolerance", "0"]].concat()).0, 1);
}

#[test]
fn json_has_both_paths() {
    let (code, json, text) = diff(&["--sides", "cpu,reference", "--pixel", "5,6", "--json", "-"]);
    assert_eq!(code, 0);
    assert!(text.contains("verdict"), "{text}");
    let report: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(report["pixel"], serde_json::json!([5, 6]));
    assert!(report["first"].is_null());
    for side in 0..2 {
        assert!(report["sides"][side]["path"]["rays"][0]["origin"][0].is_number(), "{json}");
    }
}

#[test]
fn incomparable_sides_are_refused() {
    let cases: [(&[&str], &[&str]); 5] = [
        (&[], &["--pixel"]),
        (&["--pixel", "800,0", "--sides", "cpu,reference"], &["800,0", "799,449"]),
        (&["--pixel", "1,1", "--sides", "cpu"], &["portable, reference, gpu"]),
        (
            &["--pixel", "1,1", "--sides", "cpu,reference", "--adapter", "x"],
            &["--adapter", "the side gpu in --sides"],
        ),
        (&["--pixel", "1,1", "--sides", "cpu,reference", "--json", "nowhere/a.json"], &["nowhere/a.json"]),
    ];
    let at = tempfile::tempdir().unwrap();
    for (arguments, parts) in cases {
        crate::common::program::refused(at.path(), &[&["diff"], arguments].concat(), parts);
    }
}

/// The companion shows the end of a command's output. Both sides are the same on every processor.
#[test]
fn companion_output_is_current() {
    let page = include_str!("../../docs/compare.md");
    let command = page.lines().find_map(|line| line.strip_prefix("weekender diff --seed")).unwrap();
    let words = command.split('#').next().unwrap().split_whitespace();
    let arguments: Vec<&str> = std::iter::once("--seed").chain(words).collect();
    let block = page.split("```\n").find(|block| block.starts_with("ray ")).unwrap();
    let (code, text, errors) = diff(&arguments);
    assert_eq!(code, 1, "{errors}");
    assert!(text.ends_with(block), "{text}");
}
