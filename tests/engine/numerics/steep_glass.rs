//! Light that enters steep glass (an index outside of 1/4 to 4, or paths of many rays) and leaves it again.
//!
//! The `f64` reference has the same code as the packets, so these cases compare with Snell's law itself.

use crate::numerics::common::*;
use crate::numerics::stiff::{Ball, under_white_sky};
use glam::DVec3;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::scene::{Camera, Material, Scene, Sky};
use weekender::stages::{DielectricLaws, Rules};

/// Every ray has only one possible path.
const WITHOUT_CHANCE: Rules =
    Rules { dielectric: DielectricLaws::TotalReflection, antialiasing: false, ..Rules::FINISHED };

/// Black below, white above: a sample shows how steeply its path left.
const SLOPE: Sky = Sky { bottom: DVec3::ZERO, top: DVec3::ONE };

const VIEW: Camera =
    Camera { look_from: DVec3::new(0.3, 0.2, 4.0), look_at: DVec3::ZERO, vfov_degrees: 32.0, ..Camera::BOOK };

/// The direction in which a ray leaves glass balls, by Snell's law. `None` if rounding could divert it.
fn way_out(mut origin: DVec3, mut direction: DVec3, balls: &[Ball]) -> Option<DVec3> {
    loop {
        let mut nearest: Option<(f64, DVec3, f64)> = None;
        for (center, radius, material) in balls {
            let Material::Dielectric { refraction_index } = *material else { continue };
            for t in exact_roots(origin, direction, *center, *radius).into_iter().flatten() {
                if t > 1e-9 && nearest.is_none_or(|(other, ..)| t < other) {
                    nearest = Some((t, (origin + direction * t - *center) / *radius, refraction_index));
                }
            }
        }
        let Some((t, outward, index)) = nearest else { return Some(direction) };
        origin += direction * t;
        let is_front = direction.dot(outward) < 0.0;
        let (normal, ratio) = if is_front { (outward, 1.0 / index) } else { (-outward, index) };
        let cosine = -direction.dot(normal);
        let refracted_sine2 = ratio * ratio * (1.0 - cosine * cosine);
        if cosine < 0.2 || (refracted_sine2 - 1.0).abs() < 0.1 {
            return None;
        }
        direction = if refracted_sine2 > 1.0 {
            direction + normal * (2.0 * cosine)
        } else {
            direction * ratio + normal * (ratio * cosine - (1.0 - refracted_sine2).sqrt())
        };
    }
}

#[test]
fn steep_glass_obeys_snell() {
    let (width, height) = (48, 48);
    let ball = |index: f64| vec![(DVec3::ZERO, 1.0, glass(index))];
    let shell = |index: f64| vec![(DVec3::ZERO, 1.0, glass(index)), (DVec3::ZERO, 0.5, glass(1.0 / index))];
    let cases = [
        (ball(5.0), 50),
        (ball(20.0), 50),
        (ball(0.2), 50),
        (ball(1.5), 100),
        (ball(1.0 / 1.5), 100),
        (shell(5.0), 50),
        (shell(1.5), 100),
    ];
    for (balls, max_depth) in &cases {
        let scene = Scene { sky: SLOPE, ..scene(balls) };
        let settings = RenderSettings { max_depth: *max_depth, ..size(width, height) };
        let job = RenderJob::new(scene, VIEW, settings, WITHOUT_CHANCE).unwrap();
        for renderer in [&mut widest(), &mut portable(), &mut reference()] {
            let film = render(renderer, &job, 0..1);
            let mut known = 0;
            for y in 0..height {
                for x in 0..width {
                    let (origin, direction) = centre_ray(&VIEW, width, height, x, y);
                    let Some(out) = way_out(origin, direction, balls) else { continue };
                    known += 1;
                    let (found, expected) = (film.mean((y * width + x) as usize)[0], 0.5 + 0.5 * out.y);
                    assert!(
                        (found - expected).abs() < 1e-4,
                        "pixel {x}, {y} of {balls:?}: {found}, not {expected}"
                    );
                }
            }
            assert!(known > 2000, "{known} of {balls:?}");
        }
    }
}

/// Nothing is absorbed, and light that enters a ball can leave it, however often it is reflected inside.
#[test]
fn steep_glass_loses_no_light() {
    for index in [0.1, 1.5, 5.0, 20.0, 100.0] {
        let scene = under_white_sky(&[(DVec3::ZERO, 1.0, glass(index))]);
        let job = job(&scene, VIEW, RenderSettings { max_depth: 2000, ..size(24, 24) });
        for renderer in [&mut widest(), &mut reference()] {
            let found = mean(&render(renderer, &job, 0..8));
            assert!((found - 1.0).abs() < 1e-6, "index {index}: {found}");
        }
    }
}
