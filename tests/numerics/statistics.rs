//! Samplers and estimates of error: cases 28 to 30.

use crate::common::*;
use std::sync::OnceLock;
use weekender::film::Film;
use weekender::render::{RenderJob, RenderSettings, SamplerKind};
use weekender::scene::Camera;
use weekender::scene::builtin::{LeftSphere, three_spheres};

const WIDTH: u32 = 48;
const HEIGHT: u32 = 27;
const VALUES: usize = (WIDTH * HEIGHT * 3) as usize;

fn three(width: u32, height: u32, sampler: SamplerKind, seed: u32) -> RenderJob {
    let settings =
        RenderSettings { sampler, seed, estimate_error: true, max_depth: 24, ..size(width, height) };
    job(&three_spheres(LeftSphere::HollowGlass), Camera::BOOK, settings)
}

/// What all small films approach.
fn truth() -> &'static Film {
    static TRUTH: OnceLock<Film> = OnceLock::new();
    TRUTH.get_or_init(|| render(&mut widest(), &three(WIDTH, HEIGHT, SamplerKind::Sobol, 4242), 0..65_536))
}

/// Mean squared error against the truth, less the truth's own.
fn squared_error(film: &Film) -> f64 {
    let sum: f64 = (0..(WIDTH * HEIGHT) as usize)
        .flat_map(|pixel| {
            let (x, expected) = (film.mean(pixel), truth().mean(pixel));
            [0, 1, 2].map(|channel| (x[channel] - expected[channel]).powi(2))
        })
        .sum();
    sum / VALUES as f64 - truth().error().unwrap().rmse.powi(2)
}

#[test]
fn case_28_sobol_keeps_converging() {
    let mut renderer = widest();
    let mut rmse = |samples| {
        let squares: f64 = (0..8)
            .map(|seed| {
                let job = three(WIDTH, HEIGHT, SamplerKind::Sobol, seed);
                squared_error(&render(&mut renderer, &job, 0..samples))
            })
            .sum();
        (squares / 8.0).sqrt()
    };
    let (coarse, fine) = (rmse(256), rmse(1024));
    println!("case 28: RMSE {coarse:.2e} to {fine:.2e}, ratio {:.3}", fine / coarse);
    assert!(fine / coarse <= 0.55, "{coarse} to {fine}");
}

#[test]
fn case_29_estimated_error() {
    const SEEDS: u32 = 24;
    let mut renderer = widest();
    for sampler in SamplerKind::ALL {
        for samples in [16, 128] {
            let (mut predicted, mut actual) = (0.0, 0.0);
            for seed in 0..SEEDS {
                let film = render(&mut renderer, &three(WIDTH, HEIGHT, sampler, seed), 0..samples);
                predicted += film.error().unwrap().rmse.powi(2);
                actual += squared_error(&film);
            }
            let ratio = (predicted / actual).sqrt();
            println!("case 29 {sampler:?}, {samples} samples: predicted / actual {ratio:.3}");
            assert!((ratio - 1.0).abs() <= 0.05, "{sampler:?}, {samples} samples: {ratio}");
        }
    }
}

#[test]
fn case_30_samplers_agree() {
    const SIDE: u32 = 8;
    let (width, height) = (160, 96);
    let mut renderer = widest();
    let mut of = |sampler| render(&mut renderer, &three(width, height, sampler, 5), 0..256);
    let films = [of(SamplerKind::Sobol), of(SamplerKind::Independent)];
    let (mut count, mut squares, mut largest) = (0.0, 0.0, 0.0_f64);
    for block in 0..(width / SIDE) * (height / SIDE) {
        let corner = [block % (width / SIDE) * SIDE, block / (width / SIDE) * SIDE];
        let (mut difference, mut variance) = (0.0, 0.0);
        for pixel in 0..SIDE * SIDE {
            let (x, y) = (corner[0] + pixel % SIDE, corner[1] + pixel / SIDE);
            let index = (y * width + x) as usize;
            for (film, sign) in films.iter().zip([1.0, -1.0]) {
                difference += sign * film.mean(index).iter().sum::<f64>();
                let [a, b] = [0, 1].map(|half| {
                    let sum: f64 = film.halves()[half][index].radiance().iter().sum();
                    sum / film.half_sample_count(half) as f64
                });
                variance += (a - b).powi(2) / 4.0;
            }
        }
        let z = difference / variance.sqrt();
        count += 1.0;
        squares += z * z;
        largest = largest.max(z.abs());
    }
    let spread = (squares - count) / f64::sqrt(2.0 * count);
    println!(
        "case 30: {count} blocks, sum of z^2 {squares:.1}, {spread:.2} deviations, largest {largest:.2}"
    );
    assert!(spread.abs() <= 4.0, "{squares} for {count} blocks");
    // What the largest of 240 normal numbers stays below in 99 of 100 cases (Sidak): a tail of 4.2e-5.
    assert!(largest <= 4.1, "{largest}");
}
