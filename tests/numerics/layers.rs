//! Spheres that are thin, close to others, small or far away: rendered right, or reported.

use crate::common::*;
use crate::stiff::*;
use glam::DVec3;
use weekender::prepared::PreparedScene;
use weekender::render::RenderSettings;
use weekender::scene::{Camera, Material, Scene, Sky};

#[test]
fn layers_too_thin_for_single_precision_are_told() {
    let warnings = |thickness: f64| {
        let (scene, camera) = shells_at(DVec3::ZERO, thickness);
        PreparedScene::<f32>::new(&job(&scene, camera, size(2, 2))).warnings().to_vec()
    };
    assert!(warnings(1e-4).is_empty(), "{:?}", warnings(1e-4));
    let crossing = |by: f64, second: Material| {
        let balls = [(DVec3::ZERO, 1.0, glass(1.5)), (DVec3::X * by, 1.0, second)];
        !PreparedScene::<f32>::new(&job(&scene(&balls), AT_BALL, size(2, 2))).warnings().is_empty()
    };
    assert!(crossing(1e-5, lambertian(0.5)) && crossing(2e-3, lambertian(0.5)));
    assert!(!crossing(0.1, lambertian(0.5)));
    assert!(crossing(1e-8, glass(1.5)));
    let matte_crossing = |by: f64| {
        let balls = [(DVec3::ZERO, 1.0, lambertian(0.5)), (DVec3::X * by, 1.0, lambertian(0.8))];
        !PreparedScene::<f32>::new(&job(&scene(&balls), AT_BALL, size(2, 2))).warnings().is_empty()
    };
    assert!(matte_crossing(1e-5) && !matte_crossing(1e-3));
    let thin = warnings(1e-7);
    assert!(
        thin.len() == 1 && thin[0].contains("--device reference") && thin[0].contains("1.0e-7"),
        "{thin:?}"
    );
    // There are two such balls; with one, nothing is counted.
    assert!(thin[0].contains("(2 such layers in all)"), "{thin:?}");
    let (mut scene, camera) = shells_at(DVec3::ZERO, 1e-7);
    scene.spheres.truncate(2);
    let one = PreparedScene::<f32>::new(&job(&scene, camera, size(2, 2))).warnings().to_vec();
    assert!(one.len() == 1 && !one[0].contains("in all"), "{one:?}");
}

/// The distance counts, so a camera that moves can bring a warning and take it away.
#[test]
fn warnings_are_those_of_the_camera_even_if_the_hierarchy_is_kept() {
    let mut balls: Vec<_> = (0..30)
        .map(|i| (DVec3::new(f64::from(i % 6) - 3.0, -2.0, -f64::from(i / 6)), 0.3, lambertian(0.5)))
        .collect();
    balls.extend([(DVec3::ZERO, 1.0, glass(1.5)), (DVec3::ZERO, 1.0 - 1e-4, glass(1.0 / 1.5))]);
    let scene = scene(&balls);
    let camera = |z: f64| Camera { look_from: DVec3::Z * z, look_at: DVec3::ZERO, ..Camera::BOOK };
    let near = job(&scene, camera(4.0), size(2, 2));
    let mut prepared = PreparedScene::<f32>::new(&near);
    let mut before = near.clone();
    for (z, count) in [(4.0, 0), (1000.0, 1), (4.0, 0)] {
        let job = near.seen_by(camera(z), size(2, 2)).unwrap();
        assert!(prepared.follow(&before, &job), "{z}");
        assert_eq!(prepared.warnings().len(), count, "{z}: {:?}", prepared.warnings());
        assert_eq!(prepared.warnings(), PreparedScene::<f32>::new(&job).warnings(), "{z}");
        before = job;
    }
}

/// How thin a layer may be: prints it, and checks thicknesses without a warning.
#[test]
fn layers_without_a_warning_are_right() {
    for thickness in [1e-7, 2e-7, 5e-7, 1e-6, 3e-6, 1e-5, 1e-4] {
        let (scene, camera) = shells_at(DVec3::ZERO, thickness);
        let job = job(&scene, camera, size(64, 36));
        let is_told = !PreparedScene::<f32>::new(&job).warnings().is_empty();
        let found = paired(&job, 16, &mut widest(), &mut reference());
        println!("{thickness:e} ({is_told}): {found:?}");
        assert!(is_told || found.bias.abs() < 1e-4, "{thickness:e}: {found:?}");
    }
}

/// Paths that start between two opaque balls stay there, unless rounding lets them out where the surfaces cross.
#[test]
fn crossing_balls_around_the_eye_are_told() {
    let balls =
        |by: f64| [(DVec3::ZERO, 1.0, lambertian(1.0)), (DVec3::new(by, 0.0, 0.0), 1.0, lambertian(1.0))];
    let is_told = |height: f64, defocus_angle_degrees: f64| {
        let look_from = DVec3::Y * (1.0 + height);
        let camera =
            Camera { look_from, look_at: DVec3::ZERO, vup: DVec3::Z, defocus_angle_degrees, ..Camera::BOOK };
        !PreparedScene::<f32>::new(&job(&under_white_sky(&balls(4.5e-3)), camera, size(2, 2)))
            .warnings()
            .is_empty()
    };
    assert!(is_told(-0.5, 0.0), "within");
    assert!(is_told(1e-3, 1.0), "on the surface, with a lens");
    assert!(!is_told(0.5, 1.0), "outside, where no path is between them");
}

