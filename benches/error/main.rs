//! How accurate the stated errors are, and how much denoising gains: `cargo bench --bench error -- [--samples 4,16]
//! [--seeds 2] [--size 200x112] [--reference 8192] [SCENE...]`.
//!
//! A scene is `three-spheres` or another built-in one, `dots`, `dim`, `cage`, `random` or a scene file. Without any, all of
//! these and `random 0` to `random 11` are measured. The reference has another seed; its own squared error is
//! subtracted.

#![allow(clippy::unwrap_used, reason = "a benchmark may fail like a test")]

#[path = "../../tests/common/noisy_scenes.rs"]
mod noisy_scenes;

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use weekender::denoise::{Halves, denoise};
use weekender::film::Film;
use weekender::{CpuOptions, CpuRenderer, Recipe, Renderer, scene_file};

const SCENES: &str = "three-spheres,metals,book,field,defocus,dots,dim,cage,random 0,random 1,random 2,random 3,random 4,\
                      random 5,random 6,random 7,random 8,random 9,random 10,random 11";

fn recipe(name: &str) -> Recipe {
    match name.split_once(' ') {
        Some(("random", seed)) => noisy_scenes::random(seed.parse().unwrap()),
        _ if name == "dots" => noisy_scenes::dots(),
        _ if name == "dim" => noisy_scenes::dimmed(1e-4),
        _ if name == "cage" => noisy_scenes::cage(1.35),
        _ => Recipe::find(name).or_else(|_| scene_file::load(Path::new(name))).unwrap(),
    }
}

fn render(recipe: &Recipe, seed: u32, samples: u64) -> (Film, Duration) {
    let mut recipe = recipe.clone();
    recipe.settings.seed = seed;
    let job = recipe.job().unwrap();
    let mut renderer = CpuRenderer::new(CpuOptions::default()).unwrap();
    let (mut film, go_on) = (job.new_film(), AtomicBool::new(false));
    renderer.prepare(&job, &go_on).unwrap();
    let begin = Instant::now();
    renderer.accumulate(&job, 0..samples, &mut film, &go_on).unwrap();
    (film, begin.elapsed())
}

fn mse(film: &Film, reference: &Film) -> f64 {
    let pixels = film.halves()[0].len();
    let of_pixel = |i| {
        let (mean, truth) = (film.mean(i), reference.mean(i));
        (0..3).map(|c| (mean[c] - truth[c]).powi(2)).sum::<f64>()
    };
    let own = reference.error().map_or(0.0, |error| error.rmse.powi(2));
    (0..pixels).map(of_pixel).sum::<f64>() / (3 * pixels) as f64 - own
}

fn total(film: &Film) -> f64 {
    film.exact_means().flatten().sum()
}

/// Sums over films.
#[derive(Default)]
struct Tally {
    films: usize,
    raw_within: [usize; 2],
    raw_logs: f64,
    denoised_within: usize,
    too_low: usize,
    worse: usize,
    silent: usize,
}

fn main() {
    let (mut samples, mut seeds, mut size, mut reference) = (vec![4, 16, 64], 2, [200, 112], 8192);
    let mut scenes = Vec::new();
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    while let Some(word) = words.next() {
        let mut value = || words.next().unwrap();
        match word.as_str() {
            "--samples" => samples = value().split(',').map(|x| x.parse().unwrap()).collect(),
            "--seeds" => seeds = value().parse().unwrap(),
            "--reference" => reference = value().parse().unwrap(),
            "--size" => {
                size = value().split_once('x').map(|(x, y)| [x, y].map(|x| x.parse().unwrap())).unwrap()
            }
            _ => scenes.push(word),
        }
    }
    if scenes.is_empty() {
        scenes = SCENES.split(',').map(|name| name.trim().to_owned()).collect();
    }
    println!(
        "scene, samples | raw: MSE, estimate / true RMSE | denoised: gain, estimate / true MSE, z, mean | ms"
    );
    let mut tally = Tally::default();
    for name in &scenes {
        let mut recipe = recipe(name);
        if name != "cage" {
            [recipe.settings.width, recipe.settings.height] = size;
        }
        let (truth, _) = render(&recipe, 1_000_000, reference);
        for count in &samples {
            for seed in 0..seeds {
                let (film, traced) = render(&recipe, 100 + seed, *count);
                let raw = mse(&film, &truth);
                let (Some(error), Ok(halves)) = (film.error(), Halves::of(&film)) else { continue };
                let begin = Instant::now();
                let found = denoise(halves, &AtomicBool::new(false)).unwrap();
                let filtered = begin.elapsed();
                let (true_mse, stated) = (mse(&found.film, &truth), found.error);
                let z = (stated.mse - true_mse) / stated.mse_deviation;
                let is_said = stated.rmse() > stated.raw_mse.sqrt();
                let off = (error.rmse - raw.sqrt()).abs() / error.rmse_deviation;
                tally.films += 1;
                (0..2).for_each(|i| tally.raw_within[i] += usize::from(off <= (i + 1) as f64));
                tally.raw_logs += (error.rmse / raw.sqrt()).ln();
                tally.denoised_within += usize::from(z.abs() <= 2.0);
                tally.too_low += usize::from(z < -2.0);
                tally.worse += usize::from(true_mse > raw);
                tally.silent += usize::from(true_mse > raw && !is_said);
                println!(
                    "{name:14} {count:5} | {raw:9.3e} {:6.3} | {:6.2} {:6.3} {z:6.2} {:+6.2} %{} | {:.0} {:.0}",
                    error.rmse / raw.sqrt(),
                    raw / true_mse,
                    stated.mse / true_mse,
                    100.0 * (total(&found.film) / total(&truth) - 1.0),
                    if is_said { ", raw is written" } else { "" },
                    1e3 * traced.as_secs_f64(),
                    1e3 * filtered.as_secs_f64(),
                );
            }
        }
    }
    let films = tally.films as f64;
    let share = |count: usize| count as f64 / films;
    println!("{films} films");
    println!(
        "raw: estimate / true {:.4}, within one deviation {:.3}, two {:.3}",
        (tally.raw_logs / films).exp(),
        share(tally.raw_within[0]),
        share(tally.raw_within[1])
    );
    println!(
        "denoised: within two deviations {:.3}, true error above them {:.3}, worse than raw {} films, {} of them unnoticed",
        share(tally.denoised_within),
        share(tally.too_low),
        tally.worse,
        tally.silent
    );
}
