//! Stiff scenes: copies, shells, an eye on a surface or far from the origin, angles near the critical angle.

use crate::common::*;
use crate::film::trace_tables;
use glam::DVec3;
use weekender::film::Film;
use weekender::job::render::{RenderJob, RenderSettings};
use weekender::prepared::PreparedScene;
use weekender::prepared::hierarchy::{DEPTH_LIMIT, Effort, Hierarchy};
use weekender::scene::builtin::{LeftSphere, three_spheres};
use weekender::scene::{Camera, Material, Scene, Sky};

pub type Ball = (DVec3, f64, Material);

const WHITE: Sky = Sky { bottom: DVec3::ONE, top: DVec3::ONE };

pub fn under_white_sky(balls: &[Ball]) -> Scene {
    Scene { sky: WHITE, ..scene(balls) }
}

/// The balls and forty more far behind the eye, enough for a hierarchy.
pub fn among_many(balls: &[Ball]) -> Vec<Ball> {
    let far = |i: u32| (DVec3::new(f64::from(i) - 20.0, 0.0, 500.0), 0.1, lambertian(0.5));
    balls.iter().copied().chain((0..40).map(far)).collect()
}

/// A camera 3 units from the unit ball at the origin, with a view so narrow that nothing else is visible.
pub const AT_BALL: Camera =
    Camera { look_from: DVec3::new(0.0, 0.0, 3.0), look_at: DVec3::ZERO, vfov_degrees: 20.0, ..Camera::BOOK };

/// Renders as a list and with a hierarchy, checks that both exist and give the same film, and returns it.
fn as_list_and_hierarchy(job: &RenderJob, samples: u64) -> Film {
    let prepared = PreparedScene::<f32>::new(job);
    let [mut listed, mut boxed] = [job.new_film(), job.new_film()];
    assert!(prepared.hierarchy.is_some(), "there is a hierarchy");
    trace_tables(&prepared, &mut boxed, 0..samples);
    trace_tables(&PreparedScene::as_list(job), &mut listed, 0..samples);
    assert_eq!(listed, boxed, "list and hierarchy");
    boxed
}

fn shown_mean(job: &RenderJob, samples: u64) -> f64 {
    mean(&render(&mut widest(), job, 0..samples))
}

#[test]
fn copies_look_like_one_ball() {
    let ball = (DVec3::ZERO, 1.0, lambertian(0.5));
    for copies in [1, 2, 110, 3000] {
        let balls = among_many(&vec![ball; copies]);
        let job = job(&under_white_sky(&balls), AT_BALL, size(4, 4));
        let film = as_list_and_hierarchy(&job, 16);
        for pixel in 0..16 {
            assert_eq!(film.mean(pixel), [0.5; 3], "{copies} copies");
        }
    }
}

#[test]
fn first_of_coloured_copies_is_visible() {
    let coloured = |albedo| (DVec3::ZERO, 1.0, Material::Lambertian { albedo });
    for (first, second) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::X)] {
        let balls = [coloured(first), coloured(second)];
        let alone = render(&mut widest(), &job(&under_white_sky(&balls), AT_BALL, size(2, 2)), 0..4);
        let many = as_list_and_hierarchy(&job(&under_white_sky(&among_many(&balls)), AT_BALL, size(2, 2)), 4);
        for pixel in 0..4 {
            assert_eq!(alone.mean(pixel), first.to_array());
            assert_eq!(many.mean(pixel), first.to_array());
        }
    }
}

