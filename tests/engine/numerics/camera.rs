//! The camera: cases 31 to 34. (Book 1, sections 12 and 13.)
//!
//! tests/scene_files and tests/cli check that invalid cameras in scene files and flags are refused.

use crate::numerics::common::*;
use glam::{DMat3, DVec3};
use weekender::job::render::Viewport;
use weekender::kernel::CameraTable;
use weekender::render_cpu::camera::{lens_ray, pinhole_ray, screen};
use weekender::render_cpu::lanes::{Lanes, Scalar, Wide};
use weekender::scene::builtin::{LeftSphere, three_spheres};
use weekender::scene::{Camera, Scene, Sky};

/// A sky whose three channels show how steeply a ray rises.
const SKY: Sky = Sky { bottom: DVec3::new(0.0, 1.0, 0.5), top: DVec3::new(1.0, 0.0, 0.5) };

/// The picture of an empty scene, each pixel the mean over a fine grid.
fn expected_sky(camera: &Camera, width: u32, height: u32) -> Vec<[f64; 3]> {
    const GRID: u32 = 32;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let of_pixel = |(x, y): (u32, u32)| {
        let mut sum = DVec3::ZERO;
        for (i, j) in (0..GRID).flat_map(|i| (0..GRID).map(move |j| (i, j))) {
            let [x, y] =
                [(x, i), (y, j)].map(|(pixel, k)| f64::from(pixel) + (f64::from(k) + 0.5) / f64::from(GRID));
            let (_, direction) = view_ray(camera, width, height, x, y);
            sum += SKY.bottom.lerp(SKY.top, 0.5 * (direction.normalize().y + 1.0));
        }
        (sum / f64::from(GRID * GRID)).to_array()
    };
    pixels.map(of_pixel).collect()
}

fn assert_sees_the_sky(camera: Camera, [width, height]: [u32; 2]) {
    let scene = Scene { sky: SKY, ..Scene::default() };
    for mut renderer in [widest(), portable()] {
        let film = render(&mut renderer, &job(&scene, camera, size(width, height)), 0..64);
        for (pixel, expected) in expected_sky(&camera, width, height).iter().enumerate() {
            let mean = film.mean(pixel);
            let off = (0..3).map(|i| (mean[i] - expected[i]).abs()).fold(0.0, f64::max);
            assert!(off < 0.02, "{camera:?}, pixel {pixel}: {mean:?}, expected {expected:?}");
        }
    }
}

#[test]
fn case_31_up_along_the_view() {
    for view in [DVec3::Y, DVec3::NEG_Y, DVec3::X, DVec3::new(1.0, -2.0, 0.5), DVec3::splat(1e-9)] {
        for vup in
            [view, -view, view * 1e100, DVec3::ZERO, view + view.length() * DVec3::new(0.0, 1e-17, 0.0)]
        {
            let refused = Camera { look_at: view, vup, ..Camera::BOOK };
            let message = refused.validate().unwrap_err().to_string();
            let (_, remedy) = message.split_once("use another, such as ").unwrap();
            let remedy: [f64; 3] = serde_json::from_str(remedy).unwrap();
            Camera { vup: remedy.into(), ..refused }.validate().unwrap();
        }
        let aside = view.any_orthogonal_vector().normalize() * view.length();
        for vup in [view + 1e-6 * aside, -view + 1e-8 * aside, 1e100 * (view - 1e-3 * aside)] {
            let camera = Camera { look_at: view, vup, ..Camera::BOOK };
            camera.validate().unwrap();
            let basis = camera.basis();
            let frame = DMat3::from_cols(basis.u, basis.v, basis.w);
            let off = frame.transpose() * frame - DMat3::IDENTITY;
            assert!(off.to_cols_array().iter().all(|x| x.abs() < 1e-12), "{camera:?}: {basis:?}");
            assert!((frame.determinant() - 1.0).abs() < 1e-12, "not mirrored: {basis:?}");
            assert!((basis.w + view.normalize()).length() < 1e-12, "{camera:?}: {basis:?}");
        }
        let vup = view + 1e-6 * aside;
        assert_sees_the_sky(Camera { look_at: view, vup, ..Camera::BOOK }, [8, 8]);
    }
    let nowhere = Camera { look_from: DVec3::ONE, look_at: DVec3::ONE, ..Camera::BOOK };
    assert!(nowhere.validate().unwrap_err().to_string().contains("no direction"));
}

#[test]
fn case_32_fields_of_view() {
    for vfov_degrees in [0.0, 180.0, f64::NAN] {
        let refused = Camera { vfov_degrees, ..Camera::BOOK }.validate().unwrap_err().to_string();
        assert!(refused.contains("vfov_degrees"), "{refused}");
        assert!(vfov_degrees.is_nan() || refused.contains("between 0.01 and 179 degrees"), "{refused}");
    }
    for vfov_degrees in [0.01, 179.0] {
        for look_at in [DVec3::NEG_Z, DVec3::new(1.0, 0.8, -1.0), DVec3::new(0.0, -3.0, -1.0)] {
            assert_sees_the_sky(Camera { vfov_degrees, look_at, ..Camera::BOOK }, [16, 9]);
        }
    }
}

