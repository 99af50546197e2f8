//! Scenes that are hard for a denoiser and for the estimate of its error, and scenes drawn at random.

#![allow(dead_code, clippy::unwrap_used, reason = "each user needs some of them")]

use glam::DVec3;
use std::sync::Arc;
use weekender::Recipe;
use weekender::scene::{Camera, Material, Scene, Sky};

/// Numbers in `[0, 1)`.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }
}

fn recipe(name: &str, scene: Scene, camera: Camera, [width, height]: [u32; 2]) -> Recipe {
    let mut recipe = Recipe::find("three-spheres").unwrap();
    (recipe.settings.width, recipe.settings.height) = (width, height);
    Recipe { name: name.to_owned(), scene: Arc::new(scene), camera, ..recipe }
}

fn grey(albedo: f64) -> Material {
    Material::Lambertian { albedo: DVec3::splat(albedo) }
}

/// Balls of about a pixel, black, white, coloured and mirrored: texture without any similar neighbours.
pub fn dots() -> Recipe {
    let mut scene =
        Scene { sky: Sky { bottom: DVec3::ONE, top: DVec3::new(0.5, 0.7, 1.0) }, ..Scene::default() };
    let ground = scene.add_material("ground", grey(0.5));
    scene.add_sphere(DVec3::new(0.0, -1000.0, 0.0), 1000.0, ground);
    let mut looks = vec![
        scene.add_material("black", grey(0.02)),
        scene.add_material("white", grey(0.95)),
        scene.add_material("mirror", Material::Metal { albedo: DVec3::splat(0.95), fuzz: 0.0 }),
    ];
    for bits in 1..7 {
        let albedo = DVec3::from([0, 1, 2].map(|bit| if bits >> bit & 1 == 1 { 0.95 } else { 0.02 }));
        looks.push(scene.add_material(format!("colour {bits}"), Material::Lambertian { albedo }));
    }
    let mut random = Random::new(5);
    for (row, column) in (0..60).flat_map(|row| (0..100).map(move |column| (row, column))) {
        let x = 0.09 * (f64::from(column) - 49.5) + random.between(-0.02, 0.02);
        let z = 0.12 * (f64::from(row) - 29.5) + random.between(-0.02, 0.02);
        let look = match (4.0 * random.next()) as usize {
            3 => looks[3 + (6.0 * random.next()) as usize],
            plain => looks[plain],
        };
        scene.add_sphere(DVec3::new(x, 0.024 - (x * x + z * z) / 2000.0, z), 0.024, look);
    }
    let camera = Camera {
        look_from: DVec3::new(0.0, 5.0, 6.0),
        look_at: DVec3::ZERO,
        vfov_degrees: 40.0,
        ..Camera::default()
    };
    recipe("dots", scene, camera, [200, 112])
}

/// The three spheres under a sky that is darker by this factor.
pub fn dimmed(factor: f64) -> Recipe {
    let mut recipe = Recipe::find("three-spheres").unwrap();
    let mut scene = Scene::clone(&recipe.scene);
    (scene.sky.bottom, scene.sky.top) = (scene.sky.bottom * factor, scene.sky.top * factor);
    (recipe.settings.width, recipe.settings.height) = (200, 112);
    Recipe { name: format!("dimmed to {factor:e}"), scene: Arc::new(scene), ..recipe }
}

/// A white shaft that a ball of this radius closes except for its corners, with the eye at the bottom: few paths find
/// light, which is strong.
pub fn cage(ball: f64) -> Recipe {
    let mut scene =
        Scene { sky: Sky { bottom: DVec3::splat(50.0), top: DVec3::splat(50.0) }, ..Scene::default() };
    let white = scene.add_material("white", grey(0.98));
    for wall in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z, DVec3::NEG_Y] {
        scene.add_sphere(wall * 101.0, 100.0, white);
    }
    scene.add_sphere(DVec3::new(0.0, 1.6, 0.0), ball, white);
    let camera = Camera {
        look_from: DVec3::new(0.0, -0.5, 0.8),
        look_at: DVec3::new(0.0, -0.6, 0.0),
        ..Camera::default()
    };
    recipe("cage", scene, camera, [48, 27])
}

/// A scene drawn at random: up to 200 spheres of all materials and sizes on a ground, a sky of any brightness, a camera
/// with or without a lens.
pub fn random(seed: u64) -> Recipe {
    let mut random = Random::new(seed + 1);
    for _ in 0..8 {
        random.next();
    }
    let brightness = 10_f64.powf(random.between(-3.0, 1.5));
    let colour = |random: &mut Random| DVec3::new(random.next(), random.next(), random.next());
    let sky = Sky { bottom: brightness * colour(&mut random), top: brightness * colour(&mut random) };
    let mut scene = Scene { sky, ..Scene::default() };
    let ground = scene.add_material("ground", Material::Lambertian { albedo: colour(&mut random) });
    scene.add_sphere(DVec3::new(0.0, -1000.0, 0.0), 1000.0, ground);
    let size = 10_f64.powf(random.between(-1.3, 0.0));
    for index in 0..(200.0_f64).powf(random.next()) as usize {
        let albedo = colour(&mut random);
        let material = match (4.0 * random.next()) as usize {
            0 => Material::Dielectric { refraction_index: random.between(1.1, 2.0) },
            1 => Material::Metal { albedo, fuzz: random.between(-0.5, 1.0).max(0.0) },
            _ => Material::Lambertian { albedo },
        };
        let material = scene.add_material(format!("material {index}"), material);
        let radius = size * random.between(0.3, 1.0);
        let at = DVec3::new(random.between(-4.0, 4.0), radius, random.between(-4.0, 4.0));
        scene.add_sphere(at, radius, material);
    }
    let camera = Camera {
        look_from: DVec3::new(random.between(-3.0, 3.0), random.between(0.5, 5.0), random.between(5.0, 9.0)),
        look_at: DVec3::new(0.0, 0.3, 0.0),
        vfov_degrees: random.between(15.0, 60.0),
        defocus_angle_degrees: random.between(-3.0, 3.0).max(0.0),
        ..Camera::default()
    };
    recipe(&format!("random {seed}"), scene, camera, [200, 112])
}
