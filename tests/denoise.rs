//! Denoised pictures of rendered films, and the estimate of their error.

#![allow(clippy::unwrap_used)]

mod program_common;

use program_common::{ends, film, json_file, outcome, weekender};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use weekender::denoise::{self, Denoised};
use weekender::film::{Film, key};
use weekender::job::output::read_description;
use weekender::job::recipe::Recipe;
use weekender::{CpuOptions, CpuRenderer, Renderer};

/// Renders samples of a picture with the CPU.
fn render(recipe: &Recipe, samples: u64) -> Film {
    let job = recipe.job().unwrap();
    let mut renderer = CpuRenderer::new(CpuOptions::default()).unwrap();
    let (mut film, go_on) = (job.new_film(), AtomicBool::new(false));
    renderer.prepare(&job, &go_on).unwrap();
    renderer.accumulate(&job, 0..samples, &mut film, &go_on).unwrap();
    film
}

fn sized(mut recipe: Recipe, [width, height]: [u32; 2], seed: u32) -> Recipe {
    (recipe.settings.width, recipe.settings.height, recipe.settings.seed) = (width, height, seed);
    recipe
}

/// Mean squared error by a reference with independent samples, whose own noise is subtracted.
fn mse(film: &Film, reference: &Film) -> f64 {
    let pixels = film.width() as usize * film.height() as usize;
    let of_pixel = |i| {
        let (mean, truth) = (film.mean(i), reference.mean(i));
        (0..3).map(|c| (mean[c] - truth[c]).powi(2)).sum::<f64>()
    };
    (0..pixels).map(of_pixel).sum::<f64>() / (3 * pixels) as f64 - reference.error().unwrap().rmse.powi(2)
}

struct Outcome {
    gain: f64,
    /// The estimate, and its standard deviation, over the true error.
    ratio: f64,
    deviation: f64,
    milliseconds: f64,
}

impl Outcome {
    fn of(film: &Film, reference: &Film) -> Outcome {
        let begin = Instant::now();
        let Denoised { film: picture, error, .. } = denoise::of_film(film).unwrap();
        let milliseconds = 1e3 * begin.elapsed().as_secs_f64();
        let (raw, found) = (mse(film, reference), mse(&picture, reference));
        Outcome {
            gain: raw / found,
            ratio: error.mse / found,
            deviation: error.mse_deviation / found,
            milliseconds,
        }
    }

    fn is_within(&self) -> bool {
        (self.ratio - 1.0).abs() <= 2.0 * self.deviation
    }
}

#[test]
fn rendered_pictures_gain_and_the_estimate_holds() {
    let (mut within, mut total) = (0, 0);
    for (scene, least_gain) in [("three-spheres", 5.0), ("metals", 5.0), ("book", 1.3)] {
        let size = [200, 112];
        let reference = render(&sized(Recipe::find(scene).unwrap(), size, 1000), 2048);
        for seed in 0..4 {
            for samples in [4, 16, 64] {
                let film = render(&sized(Recipe::find(scene).unwrap(), size, seed), samples);
                let outcome = Outcome::of(&film, &reference);
                assert!(outcome.gain > least_gain, "{scene}, {samples} samples: {}", outcome.gain);
                (within, total) = (within + usize::from(outcome.is_within()), total + 1);
            }
        }
    }
    // 95 % are expected; 29 of 36 or fewer happen once in 3000 times.
    assert!(within >= 30, "{within} of {total} estimates are within two standard deviations");
}

/// The figures of docs/benchmarks.md: `cargo test --release --test denoise -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn gains_and_estimates_of_large_pictures() {
    println!("1280x720, {} threads", rayon::current_num_threads());
    for scene in ["three-spheres", "book"] {
        let size = [1280, 720];
        let reference = render(&sized(Recipe::find(scene).unwrap(), size, 1000), 4096);
        for samples in [4, 16, 64, 256, 1024] {
            let film = render(&sized(Recipe::find(scene).unwrap(), size, 0), samples);
            let Outcome { gain, ratio, deviation, milliseconds } = Outcome::of(&film, &reference);
            println!("{scene:14} {samples:5} {gain:6.2} {ratio:5.2} +- {deviation:.2} {milliseconds:4.0} ms");
        }
    }
}

#[test]
fn the_program_writes_denoised_pictures_and_leaves_the_film_alone() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let run = |flags: &str| {
        let flags: Vec<&str> = flags.split(' ').collect();
        ends(directory.path(), 0, &[&["--batch", "--device", "cpu"], &flags[..]].concat())
    };
    let film = |name: &str| film(&at(name));
    run("--size 64x36 --samples 16 --out plain.png --checkpoint plain.exr");
    let (figures, _) = run("--size 64x36 --samples 16 --out quiet.png --checkpoint film.exr --denoise");
    assert!(figures.contains("denoised "), "{figures}");
    assert_eq!(film("film.exr"), film("plain.exr"));
    let said = |name: &str| read_description(&at(name)).unwrap().get(key::DENOISED).map(str::to_owned);
    assert_eq!(said("plain.png"), None);
    assert!(said("quiet.png").unwrap().contains("RMSE"));
    assert!(ends(directory.path(), 0, &["info", "quiet.png"]).0.contains("denoised"));
    assert_ne!(std::fs::read(at("quiet.png")).unwrap(), std::fs::read(at("plain.png")).unwrap());

    // It is never taken for a picture whose only error is noise.
    let compare = |other: &str| {
        let (_, out, message) =
            outcome(&weekender(directory.path(), &["compare", "plain.exr", other]).output().unwrap());
        out + &message
    };
    assert!(compare("quiet.png").contains("denoised"), "{}", compare("quiet.png"));
    run("--size 64x36 --samples 16 --out layer.exr --denoise");
    let (film_of_layer, layer) = (compare("layer.exr"), compare("layer.exr:denoised"));
    assert!(
        film_of_layer.contains("equal to the bit") && layer.contains("it is denoised"),
        "{film_of_layer}{layer}"
    );

    // A film with a layer is a film: it is resumed and merged like any other.
    assert_eq!(film("layer.exr"), film("plain.exr"));
    let layer = exr_layer(&at("layer.exr"));
    let expected = denoise::of_film(&film("plain.exr")).unwrap().film.means();
    assert_eq!(layer, expected.iter().map(|pixel| pixel[0]).collect::<Vec<_>>());
    run("--size 64x36 --samples 32 --out more.png --resume layer.exr");

    // Denoised, the error is small enough with fewer samples.
    let samples = |flags: &str| {
        run(&format!("--size 240x135 --noise-target 0.003 --json figures.json --out a.png {flags}"));
        let json = json_file(&at("figures.json"));
        (json["samples_per_pixel"].as_u64().unwrap(), json["denoised_rmse_estimate"].as_f64())
    };
    let ((raw, none), (denoised, error)) = (samples("--seed 1"), samples("--seed 1 --denoise"));
    assert!(
        none.is_none() && error.unwrap() <= 0.003 && denoised < raw,
        "{denoised} and {raw} samples, {error:?}"
    );

    let (_, messages) = run("--stage metal --out small.png --samples 2 --denoise --size 4x3");
    assert!(messages.contains("the picture is not denoised"), "{messages}");
}

/// The red channel of the denoised layer, as another program reads it.
fn exr_layer(path: &Path) -> Vec<f32> {
    use exr::prelude::*;
    let image = read_all_flat_layers_from_file(path).unwrap();
    let channels = &image.layer_data[0].channel_data.list;
    let red = channels.iter().find(|channel| channel.name.eq_case_insensitive("denoised.r")).unwrap();
    red.sample_data.values_as_f32().collect()
}