#[test]
fn case_33_lenses() {
    for (defocus_angle_degrees, focus_distance, is_valid) in [
        (0.0, Some(0.0), false),
        (180.0, Some(1.0), false),
        (179.0, Some(1.0), false),
        (178.9, Some(1.0), true),
        (0.6, Some(1e-18), true),
        (178.9, Some(1e18), true),
    ] {
        let camera = Camera { defocus_angle_degrees, focus_distance, ..Camera::BOOK };
        match camera.validate() {
            Ok(()) => {
                assert!(is_valid, "{camera:?}");
                let scene = three_spheres(LeftSphere::HollowGlass);
                for mut renderer in [widest(), portable()] {
                    let film = render(&mut renderer, &job(&scene, camera, size(16, 9)), 0..4);
                    assert_eq!(film.rejected(), 0);
                    // No pixel is brighter than the sky's 1, and the sky is visible somewhere.
                    let channels = || film.means().into_iter().flatten();
                    assert!(channels().all(|x| (0.0..=1.0).contains(&x)), "{camera:?}");
                    assert!(channels().any(|x| x > 0.3), "{camera:?}");
                }
            }
            Err(error) => {
                assert!(!is_valid, "{error}");
                let message = error.to_string();
                assert!(message.contains("focus_distance") || message.contains("below 179"), "{message}");
            }
        }
    }
}

/// Where a direction points in the picture, in pixels.
fn pixel_of(camera: &Camera, width: u32, height: u32, d: DVec3) -> [f64; 2] {
    let basis = camera.basis();
    let pixel = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan() / f64::from(height);
    let depth = -d.dot(basis.w);
    [
        d.dot(basis.u) / depth / pixel + 0.5 * f64::from(width),
        -d.dot(basis.v) / depth / pixel + 0.5 * f64::from(height),
    ]
}

fn pixel_error<L: Lanes>(l: L, camera: &Camera) -> f64 {
    let (width, height) = (800, 450);
    let table =
        CameraTable::<L::Real>::new(camera, &Viewport::WHOLE, [width, height], DVec3::ZERO).map(Wide::splat);
    let tau = (camera.defocus_angle_degrees.to_radians() / 2.0).tan();
    let pixel = 2.0 * (camera.vfov_degrees.to_radians() / 2.0).tan() / f64::from(height);
    let mut random = Random::new(8);
    let mut largest = 0.0_f64;
    for _ in 0..20_000 {
        let (x, y) = (random.within(0.0, 800.0).floor(), random.within(0.0, 450.0).floor());
        let jitter = [random.unit(), random.unit()].map(|u| f64::from(u as f32));
        let corner = screen(l, &table, l.constant(x), l.constant(y));
        let in_pixel = jitter.map(|u| l.constant(u));
        let (turn, radius) = (random.within(0.0, std::f64::consts::TAU), random.unit().sqrt());
        let on_lens = [radius * turn.cos(), radius * turn.sin()].map(|u| f64::from(u as f32));
        let (rays, shift) = if tau > 0.0 {
            let rays = lens_ray(l, &table, corner, in_pixel, on_lens.map(|u| l.constant(u)));
            (rays, on_lens.map(|u| tau * u / pixel))
        } else {
            (pinhole_ray(l, &table, corner, in_pixel), [0.0; 2])
        };
        let found = pixel_of(camera, width, height, vector::<L>(rays.direction));
        // The lens moves the origin by `F tau xi`, so the direction points back as far at the focus distance.
        let expected = [x + jitter[0] - shift[0], y + jitter[1] + shift[1]];
        largest = largest.max((found[0] - expected[0]).abs()).max((found[1] - expected[1]).abs());
    }
    largest
}

#[test]
fn case_34_camera_at_a_million() {
    let look_from = DVec3::new(1e6, -1e6, 1e6);
    for defocus_angle_degrees in [0.0, 0.6] {
        let camera = Camera {
            look_from,
            look_at: look_from + DVec3::new(0.3, 0.2, -1.0),
            vfov_degrees: 20.0,
            focus_distance: Some(1.0),
            defocus_angle_degrees,
            ..Camera::BOOK
        };
        for (name, error) in [
            ("fused", pixel_error(Scalar::<true>, &camera)),
            ("unfused", pixel_error(Scalar::<false>, &camera)),
        ] {
            println!("case 34 {name}, defocus {defocus_angle_degrees}: {error:.2e} pixels");
            assert!(error <= 1e-3, "{name}, defocus {defocus_angle_degrees}: {error} pixels");
        }
    }
}
