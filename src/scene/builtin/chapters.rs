//! The small scenes of the book's chapters.

use crate::scene::{Camera, Material, Scene};
use glam::DVec3;
use std::f64::consts::FRAC_1_SQRT_2;

/// Radius of the ground in the small scenes; its top is at `y = -0.5`.
const GROUND_RADIUS: f64 = 100.0;

const GREY: DVec3 = DVec3::splat(0.5);

/// A scene with only the sky. (Section 4.2.)
pub fn empty() -> Scene {
    Scene::default()
}

/// A ball of radius 0.5 at `(0, 0, -1)`. (Section 5.2.)
pub fn one_sphere() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.add_material("grey", Material::Lambertian { albedo: GREY });
    scene.add_sphere(DVec3::new(0.0, 0.0, -1.0), 0.5, grey);
    scene
}

/// [`one_sphere`] on a ground of the same grey. (Sections 6.5 to 9.5.)
pub fn matte_on_ground() -> Scene {
    let mut scene = one_sphere();
    scene.add_sphere(DVec3::new(0.0, -GROUND_RADIUS - 0.5, -1.0), GROUND_RADIUS, 0);
    scene
}

/// The left sphere of [`three_spheres`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LeftSphere {
    /// Solid glass with this refraction index relative to its surroundings.
    Glass(f64),
    /// A glass shell of index 1.5 around a ball of air of radius 0.4. (Section 11.5.)
    HollowGlass,
}

/// Glass on the left, a blue matte ball in the middle and metal of fuzz 1 on the right, on yellow ground. (Section 11.)
pub fn three_spheres(left: LeftSphere) -> Scene {
    let mut scene = ground_and_centre();
    let left_centre = DVec3::new(-1.0, 0.0, -1.0);
    let outer_index = match left {
        LeftSphere::Glass(index) => index,
        LeftSphere::HollowGlass => 1.5,
    };
    let glass = scene.add_material("left", Material::Dielectric { refraction_index: outer_index });
    scene.add_sphere(left_centre, 0.5, glass);
    if left == LeftSphere::HollowGlass {
        let bubble = scene.add_material("bubble", Material::Dielectric { refraction_index: 1.0 / 1.5 });
        scene.add_sphere(left_centre, 0.4, bubble);
    }
    add_right_metal(&mut scene, 1.0);
    scene
}

/// A silver ball on the left and a golden ball on the right with these fuzz values, and a blue matte ball between them.
/// (Sections 10.5 and 10.6.)
pub fn metals(left_fuzz: f64, right_fuzz: f64) -> Scene {
    let mut scene = ground_and_centre();
    let silver = scene.add_material("left", Material::Metal { albedo: DVec3::splat(0.8), fuzz: left_fuzz });
    scene.add_sphere(DVec3::new(-1.0, 0.0, -1.0), 0.5, silver);
    add_right_metal(&mut scene, right_fuzz);
    scene
}

fn ground_and_centre() -> Scene {
    let mut scene = Scene::default();
    let yellow = scene.add_material("ground", Material::Lambertian { albedo: DVec3::new(0.8, 0.8, 0.0) });
    let blue = scene.add_material("center", Material::Lambertian { albedo: DVec3::new(0.1, 0.2, 0.5) });
    scene.add_sphere(DVec3::new(0.0, -GROUND_RADIUS - 0.5, -1.0), GROUND_RADIUS, yellow);
    scene.add_sphere(DVec3::new(0.0, 0.0, -1.2), 0.5, blue);
    scene
}

fn add_right_metal(scene: &mut Scene, fuzz: f64) {
    let gold = scene.add_material("right", Material::Metal { albedo: DVec3::new(0.8, 0.6, 0.2), fuzz });
    scene.add_sphere(DVec3::new(1.0, 0.0, -1.0), 0.5, gold);
}

/// A blue and a red ball that touch in the middle and reach the edges of a 90 degree view. (Section 12.1.)
pub fn touching_spheres() -> Scene {
    let radius = FRAC_1_SQRT_2;
    let mut scene = Scene::default();
    let blue = scene.add_material("left", Material::Lambertian { albedo: DVec3::Z });
    let red = scene.add_material("right", Material::Lambertian { albedo: DVec3::X });
    scene.add_sphere(DVec3::new(-radius, 0.0, -1.0), radius, blue);
    scene.add_sphere(DVec3::new(radius, 0.0, -1.0), radius, red);
    scene
}

/// The three spheres from above and from the left. (Section 12.2.)
pub const SIDE_VIEW: Camera = Camera { look_from: DVec3::new(-2.0, 2.0, 1.0), ..Camera::BOOK };

/// The same scene up close, through a wide lens. (Section 13.2.)
pub const WIDE_LENS: Camera =
    Camera { vfov_degrees: 20.0, defocus_angle_degrees: 10.0, focus_distance: Some(3.4), ..SIDE_VIEW };
