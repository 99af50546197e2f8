//! Denoised pictures of rendered films, and the estimate of their error.

use crate::common::films::{rendered, squared_error as mse};
use crate::common::program::{ends, film, json_file, outcome, weekender};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use weekender::denoise::{self, Denoised};
use weekender::film::{Film, key};
use weekender::job::output::read_description;
use weekender::job::recipe::Recipe;
use weekender::{CpuOptions, CpuRenderer, scene_file};

/// Renders samples of a picture with the CPU.
fn render(recipe: &Recipe, samples: u64) -> Film {
    let mut renderer = CpuRenderer::new(CpuOptions::default()).unwrap();
    rendered(&mut renderer, &recipe.job().unwrap(), samples)
}

fn sized(mut recipe: Recipe, [width, height]: [u32; 2], seed: u32) -> Recipe {
    (recipe.settings.width, recipe.settings.height, recipe.settings.seed) = (width, height, seed);
    recipe
}

struct Outcome {
    gain: f64,
    /// The estimate, and its standard deviation, over the true error.
    ratio: f64,
    deviation: f64,
}

impl Outcome {
    fn of(film: &Film, reference: &Film) -> Outcome {
        let Denoised { film: picture, error, .. } = denoise::of_film(film).unwrap();
        let (raw, found) = (mse(film, reference), mse(&picture, reference));
        Outcome { gain: raw / found, ratio: error.mse / found, deviation: error.mse_deviation / found }
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

/// Noise is distinguished from texture relative to the noise level, however dark the picture is.
#[test]
fn dark_scenes_gain_like_bright_ones() {
    let gain = |factor: f64| {
        let film = render(&crate::common::noisy_scenes::dimmed(factor), 64);
        let error = denoise::of_film(&film).unwrap().error;
        error.raw_mse / error.mse
    };
    let (bright, dark) = (gain(1.0), gain(1e-4));
    assert!(bright > 4.0 && (dark / bright - 1.0).abs() < 0.05, "{bright}, {dark}");
}

/// Where filtering loses more than it gains, the raw picture stays, with a reason.
#[test]
fn texture_of_single_pixels_is_not_erased() {
    let reference = render(&sized(crate::common::noisy_scenes::dots(), [200, 112], 1000), 512);
    for (seed, samples) in (0..3).flat_map(|seed| [4, 8, 16, 64].map(|samples| (seed, samples))) {
        let film = render(&sized(crate::common::noisy_scenes::dots(), [200, 112], seed), samples);
        let raw = mse(&film, &reference);
        match denoise::of_film(&film) {
            Ok(denoised) => {
                let gain = raw / mse(&denoised.film, &reference);
                assert!(gain > 0.97, "seed {seed}, {samples} samples: {gain}");
            }
            Err(reason) => assert!(reason.to_string().contains("would grow"), "{reason}"),
        }
    }
}

/// If few paths find light, the stated error is not far too low, and the mean stays.
#[test]
fn rare_light_is_neither_overlooked_nor_lost() {
    let size = [48, 27];
    let reference = render(&sized(crate::common::noisy_scenes::cage(1.4), size, 1000), 1 << 15);
    let total = |film: &Film| film.exact_means().flatten().sum::<f64>();
    let (mut raw, mut kept) = (0.0, 0.0);
    for seed in 0..40 {
        let film = render(&sized(crate::common::noisy_scenes::cage(1.4), size, seed), 16);
        let Ok(halves) = denoise::Halves::of(&film) else { continue };
        let denoised = denoise::denoise(halves, &AtomicBool::new(false)).unwrap();
        let (truth, stated) = (mse(&denoised.film, &reference), denoised.error.upper_rmse());
        assert!(truth.sqrt() < 3.0 * stated.max(1e-3), "seed {seed}: {} and {stated}", truth.sqrt());
        (raw, kept) = (raw + total(&film), kept + total(&denoised.film));
    }
    assert!((kept / raw - 1.0).abs() < 0.1, "the mean falls from {raw} to {kept}");
}

/// Sobol points of a half with more samples have less than their share of the variance.
#[test]
fn errors_of_odd_numbers_of_samples_hold() {
    let metals = |seed| sized(Recipe::find("metals").unwrap(), [200, 112], seed);
    let reference = render(&metals(1000), 1024);
    for (samples, seeds) in [(3, 8), (5, 6), (7, 6)] {
        let (mut stated, mut truth) = (0.0, 0.0);
        for seed in 0..seeds {
            let film = render(&metals(seed), samples);
            (stated, truth) = (stated + film.error().unwrap().rmse.powi(2), truth + mse(&film, &reference));
        }
        assert!((stated / truth - 1.0).abs() < 0.04, "{samples} samples: {}", stated / truth);
    }
}

#[test]
fn program_denoises_pictures_but_not_films() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let run = |flags: &str| {
        let flags: Vec<&str> = flags.split(' ').collect();
        ends(directory.path(), 0, &[&["--batch", "--device", "cpu"], &flags[..]].concat())
    };
    let film = |name: &str| film(&at(name));
    run("--size 64x36 --samples 16 --out plain.png --out plain.exr");
    run("--size 64x36 --samples 16 --out quiet.png --out layer.exr --denoise");
    let said = |name: &str| read_description(&at(name)).unwrap().get(key::DENOISED).map(str::to_owned);
    assert!(said("plain.png").is_none() && said("quiet.png").unwrap().contains("RMSE"));
    assert_ne!(std::fs::read(at("quiet.png")).unwrap(), std::fs::read(at("plain.png")).unwrap());

    // It is never taken for a picture whose only error is noise.
    let compare = |other: &str| {
        let (_, out, message) =
            outcome(&weekender(directory.path(), &["compare", "plain.exr", other]).output().unwrap());
        out + &message
    };
    for (other, part) in [
        ("quiet.png", "denoised"),
        ("layer.exr", "equal to the bit"),
        ("layer.exr:denoised", "it is denoised"),
    ] {
        assert!(compare(other).contains(part), "{}", compare(other));
    }

    // A film with a layer is a film: it is resumed and merged like any other.
    assert_eq!(film("layer.exr"), film("plain.exr"));
    let expected = denoise::of_film(&film("plain.exr")).unwrap().film.means();
    assert_eq!(exr_layer(&at("layer.exr")), expected.iter().map(|pixel| pixel[0]).collect::<Vec<_>>());
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

    // A target is met by the picture that is written.
    let toml = scene_file::to_toml(&crate::common::noisy_scenes::dots());
    std::fs::write(at("dots.toml"), toml).unwrap();
    let (_, messages) =
        run("--scene dots.toml --noise-target 0.025 --json figures.json --out dots.png --denoise");
    let json = json_file(&at("figures.json"));
    let written = json["denoised_rmse_estimate"].as_f64();
    assert!(written.or(json["rmse_estimate"].as_f64()).unwrap() <= 0.025, "{json}");
    assert_eq!(written.is_none(), messages.contains("not denoised"), "{messages}");

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
