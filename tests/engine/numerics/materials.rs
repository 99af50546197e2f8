//! Surfaces: cases 14 to 18, 20 to 22. (Book 1, sections 9 to 11.)

use crate::numerics::common::*;
use glam::DVec3;
use weekender::job::render::{RenderSettings, SamplerKind};
use weekender::render_cpu::lanes::{Lanes, Reference, Scalar};
use weekender::render_cpu::material::{incidence_of, incidence_of_sine2, reflectance, scatter};
use weekender::scene::{Camera, Material, Sky};
use weekender::stages::DielectricLaws;

const WHITE_SKY: Sky = Sky { bottom: DVec3::ONE, top: DVec3::ONE };

/// A ball of radius 1 at the origin that fills most of the picture.
fn ball_view() -> Camera {
    Camera { look_from: DVec3::new(0.0, 0.0, 4.0), vfov_degrees: 32.0, ..Camera::BOOK }
}

#[test]
fn case_14_white_furnace() {
    for material in [lambertian(1.0), mirror(1.0)] {
        let mut scene = scene(&[(DVec3::ZERO, 1.0, material)]);
        scene.sky = WHITE_SKY;
        let film = render(&mut widest(), &job(&scene, ball_view(), size(64, 64)), 0..64);
        for pixel in 0..64 * 64 {
            for x in film.mean(pixel) {
                assert!((x - 1.0).abs() <= 1e-6, "pixel {pixel} is {x} for {material:?}");
            }
        }
    }
}