/// From afar a coat and the ball in it are at the same rounded distance, although both are small and their
/// coordinates are precise.
#[test]
fn coats_seen_from_afar_are_told_or_right() {
    let center = DVec3::new(0.188, 1.469, 2.204);
    let coated = |thickness: f64| {
        let balls = [(center, 0.003, glass(20.0)), (center, 0.003 - thickness, lambertian(0.5))];
        let camera = Camera { look_from: DVec3::ZERO, look_at: center, vfov_degrees: 0.2, ..Camera::BOOK };
        let job = job(&under_white_sky(&balls), camera, size(16, 12));
        let is_told = !PreparedScene::<f32>::new(&job).warnings().is_empty();
        (is_told, paired(&job, 64, &mut widest(), &mut reference()).bias.abs())
    };
    for units in [1.0, 2.0, 4.5, 8.5, 32.0] {
        let (is_told, bias) = coated(units * center.length() * f64::from(f32::EPSILON) / 2.0);
        println!("{units} ({is_told}): {bias:e}");
        assert!(is_told || bias < 1e-4, "{units}: {bias:e}");
        assert_eq!(is_told, units < 8.0, "{units}");
    }
}

/// Just above a power of two, distances are rounded most coarsely: glass hidden by a matte ball could
/// show through.
#[test]
fn hidden_glass_seen_from_afar_is_told_or_right() {
    let center = DVec3::new(-0.332_889_082_107, 0.057_077_657_354, -0.434_654_799_599);
    let radius = 0.012_538_616_9;
    for thickness in [1.444e-7, 2e-7, 5e-7] {
        let balls = [
            (center, radius, lambertian(0.5)),
            (center, radius - thickness, glass(2.0 / 3.0)),
            (DVec3::new(-0.34, 0.0605, -0.445), 7e-4, lambertian(0.5)),
        ];
        let camera = Camera { look_from: DVec3::ZERO, look_at: center, vfov_degrees: 1.0, ..Camera::BOOK };
        let settings = RenderSettings { max_depth: 2, ..size(16, 12) };
        let job = job(&under_white_sky(&balls), camera, settings);
        let is_told = !PreparedScene::<f32>::new(&job).warnings().is_empty();
        let bias = paired(&job, 256, &mut widest(), &mut reference()).bias.abs();
        println!("{thickness:e} ({is_told}): {bias:e}");
        assert!(is_told || bias < 1e-4, "{thickness:e}: {bias:e}");
    }
}

/// Details close to the eye are resolved, even where a small ball lies near the far side of the same planet.
#[test]
fn a_planet_is_resolved_at_the_eye_whatever_lies_beyond() {
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

/// Where glass touches a ball hundreds of times larger, a ray that leaves the glass may start below the ball's surface,
/// and must hit it nevertheless. With two rays per path the ground is black from inside; bright pixels have leaked.
#[test]
fn nothing_leaks_where_glass_touches_the_ground() {
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

/// A picture of something small is as sharp as single precision allows, wherever the origin is.
#[test]
fn small_balls_near_the_origin_are_where_they_are() {
    let center = DVec3::new(-0.000_118, 0.001_18, 0.002_05);
    let scene = Scene {
        sky: Sky { bottom: DVec3::ZERO, top: DVec3::new(0.5, 1.0, 2.0) },
        ..scene(&[(center, 4e-6, mirror(1.0))])
    };
    let look_from = DVec3::new(-0.000_11, 0.0012, 0.002);
    let camera = Camera { look_from, look_at: center, vfov_degrees: 3.0, ..Camera::BOOK };
    let settings = RenderSettings { max_depth: 2, ..size(16, 12) };
    let found = paired(&job(&scene, camera, settings), 256, &mut widest(), &mut reference());
    assert!(found.bias.abs() < 4e-6, "{found:?}");
}

/// The surface nearest to the eye need not be the one that it looks at.
#[test]
fn a_small_ball_beside_a_larger_one_is_where_it_is() {
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

/// On far balls, the normal at a hit has length 1 however coarsely the distance is rounded.
#[test]
fn specks_are_shaded_as_balls_are() {
    for radius in [1e-4, 1e-6, 1e-8] {
        let balls = [(DVec3::new(0.0, 0.0, -1.0), radius, lambertian(0.5))];
        let camera = Camera { vfov_degrees: 0.01, ..Camera::BOOK };
        let prepared = PreparedScene::<f32>::new(&job(&under_white_sky(&balls), camera, size(2, 2)));
        assert!(prepared.features.specks || radius > 5e-5, "{radius:e}");
    }
}
