//! Samplers and error estimates: cases 28 to 30.

use crate::common::films::squared_error;
use crate::numerics::common::*;
use glam::DVec3;
use std::sync::OnceLock;
use weekender::comparison::Picture;
use weekender::comparison::compare::compare;
use weekender::film::Film;
use weekender::job::recipe::Recipe;
use weekender::job::render::{RenderJob, RenderSettings, SamplerKind};
use weekender::scene::Camera;
use weekender::scene::builtin::{LeftSphere, three_spheres};

const WIDTH: u32 = 48;
const HEIGHT: u32 = 27;

fn three(width: u32, height: u32, sampler: SamplerKind, seed: u32) -> RenderJob {
    let settings = RenderSettings { sampler, seed, max_depth: 24, ..size(width, height) };
    job(&three_spheres(LeftSphere::HollowGlass), Camera::BOOK, settings)
}

/// The picture that all small films approach.
fn truth() -> &'static Film {
    static TRUTH: OnceLock<Film> = OnceLock::new();
    TRUTH.get_or_init(|| render(&mut widest(), &three(WIDTH, HEIGHT, SamplerKind::Sobol, 4242), 0..65_536))
}

#[test]
fn case_28_sobol_keeps_converging() {
    let mut renderer = widest();
    let mut rmse = |samples| {
        let squares: f64 = (0..8)
            .map(|seed| {
                let job = three(WIDTH, HEIGHT, SamplerKind::Sobol, seed);
                squared_error(&render(&mut renderer, &job, 0..samples), truth())
            })
            .sum();
        (squares / 8.0).sqrt()
    };
    let (coarse, fine) = (rmse(256), rmse(1024));
    println!("case 28: RMSE {coarse:.2e} to {fine:.2e}, ratio {:.3}", fine / coarse);
    assert!(fine / coarse <= 0.55, "{coarse} to {fine}");
}

/// The three spheres, the book's last scene, a wide lens, and hollow glass up close.
fn calibration_jobs(
    sampler: SamplerKind,
    seed: u32,
    width: u32,
    height: u32,
) -> [(&'static str, RenderJob); 4] {
    let of = |name: &'static str, camera: Option<Camera>| {
        let recipe = Recipe::find(name).unwrap();
        let settings = RenderSettings { sampler, seed, ..size(width, height) };
        job(&recipe.scene, camera.unwrap_or(recipe.camera), settings)
    };
    let near = Camera {
        look_from: DVec3::new(-2.2, 0.6, 0.6),
        look_at: DVec3::new(-1.0, 0.0, -1.0),
        vfov_degrees: 32.0,
        ..Camera::BOOK
    };
    [
        ("three-spheres", of("three-spheres", None)),
        ("book", of("book", None)),
        ("wide lens", of("close-up", None)),
        ("hollow glass", of("three-spheres", Some(near))),
    ]
}

#[test]
fn case_29_estimated_error() {
    const SEEDS: u32 = 24;
    const SAMPLES: u64 = 64;
    let mut renderer = widest();
    let truths: Vec<Film> = calibration_jobs(SamplerKind::Sobol, 4242, WIDTH, HEIGHT)
        .iter()
        .map(|(_, job)| render(&mut renderer, job, 0..4096))
        .collect();
    for sampler in SamplerKind::ALL {
        let mut sums = vec![[0.0; 2]; truths.len()];
        for seed in 0..SEEDS {
            for ((sum, truth), (_, job)) in
                sums.iter_mut().zip(&truths).zip(calibration_jobs(sampler, seed, WIDTH, HEIGHT))
            {
                let film = render(&mut renderer, &job, 0..SAMPLES);
                sum[0] += film.error().unwrap().rmse.powi(2);
                sum[1] += squared_error(&film, truth);
            }
        }
        for ([predicted, actual], (name, _)) in
            sums.into_iter().zip(calibration_jobs(sampler, 0, WIDTH, HEIGHT))
        {
            let ratio = (predicted / actual).sqrt();
            println!("case 29 {sampler:?}, {name}: predicted / actual {ratio:.3}");
            assert!((ratio - 1.0).abs() <= 0.05, "{sampler:?}, {name}: {ratio}");
        }
    }
}

/// Both samplers converge to the same picture, with a lens and without.
#[test]
fn case_30_samplers_agree() {
    let mut renderer = widest();
    let mut pictures = |sampler| {
        let [without_lens, _, with_lens, _] = calibration_jobs(sampler, 5, 160, 96);
        [without_lens, with_lens].map(|(name, job)| {
            let film = render(&mut renderer, &job, 0..2048);
            (name, Picture::of_film(String::new(), String::new(), film))
        })
    };
    let (sobol, independent) = (pictures(SamplerKind::Sobol), pictures(SamplerKind::Independent));
    for ((name, sobol), (_, independent)) in sobol.into_iter().zip(independent) {
        let found = compare(&sobol, &independent);
        println!(
            "case 30, {name}: {:.3} x noise, excess {:.2}, largest {:.2}",
            found.times_noise(),
            found.test.largest_excess(),
            found.test.largest
        );
        assert!(found.is_equal(), "{name}: {:?}", found.reasons);
        assert!((found.times_noise() - 1.0).abs() < 0.05, "{name}: {}", found.times_noise());
        // One thousandth more light is found.
        let mut brighter = independent;
        brighter.pixels.iter_mut().flatten().for_each(|x| *x *= 1.001);
        assert!(!compare(&sobol, &brighter).is_equal(), "{name}");
    }
}