/// A cosine lobe about `n` under a sky `middle + slope y` receives the radiance `middle + slope (2/3) n.y`; a single
/// direction's y has the variance `1/4 - 7/36 n.y^2`.
#[test]
fn case_15_matte_ball_under_the_sky() {
    const SAMPLES: u64 = 256;
    const ALBEDO: f64 = 0.8;
    let (width, height) = (64, 64);
    let scene = scene(&[(DVec3::ZERO, 1.0, lambertian(ALBEDO))]);
    let settings = RenderSettings { sampler: SamplerKind::Independent, ..size(width, height) };
    let film = render(&mut widest(), &sharp_job(&scene, ball_view(), settings), 0..SAMPLES);
    let middle = (scene.sky.bottom + scene.sky.top) / 2.0;
    let slope = (scene.sky.top - scene.sky.bottom) / 2.0;
    let (mut count, mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
    for y in 0..height {
        for x in 0..width {
            let (o, d) = centre_ray(&ball_view(), width, height, x, y);
            let Some([t, _]) = exact_roots(o, d, DVec3::ZERO, 1.0) else { continue };
            let n = (o + d * t).normalize();
            let found = film.mean((y * width + x) as usize);
            let expected = ALBEDO * (middle + slope * (2.0 / 3.0 * n.y));
            let deviation =
                ALBEDO * slope.x.abs() * ((0.25 - 7.0 / 36.0 * n.y * n.y) / SAMPLES as f64).sqrt();
            let z = (found[0] - expected.x) / deviation;
            count += 1.0;
            sum += z;
            squares += z * z;
            largest = largest.max(z.abs());
            // The sky's blue is the same everywhere.
            assert!((found[2] - expected.z).abs() < 1e-6, "{found:?}, not {expected}");
        }
    }
    let mean = sum / f64::sqrt(count);
    let spread = (squares - count) / f64::sqrt(2.0 * count);
    println!("case 15: mean {mean:.2} standard errors, spread {spread:.2}, largest of {count} {largest:.2}");
    assert!(count > 2000.0);
    assert!(mean.abs() <= 4.0, "the mean is off by {mean} standard errors");
    assert!(spread.abs() <= 4.0, "the squares are off by {spread} standard errors");
    assert!(largest <= 5.0, "a pixel is off by {largest} standard errors");
}

/// With parallel light, Schlick's share averages to the integral of `(1 - c)^5 2 c`, 1/21. A path of two rays
/// distinguishes reflection (it reaches the white sky) from refraction (it is still inside).
#[test]
fn case_16_refraction_index_1() {
    let steps = 100_000;
    let l = Scalar::<false>;
    let average = (0..steps)
        .map(|step| {
            let cosine = (f64::from(step) + 0.5) / f64::from(steps);
            2.0 * cosine * first::<Scalar<false>>(reflectance(l, l.constant(cosine), l.constant(0.0)))
                / f64::from(steps)
        })
        .sum::<f64>();
    assert!((average - 1.0 / 21.0).abs() < 1e-6, "{average}");

    const SAMPLES: u64 = 1024;
    let away = 1000.0;
    let half_side = 1.1;
    let mut scene = scene(&[(DVec3::new(0.0, 0.0, -away), 1.0, glass(1.0))]);
    scene.sky = WHITE_SKY;
    let vfov_degrees = (2.0 * f64::atan(half_side / away)).to_degrees();
    let settings = RenderSettings { max_depth: 2, ..size(64, 64) };
    let film =
        render(&mut widest(), &job(&scene, Camera { vfov_degrees, ..Camera::BOOK }, settings), 0..SAMPLES);
    let covered = std::f64::consts::PI / (2.0 * half_side).powi(2);
    let share = 1.0 - (1.0 - mean(&film)) / covered;
    let paths = 64.0 * 64.0 * SAMPLES as f64;
    let deviation = (share * (1.0 - share) / (paths * covered)).sqrt();
    println!("case 16: share {share:.6}, 1/21 = {:.6}, standard error {deviation:.1e}", 1.0 / 21.0);
    assert!((share - 1.0 / 21.0).abs() <= 4.0 * deviation, "{share} +- {deviation}");
}

#[test]
fn case_17_refraction_index_a_million() {
    let of = |material: Material| {
        let scene = scene(&[(DVec3::ZERO, 1.0, material)]);
        render(&mut widest(), &job(&scene, ball_view(), size(64, 64)), 0..256)
    };
    let difference = mean(&of(glass(1e6))) - mean(&of(mirror(1.0)));
    println!("case 17: mean difference {difference:.2e}");
    assert!(difference.abs() <= 1e-4, "{difference:e}");
}

/// From 0.9 of the radius, a ray at the angle `a` to the axis arrives with the sine `0.9 sin a`. Above 1/1.5 it is
/// reflected forever at the same angle.
#[test]
fn case_18_eye_in_glass() {
    let (width, height) = (96, 96);
    let scene = scene(&[(DVec3::ZERO, 1.0, glass(1.5))]);
    let camera = Camera {
        look_from: DVec3::new(0.0, 0.0, 0.9),
        look_at: DVec3::new(0.0, 0.0, 2.0),
        vfov_degrees: 150.0,
        ..Camera::BOOK
    };
    for max_depth in [50, 1000] {
        let settings = RenderSettings { max_depth, ..size(width, height) };
        let film = render(&mut widest(), &sharp_job(&scene, camera, settings), 0..16);
        let (mut trapped, mut free) = (0, 0);
        for y in 0..height {
            for x in 0..width {
                let (_, d) = centre_ray(&camera, width, height, x, y);
                let refracted_sine = 1.5 * 0.9 * (1.0 - d.z * d.z).sqrt();
                let sum = film.pixel_sum((y * width + x) as usize).0;
                if refracted_sine > 1.0 + 1e-5 {
                    trapped += 1;
                    assert_eq!(sum, [0; 3], "pixel {x}, {y}: {refracted_sine}");
                } else if refracted_sine < 1.0 - 1e-5 {
                    free += 1;
                    assert!(sum[0] > 0, "pixel {x}, {y} is black: {refracted_sine}");
                }
            }
        }
        assert!(trapped > 1000 && free > 200, "{trapped} and {free}");
    }
}

fn grazing<const FUSED: bool>() {
    let l = Scalar::<FUSED>;
    let mut random = Random::new(7);
    for step in 0..20_000 {
        let index = if step == 0 { 1.0 } else { random.log_within(1e-3, 1e3) };
        let material = glass_lanes(l, index);
        assert_eq!(reflectance(l, l.constant(0.0), material.f0).0, 1.0, "index {index}");
        let normal = random.direction();
        let direction = perpendicular(normal, &mut random);
        for front in [false, true] {
            // The largest random number below 1.
            let coin = l.splat(crate::common::oracle::unit_float(u32::MAX));
            let zero = v3(l, DVec3::ZERO);
            let scattered = |laws: DielectricLaws| {
                let (direction, normal) = (v3(l, direction), v3(l, normal));
                scatter::<_, true>(
                    l,
                    &material,
                    laws,
                    direction,
                    normal,
                    &incidence_of(l, l.constant(0.0)),
                    front,
                    zero,
                    coin,
                )
            };
            let bounced = scattered(DielectricLaws::Schlick);
            assert!(!bounced.refracts, "index {index} lets light through at a grazing angle");
            let bounced = vector::<Scalar<FUSED>>(bounced.direction);
            assert!((bounced - direction).length() < 1e-6, "{bounced}, not {direction}");
            // `RefractOnly` does not check whether Snell's law has a solution: its direction is wrong, but finite.
            let wrong = scattered(DielectricLaws::RefractOnly);
            assert!(vector::<Scalar<FUSED>>(wrong.direction).is_finite());
        }
    }
}

#[test]
fn case_20_grazing() {
    grazing::<false>();
    grazing::<true>();
}

#[test]
fn case_21_fuzz_5_is_fuzz_1() {
    let of = |fuzz: f64| {
        let metal = Material::Metal { albedo: DVec3::splat(0.8), fuzz };
        let scene = scene(&[(DVec3::ZERO, 1.0, metal), (DVec3::new(0.0, -11.0, 0.0), 10.0, lambertian(0.5))]);
        render(&mut widest(), &job(&scene, ball_view(), size(48, 48)), 0..16)
    };
    assert_eq!(of(5.0), of(1.0));
    assert_ne!(of(0.9), of(1.0));
}

#[test]
fn case_22_mirrors_have_no_noise() {
    let scene = scene(&[
        (DVec3::new(0.0, -100.5, -1.0), 100.0, mirror(0.9)),
        (DVec3::new(-0.55, 0.0, -1.0), 0.5, mirror(0.8)),
        (DVec3::new(0.55, 0.0, -1.2), 0.5, mirror(0.7)),
    ]);
    let film = |seed, sampler| {
        let settings = RenderSettings { seed, sampler, ..size(64, 36) };
        render(&mut widest(), &sharp_job(&scene, Camera::BOOK, settings), 0..8)
    };
    let one = film(0, SamplerKind::Sobol);
    assert_eq!(one.halves()[0], one.halves()[1]);
    for (seed, sampler) in [(1, SamplerKind::Sobol), (12_345, SamplerKind::Independent)] {
        assert_eq!(film(seed, sampler), one);
    }
}

#[test]
fn sine_rounded_above_1_is_grazing() {
    let l = Reference;
    for sine2 in [0.0, 0.25, 1.0, 1.0 + f64::EPSILON, 1.1] {
        let incidence = incidence_of_sine2(l, l.constant(sine2));
        let found = [incidence.sine2, incidence.cosine].map(first::<Reference>);
        let expected = sine2.min(1.0);
        assert_eq!(found, [expected, (1.0 - expected).sqrt()], "{sine2}");
    }
}
