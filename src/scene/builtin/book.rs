//! The book's final render. (Section 14.1.)

use super::random::{Draws, to_four_decimals};
use crate::scene::{Camera, Material, Scene};
use glam::DVec3;

/// This seed leaves out three of the 22 x 22 small spheres where the metal sphere stands. That gives 485 spheres, as
/// many as the book's own generator.
const SEED: u64 = 1;

pub const BOOK_CAMERA: Camera = Camera {
    look_from: DVec3::new(13.0, 2.0, 3.0),
    look_at: DVec3::ZERO,
    vup: DVec3::Y,
    vfov_degrees: 20.0,
    defocus_angle_degrees: 0.6,
    focus_distance: Some(10.0),
};

/// The scene on the book's cover: 485 spheres, always the same.
pub fn book() -> Scene {
    book_of(SEED)
}

/// The book's final scene with small spheres of this seed.
pub fn book_of(seed: u64) -> Scene {
    let mut scene = Scene::default();
    let ground = scene.add_material("ground", Material::Lambertian { albedo: DVec3::splat(0.5) });
    let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
    let brown = scene.add_material("brown", Material::Lambertian { albedo: DVec3::new(0.4, 0.2, 0.1) });
    let gold = scene.add_material("gold", Material::Metal { albedo: DVec3::new(0.7, 0.6, 0.5), fuzz: 0.0 });

    scene.add_sphere(DVec3::new(0.0, -1000.0, 0.0), 1000.0, ground);
    scene.add_sphere(DVec3::new(0.0, 1.0, 0.0), 1.0, glass);
    scene.add_sphere(DVec3::new(-4.0, 1.0, 0.0), 1.0, brown);
    scene.add_sphere(DVec3::new(4.0, 1.0, 0.0), 1.0, gold);

    for cell in 0..22 * 22_u32 {
        let mut draws = Draws::new(seed, u64::from(cell));
        let corner = DVec3::new(f64::from(cell / 22) - 11.0, 0.2, f64::from(cell % 22) - 11.0);
        let choice = draws.unit();
        let offset = DVec3::new(0.9 * draws.unit(), 0.0, 0.9 * draws.unit());
        let center = (corner + offset).map(to_four_decimals);
        if center.distance(DVec3::new(4.0, 0.2, 0.0)) <= 0.9 {
            continue;
        }
        let material = if choice < 0.8 {
            let mut channel = || to_four_decimals(draws.unit() * draws.unit());
            let albedo = DVec3::new(channel(), channel(), channel());
            scene.add_material(format!("matte-{cell}"), Material::Lambertian { albedo })
        } else if choice < 0.95 {
            let mut channel = || to_four_decimals(draws.within(0.5, 1.0));
            let albedo = DVec3::new(channel(), channel(), channel());
            let fuzz = to_four_decimals(draws.within(0.0, 0.5));
            scene.add_material(format!("metal-{cell}"), Material::Metal { albedo, fuzz })
        } else {
            glass
        };
        scene.add_sphere(center, 0.2, material);
    }
    scene
}
