//! Spheres that are thin, close together, small or far away: rendered right, or reported.

use crate::common::*;
use crate::stiff::*;
use glam::DVec3;
use weekender::job::render::RenderSettings;
use weekender::scene::{Camera, Scene, Sky};

/// Details near the eye are resolved, even with a small ball near the far side of the same planet.
#[test]
fn planet_is_resolved_near_eye() {
    let (radius, height) = (8.8e9, 5.6e4);
    let toward = DVec3::new(-0.181, 0.734, -0.6546).normalize();
    let planet = (toward * (radius + height), radius, lambertian(0.5));
    let beyond = (toward * (radius + height) + DVec3::Y * (radius + 640.0), 600.0, lambertian(0.5));
    let camera = Camera {
        look_from: DVec3::ZERO,
        look_at: DVec3::new(-1.6e9, 1.5e10, -5.8e9),
        vfov_degrees: 100.0,
        defocus_angle_degrees: 0.0016,
        ..Camera::BOOK
    };
    let settings = RenderSettings { max_depth: 3, ..size(16, 12) };
    let job = job(&under_white_sky(&[planet, beyond]), camera, settings);
    let found = paired(&job, 256, &mut widest(), &mut reference());
    assert!(found.bias.abs() < 1e-5, "{found:?}");
}

/// Where glass touches a ball hundreds of times larger, a ray that leaves the glass may start below the ball's surface
/// and must still hit it. With two rays per path the ground is black from inside; bright pixels have leaked.
#[test]
fn no_leaks_where_glass_touches_ground() {
    let (eye, radius, ground) = (DVec3::new(0.3, 0.2, -0.1), 10.3, 4073.8);
    let down = DVec3::new(-0.1, -1.0, -0.2).normalize();
    for overlap in [0.0, 1e-4, 3e-3, 0.1] {
        let below = eye + down * (radius + ground - overlap);
        let balls = [(eye, radius, glass(1.000_001)), (below, ground, lambertian(0.5))];
        let camera = Camera { look_from: eye, look_at: below, vfov_degrees: 10.0, ..Camera::BOOK };
        let settings = RenderSettings { max_depth: 2, ..size(16, 12) };
        let found =
            paired(&job(&under_white_sky(&balls), camera, settings), 64, &mut widest(), &mut reference());
        assert!(found.bias.abs() < 1e-5, "{overlap}: {found:?}");
    }
}

/// The surface nearest to the eye need not be the one it looks at.
#[test]
fn small_ball_beside_larger_is_exact() {
    let small = DVec3::new(0.014_095_8, 0.034_369_6, 0.036_614_1);
    let scene = Scene {
        sky: Sky { bottom: DVec3::ZERO, top: DVec3::new(0.5, 1.0, 2.0) },
        ..scene(&[(DVec3::new(0.013, 0.035, 0.036), 5e-4, lambertian(0.5)), (small, 7e-5, mirror(0.5))])
    };
    let look_from = DVec3::new(0.013, 0.034, 0.037);
    let settings = RenderSettings { max_depth: 2, ..size(16, 12) };
    for shift in [DVec3::ZERO, DVec3::new(0.007_812_5, -0.015_625, 0.003_906_25)] {
        let mut scene = scene.clone();
        scene.spheres.iter_mut().for_each(|sphere| sphere.center += shift);
        let look_at = DVec3::new(0.014_09, 0.034_355, 0.036_626) + shift;
        let camera = Camera { look_from: look_from + shift, look_at, vfov_degrees: 1.0, ..Camera::BOOK };
        let found = paired(&job(&scene, camera, settings), 256, &mut widest(), &mut reference());
        assert!(found.bias.abs() < 4e-6, "{shift}: {found:?}");
    }
}