/// Shells about one centre, and many balls in one place, do not make a tree too deep to traverse.
#[test]
fn shells_and_crowds_have_low_trees() {
    let ball = |center, radius| weekender::scene::Sphere { center, radius, material: 0 };
    let mut random = Random::new(5);
    let shells: Vec<_> = (1..=6000).map(|i| ball(DVec3::ZERO, 1e-3 * f64::from(i))).collect();
    let halves: Vec<_> = (0..60).map(|i| ball(DVec3::X, 0.5_f64.powi(i))).collect();
    let crowd: Vec<_> = (0..6000).map(|_| ball(random.in_box(1e-3), random.within(0.5, 1.5))).collect();
    let copies = vec![ball(DVec3::Y, 1.0); 6000];
    let row: Vec<_> = (0..6000).map(|i| ball(DVec3::X * f64::from(i), 0.5)).collect();
    for spheres in [&shells, &halves, &crowd, &copies, &row] {
        let hierarchy = Hierarchy::<f32>::build(spheres, DVec3::ZERO, Effort::Quick);
        let mut order = hierarchy.ranks.clone();
        order.sort_unstable();
        assert!(order.iter().enumerate().all(|(place, rank)| place == *rank as usize), "each once");
        println!("{} spheres: {} levels", spheres.len(), hierarchy.depth());
        assert!(hierarchy.depth() <= DEPTH_LIMIT);
        assert!(weekender::prepared::wide_bvh::WideBvh::build(spheres, DVec3::ZERO).depth() <= 24);
    }
}

