//! Building blocks for the families' scenes.

pub use crate::measure::table::{counted, grouped};

use crate::job::recipe::Recipe;
use crate::job::render::RenderSettings;
use crate::scene::{Camera, Material, Scene, Sky};
use crate::stages::Rules;
use glam::DVec3;
use std::sync::Arc;

/// Size of most pictures, pixels.
const SIZE: [u32; 2] = [24, 16];

/// Samples per pixel of most pictures.
const SAMPLES: u64 = 32;

/// A sky of 1 everywhere: a path returns the product of the reflectances along it.
pub const WHITE_SKY: Sky = Sky { bottom: DVec3::ONE, top: DVec3::ONE };

/// Centre, radius and material.
pub type Ball = (DVec3, f64, Material);

pub fn matte(albedo: f64) -> Material {
    Material::Lambertian { albedo: DVec3::splat(albedo) }
}

pub fn metal(albedo: f64, fuzz: f64) -> Material {
    Material::Metal { albedo: DVec3::splat(albedo), fuzz }
}

pub fn glass(refraction_index: f64) -> Material {
    Material::Dielectric { refraction_index }
}

/// Balls with equal materials share one.
pub fn scene(balls: impl IntoIterator<Item = Ball>, sky: Sky) -> Scene {
    let mut scene = Scene { sky, ..Scene::default() };
    for (center, radius, material) in balls {
        let known = scene.materials.iter().position(|named| named.material == material);
        let index = known.unwrap_or_else(|| {
            let name = format!("{} {}", material.kind(), scene.materials.len() + 1);
            scene.add_material(name, material)
        });
        scene.add_sphere(center, radius, index);
    }
    scene
}

pub fn eye(look_from: DVec3, look_at: DVec3, vfov_degrees: f64) -> Camera {
    let view = look_at - look_from;
    let vup = if view.x == 0.0 && view.z == 0.0 { DVec3::X } else { DVec3::Y };
    Camera { look_from, look_at, vup, vfov_degrees, ..Camera::BOOK }
}

/// A small picture under a white sky, with paths of up to 50 rays.
pub fn picture(balls: impl IntoIterator<Item = Ball>, camera: Camera) -> Recipe {
    of_scene(scene(balls, WHITE_SKY), camera)
}

/// A small picture, with paths of up to 50 rays.
pub fn of_scene(scene: Scene, camera: Camera) -> Recipe {
    let [width, height] = SIZE;
    Recipe {
        name: "stress".to_owned(),
        scene: Arc::new(scene),
        camera,
        settings: RenderSettings { width, height, max_depth: 50, ..RenderSettings::default() },
        keyframes: Vec::new(),
        rules: Rules::FINISHED,
        samples_per_pixel: SAMPLES,
    }
}

pub fn deep(mut recipe: Recipe, max_depth: u32) -> Recipe {
    recipe.settings.max_depth = max_depth;
    recipe
}

pub fn sized(mut recipe: Recipe, [width, height]: [u32; 2], samples: u64) -> Recipe {
    (recipe.settings.width, recipe.settings.height) = (width, height);
    Recipe { samples_per_pixel: samples, ..recipe }
}

/// The recipe with another name for the tables.
pub fn named(recipe: Recipe, name: &str) -> Recipe {
    Recipe { name: name.to_owned(), ..recipe }
}

/// Everything scaled by `factor`, then moved by `offset`: spheres, eye and focus.
pub fn moved(recipe: &Recipe, factor: f64, offset: DVec3) -> Recipe {
    let place = |point: DVec3| factor * point + offset;
    let mut scene = Scene::clone(&recipe.scene);
    for sphere in &mut scene.spheres {
        sphere.center = place(sphere.center);
        sphere.radius *= factor;
    }
    let camera = Camera {
        look_from: place(recipe.camera.look_from),
        look_at: place(recipe.camera.look_at),
        focus_distance: recipe.camera.focus_distance.map(|distance| factor * distance),
        ..recipe.camera
    };
    Recipe { scene: Arc::new(scene), camera, ..recipe.clone() }
}

/// Three balls, one of each material, on a ground two hundred times as large, under the book's sky.
pub fn tame() -> Recipe {
    let balls = [
        (DVec3::new(0.0, -100.5, -1.0), 100.0, matte(0.5)),
        (DVec3::new(0.0, 0.0, -1.2), 0.5, matte(0.7)),
        (DVec3::new(-1.0, 0.0, -1.0), 0.5, glass(1.5)),
        (DVec3::new(1.0, 0.0, -1.0), 0.5, metal(0.8, 0.1)),
    ];
    let camera = eye(DVec3::new(0.0, 0.3, 1.5), DVec3::new(0.0, 0.0, -1.0), 50.0);
    named(of_scene(scene(balls, Sky::default()), camera), "tame")
}

/// A convex matte ball that fills the view.
pub fn one_ball() -> Recipe {
    named(picture([(DVec3::ZERO, 1.0, matte(0.5))], in_front()), "one-ball")
}

/// A camera that sees only the unit ball at the origin.
pub fn in_front() -> Camera {
    eye(DVec3::new(0.0, 0.0, 3.0), DVec3::ZERO, 20.0)
}

/// A camera that sees only a unit ball at `center`.
pub fn around(center: DVec3) -> Camera {
    let camera = in_front();
    Camera { look_from: camera.look_from + center, look_at: camera.look_at + center, ..camera }
}
