//! Builds a scene in code, renders it, and writes it as a scene file that the program can open.
//!
//! ```sh
//! cargo run --release --example own_scene -- OUTPUT-DIRECTORY
//! weekender --scene OUTPUT-DIRECTORY/spiral.toml
//! ```

use anyhow::Result;
use glam::DVec3;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use weekender::{
    Camera, CpuOptions, CpuRenderer, Material, Recipe, RenderSettings, Renderer, Rules, Scene, Sky, Status,
    describe, scene_file, write_image, write_text,
};

/// Number of balls in the spiral.
const BALLS: usize = 48;

fn main() -> Result<()> {
    let directory = std::env::args().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    render(&spiral(), &directory)
}

/// A ball of glass with a spiral of metal balls around it.
pub fn spiral() -> Recipe {
    let mut scene = Scene {
        sky: Sky { bottom: DVec3::new(1.0, 0.9, 0.8), top: DVec3::new(0.4, 0.6, 1.0) },
        ..Scene::default()
    };
    // Spheres refer to materials by the number that `add_material` returns; names appear in scene files.
    let ground = scene.add_material("ground", Material::Lambertian { albedo: DVec3::new(0.3, 0.35, 0.4) });
    let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
    scene.add_sphere(DVec3::new(0.0, -1000.0, 0.0), 1000.0, ground);
    scene.add_sphere(DVec3::new(0.0, 1.0, 0.0), 1.0, glass);
    for ball in 0..BALLS {
        let share = ball as f64 / BALLS as f64;
        let (angle, distance, radius) = (3.0 * TAU * share, 1.3 + 2.0 * share, 0.08 + 0.12 * share);
        let albedo = DVec3::new(0.9, 0.5 + 0.4 * share, 0.9 - 0.6 * share);
        let metal =
            scene.add_material(format!("metal-{ball}"), Material::Metal { albedo, fuzz: 0.3 * share });
        let center = DVec3::new(distance * angle.cos(), radius, distance * angle.sin());
        scene.add_sphere(center, radius, metal);
    }
    Recipe {
        name: "spiral".to_owned(),
        scene: Arc::new(scene),
        camera: Camera {
            look_from: DVec3::new(0.0, 3.0, 8.0),
            look_at: DVec3::new(0.0, 0.5, 0.0),
            vfov_degrees: 32.0,
            defocus_angle_degrees: 0.5,
            ..Camera::default()
        },
        settings: RenderSettings { width: 400, height: 225, ..RenderSettings::default() },
        keyframes: Vec::new(),
        rules: Rules::FINISHED,
        samples_per_pixel: 64,
    }
}

/// Renders `recipe` and writes `NAME.png` and the scene file `NAME.toml` to `directory`.
pub fn render(recipe: &Recipe, directory: &Path) -> Result<()> {
    // The first number out of its range is an error here; the message says what is allowed.
    let job = recipe.job()?;
    let mut film = job.new_film();
    let never = AtomicBool::new(false);
    let mut renderer = CpuRenderer::new(CpuOptions::default())?;
    renderer.prepare(&job, &never)?;
    renderer.accumulate(&job, 0..recipe.samples_per_pixel, &mut film, &never)?;

    let description = describe(recipe, None, &film, &Status::default(), None);
    let [picture, scene] = ["png", "toml"].map(|ending| directory.join(format!("{}.{ending}", recipe.name)));
    write_image(&picture, &film, recipe.rules.transfer, &description)?;
    write_text(&scene, &scene_file::to_toml(recipe))?;
    println!("wrote {} and {}", picture.display(), scene.display());
    Ok(())
}