#[test]
fn eye_on_surface_sees_sky() {
    let up = DVec3::new(0.3, 0.8, -0.5).normalize();
    for material in [lambertian(0.5), mirror(0.9), glass(1.5)] {
        for radius in [1e-3, 0.5, 1000.0, 1e7] {
            for center in [DVec3::ZERO, DVec3::new(3.0, -7.0, 11.0), DVec3::new(1e4, 1e5, -3e3)] {
                let ball = (center, radius, material);
                let foot = center + up * radius;
                for height in [0.0, 1e-9, 1e-6, 1e-4] {
                    let eye = foot + up * height * radius.min(1.0);
                    let camera = Camera { look_from: eye, look_at: eye + up, ..AT_BALL };
                    for balls in [vec![ball], among_many(&[ball])] {
                        let film =
                            render(&mut widest(), &job(&under_white_sky(&balls), camera, size(8, 8)), 0..4);
                        for pixel in 0..64 {
                            assert_eq!(
                                film.mean(pixel),
                                [1.0; 3],
                                "{radius} {center} {height:e} {material:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}

/// An eye on a surface counts as outside.
#[test]
fn eye_on_surface_is_outside() {
    for (radius, height) in [(0.5, 0.0), (1000.0, 0.0), (1000.0, 1e-12), (0.5, 1e-10)] {
        let center = DVec3::new(0.0, -radius, 0.0);
        let eye = DVec3::new(0.0, height, 0.0);
        let camera = Camera { look_from: eye, look_at: center, vup: DVec3::X, ..AT_BALL };
        for (material, expected) in [(lambertian(0.5), 0.5), (mirror(0.5), 0.5), (glass(1.5), 1.0)] {
            for renderer in [&mut widest(), &mut reference()] {
                let ball = (center, radius, material);
                let film = render(renderer, &job(&under_white_sky(&[ball]), camera, size(8, 8)), 0..4);
                assert_eq!(mean(&film), expected, "{radius} {height:e} {material:?}");
            }
        }
    }
}

/// A glass shell and a glass coat on a matte ball, beside the eye.
pub fn shells_at(at: DVec3, thickness: f64) -> (Scene, Camera) {
    let left = at + DVec3::new(-1.1, 0.0, 0.0);
    let right = at + DVec3::new(1.1, 0.0, 0.0);
    let balls = [
        (left, 1.0, glass(1.5)),
        (left, 1.0 - thickness, glass(1.0 / 1.5)),
        (right, 1.0, glass(1.5)),
        (right, 1.0 - thickness, lambertian(0.7)),
    ];
    let camera =
        Camera { look_from: at + DVec3::new(0.0, 0.3, 4.0), look_at: at, vfov_degrees: 40.0, ..Camera::BOOK };
    (scene(&balls), camera)
}

#[test]
fn thin_shells_far_from_origin() {
    for thickness in [1e-2, 1e-3, 1e-4] {
        for distance in [0.0, 1e2, 1e4, 1e5, 1e7] {
            let (scene, camera) = shells_at(DVec3::new(0.6, -0.3, 0.9) * distance, thickness);
            let job = job(&scene, camera, size(64, 36));
            let found = paired(&job, 8, &mut widest(), &mut reference());
            println!("{thickness:e} at {distance:e}: {found:?}");
            assert!(found.outliers < 2e-3, "{thickness:e} at {distance:e}: {found:?}");
            assert!(found.bias.abs() < 2e-5, "{thickness:e} at {distance:e}: {found:?}");
        }
    }
}

#[test]
fn moved_scene_looks_the_same() {
    let scene = three_spheres(LeftSphere::HollowGlass);
    let film = |by: DVec3| {
        let mut scene = scene.clone();
        scene.spheres.iter_mut().for_each(|sphere| sphere.center += by);
        let camera = Camera {
            look_from: Camera::BOOK.look_from + by,
            look_at: Camera::BOOK.look_at + by,
            ..Camera::BOOK
        };
        render(&mut widest(), &job(&scene, camera, size(64, 36)), 0..32)
    };
    let here = film(DVec3::ZERO);
    for distance in [1e3, 1e5, 1e7, 1e9] {
        let there = film(DVec3::new(0.7, -0.5, 0.3) * distance);
        let off = mean(&there) - mean(&here);
        println!("{distance:e}: {off:e}");
        assert!(off.abs() < 2e-5, "{distance:e}: {off:e}");
    }
}

#[test]
fn closed_ball_is_dark() {
    let inside = |at: DVec3| Camera { look_from: at, look_at: at + DVec3::new(0.3, -1.0, 0.2), ..AT_BALL };
    let settings = RenderSettings { max_depth: 2000, ..size(8, 8) };
    for at in [DVec3::ZERO, DVec3::new(1000.0, 0.0, -300.0)] {
        for sunk in [0.0, 1e-9, 1e-7, 1e-5, 1e-3] {
            for material in [lambertian(1.0), mirror(1.0), Material::Metal { albedo: DVec3::ONE, fuzz: 0.5 }]
            {
                let ground = (at - DVec3::Y * (1001.0 - sunk), 1000.0, lambertian(1.0));
                let beside = (at + DVec3::X * (1.5 - sunk), 0.5, mirror(1.0));
                let ball = (at, 1.0, material);
                let scene = under_white_sky(&[ground, ball, beside]);
                let eye = at + DVec3::new(0.2, 0.1, -0.3);
                assert_eq!(shown_mean(&job(&scene, inside(eye), settings), 16), 0.0, "{at} {sunk:e}");
                // The eye is near the wall.
                let eye = at + DVec3::Z * (1.0 - 1e-6);
                assert_eq!(shown_mean(&job(&scene, inside(eye), settings), 4), 0.0, "{at} {sunk:e}");
            }
        }
    }
}

/// Spheres much larger than what is on them are anchored there, in the scene's order, whichever gains most.
#[test]
fn large_spheres_are_anchored_at_details() {
    let grounds = [
        (DVec3::Y * -(1e4 + 10.0), 1e4, DVec3::new(0.01, 1.0, 0.0).normalize()),
        (DVec3::Y * (1e6 + 10.0), 1e6, DVec3::new(0.0, -1.0, 1e-4).normalize()),
    ];
    for order in [[0, 1], [1, 0]] {
        let large = order.map(|ground: usize| grounds[ground]);
        let with_detail = |(center, radius, towards): (DVec3, f64, DVec3)| {
            let detail = (center + towards * (radius + 0.05), 0.05, lambertian(0.5));
            [(center, radius, lambertian(0.5)), detail]
        };
        let balls: Vec<Ball> = large.into_iter().flat_map(with_detail).collect();
        let prepared = PreparedScene::<f32>::new(&job(&scene(&balls), AT_BALL, size(2, 2)));
        assert_eq!(prepared.scene_index, [1, 3, 0, 2], "anchored spheres come last");
        for (anchored, (_, _, towards)) in prepared.anchored.iter().zip(large) {
            let outward = -DVec3::from(anchored.inward.map(f64::from));
            assert!(outward.distance(towards) < 1e-6, "{outward} {towards}");
        }
    }
}
