//! The plain C program compiles without warnings, and its pictures equal ours apart from noise.

use std::process::Command;
use std::sync::atomic::AtomicBool;
use weekender::comparison::Picture;
use weekender::comparison::compare::compare;
use weekender::film::{Film, SampleRanges};
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderError, RenderJob, Renderer, SamplerKind};
use weekender::measure::baseline::{Baseline, FLAGS, SOURCE};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::Camera;
use weekender::scene::builtin::metals;
use weekender::stages::{Rules, Stage};

const WIDTH: u32 = 128;
const HEIGHT: u32 = 72;

#[test]
fn it_is_strict_c89_without_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let source = directory.path().join("rt_weekend.c");
    std::fs::write(&source, SOURCE).unwrap();
    let compiler = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    let mut words = compiler.split_whitespace();
    let output = Command::new(words.next().unwrap())
        .args(words)
        .args(FLAGS)
        .args(["-Werror", "-pedantic-errors", "-c", "-o"])
        .args([directory.path().join("rt_weekend.o"), source])
        .output()
        .expect("a C compiler is needed: install one or name it in CC");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn job(scene: &str) -> RenderJob {
    let mut recipe = Recipe::find(scene).unwrap();
    (recipe.settings.width, recipe.settings.height) = (WIDTH, HEIGHT);
    recipe.settings.sampler = SamplerKind::Independent;
    recipe.job().unwrap()
}

fn check(name: &str, job: &RenderJob, samples: u64) {
    let mut baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let go_on = AtomicBool::new(false);
    let half = samples / 2;
    // Each half of the film is a run of its own.
    let halves = [0..half, half..samples].map(|range| {
        let mut film = job.new_film();
        let stats = baseline.accumulate(job, range, &mut film, &go_on).unwrap();
        assert_eq!(stats.paths, half * u64::from(WIDTH * HEIGHT));
        assert!(stats.rays > stats.paths && !stats.trace.is_zero());
        film.halves()[0].clone()
    });
    let range = SampleRanges::from_ranges(std::iter::once(0..samples)).unwrap();
    let mut theirs = job.new_film();
    theirs.halves_mut().clone_from_slice(&halves);
    let theirs = theirs.with_samples(range, 0).unwrap();
    let mut ours = job.new_film();
    CpuRenderer::new(CpuOptions::default()).unwrap().accumulate(job, 0..samples, &mut ours, &go_on).unwrap();
    let side = |film| Picture::of_film(String::new(), String::new(), film);
    let found = compare(&side(theirs), &side(ours));
    println!("{name}: {:.3} x noise", found.times_noise());
    assert!(found.is_equal(), "{name}: {:?}", found.reasons);
}

/// Among them fuzz between 0 and 1, where a wrong exponent would show; at 0 and 1 it would not.
#[test]
fn pictures_are_the_same() {
    let of_book = job("three-spheres");
    check("three-spheres", &of_book, 256);
    check("book", &job("book"), 64);
    for fuzz in [0.25, 0.6] {
        let job =
            RenderJob::new(metals(fuzz, fuzz), Camera::BOOK, *of_book.settings(), Rules::FINISHED).unwrap();
        check(&format!("metals of fuzz {fuzz}"), &job, 128);
    }
}

#[test]
fn bad_scenes_and_unsupported_rules_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let mut baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let broken = directory.path().join("broken.txt");
    for text in ["metal 0 0 0 1 1 1", "cube 1 2 3", "camera 1 2 x"] {
        std::fs::write(&broken, text).unwrap();
        // Size, samples, depth and seed come first.
        let mut program = Command::new(baseline.program());
        let output = program.args(["16", "9", "2", "50", "7", "--scene"]).arg(&broken).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains("rt_weekend: "), "{text}: {error}");
    }
    let stage = Stage::find("shadow-acne").unwrap().recipe().job().unwrap();
    let error = baseline.prepare(&stage, &AtomicBool::new(false)).unwrap_err().to_string();
    assert!(error.contains("only the rules of the finished renderer"), "{error}");
    let go_on = AtomicBool::new(true);
    let cancelled = baseline.accumulate(&job("book"), 0..1 << 20, &mut Film::new(128, 72), &go_on);
    assert!(matches!(cancelled, Err(RenderError::Cancelled)), "{cancelled:?}");
}
