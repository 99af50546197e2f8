//! The plain C program compiles without warnings, and its pictures equal ours apart from noise.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a helper of a test may fail like the test")]

use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;
use weekender::baseline::{Baseline, FLAGS, SOURCE};
use weekender::film::Film;
use weekender::pictures::compare::ROUNDING_BIAS;
use weekender::recipe::Recipe;
use weekender::render::{RenderJob, Renderer, SamplerKind};
use weekender::render_cpu::{CpuOptions, CpuRenderer};
use weekender::scene::Camera;
use weekender::scene::builtin::metals;
use weekender::stages::Rules;
use weekender::statistics::blocks::{BlockTest, Differences, Noise};

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

/// Means of a PFM, linear RGB, top row first.
fn read_pfm(path: &Path) -> Vec<[f64; 3]> {
    let bytes = std::fs::read(path).unwrap();
    let scale = if cfg!(target_endian = "little") { "-1.0" } else { "1.0" };
    let header = format!("PF\n{WIDTH} {HEIGHT}\n{scale}\n");
    let values = bytes.strip_prefix(header.as_bytes()).unwrap();
    assert_eq!(values.len(), 12 * WIDTH * HEIGHT);
    let channel = |pixel: &[u8], c: usize| {
        f64::from(f32::from_ne_bytes([pixel[4 * c], pixel[4 * c + 1], pixel[4 * c + 2], pixel[4 * c + 3]]))
    };
    let rows = values.chunks_exact(12 * WIDTH).rev();
    rows.flat_map(|row| row.chunks_exact(12)).map(|pixel| [0, 1, 2].map(|c| channel(pixel, c))).collect()
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
    let baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let directory = tempfile::tempdir().unwrap();
    let text = baseline.write_scene(job, "scene").unwrap();
    let out = directory.path().join("picture.pfm");
    let theirs: Halves = [1, 2].map(|seed| {
        let run =
            baseline.run(Some(&text), job.settings(), samples / 2, seed, Some(&out), &|| false).unwrap();
        assert_eq!(run.paths, samples / 2 * (WIDTH * HEIGHT) as u64);
        assert!(run.rays > run.paths);
        assert!(run.seconds > 0.0 && run.processor_seconds > 0.0);
        read_pfm(&out)
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

#[test]
fn without_a_scene_file_it_renders_the_three_spheres() {
    let baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let job = job("three-spheres");
    let directory = tempfile::tempdir().unwrap();
    let paths = ["given.pfm", "built-in.pfm"].map(|name| directory.path().join(name));
    let text = baseline.write_scene(&job, "scene").unwrap();
    baseline.run(Some(text.as_path()), job.settings(), 2, 7, Some(&paths[0]), &|| false).unwrap();
    baseline.run(None, job.settings(), 2, 7, Some(&paths[1]), &|| false).unwrap();
    // The camera's up vector and the sky are written in full; its focus distance is the book's.
    assert_eq!(read_pfm(&paths[0]), read_pfm(&paths[1]));
}

#[test]
fn bad_arguments_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let baseline = Baseline::compile().expect("a C compiler is needed: install one or name it in CC");
    let job = job("three-spheres");
    let broken = directory.path().join("broken.txt");
    for text in ["metal 0 0 0 1 1 1", "cube 1 2 3", "camera 1 2 x"] {
        std::fs::write(&broken, text).unwrap();
        let refused =
            baseline.run(Some(&broken), job.settings(), 1, 1, None, &|| false).unwrap_err().to_string();
        assert!(refused.contains("rt_weekend: "), "{text}: {refused}");
    }
}
