//! The plain C program compiles without warnings, and its pictures equal ours apart from noise.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a helper of a test may fail like the test")]

use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;
use weekender::film::Film;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderError, RenderJob, Renderer, SamplerKind};
use weekender::measure::baseline::{Baseline, FLAGS, SOURCE};
use weekender::numbers::statistics::blocks::{BlockTest, Differences, Noise};
use weekender::pictures::compare::ROUNDING_BIAS;
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::Camera;
use weekender::scene::builtin::metals;
use weekender::stages::{Rules, Stage};

const WIDTH: usize = 128;
const HEIGHT: usize = 72;

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
    recipe.settings.width = WIDTH as u32;
    recipe.settings.height = HEIGHT as u32;
    recipe.settings.sampler = SamplerKind::Independent;
    recipe.job().unwrap()
}

/// Two means of each pixel, from equal numbers of independent samples. Their mean is the picture, and their
/// difference tells the noise.
type Halves = [Vec<[f64; 3]>; 2];

fn of_film(film: &Film) -> Halves {
    [0, 1].map(|half| {
        let count = film.half_sample_count(half) as f64;
        film.halves()[half].iter().map(|sum| sum.radiance().map(|x| x / count)).collect()
    })
}

/// Compares the two pictures, of `samples` each, block by block.
fn blocks([theirs, ours]: &[Halves; 2], samples: u64) -> BlockTest {
    let of_pixel = |halves: &Halves, pixel: usize, of: fn(f64, f64) -> f64| {
        let [a, b] = [halves[0][pixel], halves[1][pixel]];
        [0, 1, 2].map(|channel| of(a[channel], b[channel]) / 2.0)
    };
    let difference = |pixel, of: fn(f64, f64) -> f64| {
        let (theirs, ours) = (of_pixel(theirs, pixel, of), of_pixel(ours, pixel, of));
        [0, 1, 2].map(|channel| ours[channel] - theirs[channel])
    };
    let values: Vec<_> = (0..WIDTH * HEIGHT).map(|pixel| difference(pixel, |a, b| a + b)).collect();
    let variances: Vec<_> =
        (0..WIDTH * HEIGHT).map(|pixel| difference(pixel, |a, b| a - b).map(|x| x * x)).collect();
    BlockTest::of(&Differences {
        width: WIDTH as u32,
        values: &values,
        noise: Noise::Variances(&variances),
        steps: None,
        tolerance: ROUNDING_BIAS,
        // Both halves of a picture may contain the same rare path.
        rare: 2.0 / samples as f64,
    })
}

fn check(name: &str, job: &RenderJob, samples: u64) {
    let mut baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let go_on = AtomicBool::new(false);
    let half = samples / 2;
    let theirs: Halves = [0..half, half..samples].map(|range| {
        let mut film = Film::new(WIDTH as u32, HEIGHT as u32, 1);
        let stats = baseline.accumulate(job, range, &mut film, &go_on).unwrap();
        assert_eq!(stats.paths, half * (WIDTH * HEIGHT) as u64);
        assert!(stats.rays > stats.paths && !stats.trace.is_zero());
        (0..WIDTH * HEIGHT).map(|pixel| film.mean(pixel)).collect()
    });
    let mut film = job.new_film();
    let mut renderer = CpuRenderer::new(CpuOptions::default()).unwrap();
    renderer.accumulate(job, 0..samples, &mut film, &AtomicBool::new(false)).unwrap();

    let test = blocks(&[theirs, of_film(&film)], samples);
    let (excess, largest) = (test.largest_excess(), test.largest);
    println!(
        "{name}: sum of z^2 {excess:.2} deviations above, largest {largest:.2} of {:.2}",
        test.largest_limit
    );
    assert!(test.is_within() && !test.is_too_near(), "{name}: {excess} deviations, largest {largest}");
}

#[test]
fn three_spheres_are_the_same_picture() {
    check("three-spheres", &job("three-spheres"), 512);
}

#[test]
fn the_book_is_the_same_picture() {
    check("book", &job("book"), 64);
}

/// Fuzz between 0 and 1, where a wrong exponent would show; at 0 and 1 it would not.
#[test]
fn fuzzy_metals_are_the_same_picture() {
    let of_book = job("three-spheres");
    for fuzz in [0.25, 0.6] {
        let job =
            RenderJob::new(metals(fuzz, fuzz), Camera::BOOK, *of_book.settings(), Rules::FINISHED).unwrap();
        check(&format!("metals of fuzz {fuzz}"), &job, 128);
    }
}

/// What the program says to these arguments after the size, the samples, the depth and the seed.
fn run(baseline: &Baseline, arguments: &[&Path]) -> Output {
    let numbers = ["16", "9", "2", "50", "7"];
    Command::new(baseline.program()).args(numbers).args(arguments).output().unwrap()
}

#[test]
fn bad_scenes_and_unsupported_rules_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let mut baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let broken = directory.path().join("broken.txt");
    for text in ["metal 0 0 0 1 1 1", "cube 1 2 3", "camera 1 2 x"] {
        std::fs::write(&broken, text).unwrap();
        let output = run(&baseline, &[Path::new("--scene"), &broken]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains("rt_weekend: "), "{text}: {error}");
    }
    let stage = Stage::find("shadow-acne").unwrap().recipe().job().unwrap();
    let error = baseline.prepare(&stage, &AtomicBool::new(false)).unwrap_err().to_string();
    assert!(error.contains("only the rules of the finished renderer"), "{error}");
    let go_on = AtomicBool::new(true);
    let cancelled = baseline.accumulate(&job("book"), 0..1 << 20, &mut Film::new(128, 72, 1), &go_on);
    assert!(matches!(cancelled, Err(RenderError::Cancelled)), "{cancelled:?}");
}
