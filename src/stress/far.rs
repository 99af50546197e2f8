//! Forty distant spheres, which switch the hierarchy on and are too small to be seen.

use crate::recipe::Recipe;
use crate::scene::{Material, Scene};
use glam::DVec3;
use std::sync::Arc;

/// Number of distant spheres.
const COUNT: usize = 40;

/// Their distance from the eye, in units of the scene.
const DISTANCE: f64 = 1000.0;

/// Their radius, in units of the scene: together they cover a billionth of the sky.
const RADIUS: f64 = 0.01;

/// The scene with the distant spheres. They reflect all light, so a closed room stays dark and a white world white.
pub fn with_far_spheres(recipe: &Recipe, unit: f64) -> Recipe {
    let mut scene = Scene::clone(&recipe.scene);
    // No scene that is rendered here has a material of this name.
    let material = scene.add_material("far".to_owned(), Material::Lambertian { albedo: DVec3::ONE });
    for index in 0..COUNT {
        let center = recipe.camera.look_from + DISTANCE * unit * direction(index);
        scene.add_sphere(center, RADIUS * unit, material);
    }
    Recipe { scene: Arc::new(scene), ..recipe.clone() }
}

/// Evenly distributed directions, by the golden angle.
fn direction(index: usize) -> DVec3 {
    let height = 1.0 - (2 * index + 1) as f64 / COUNT as f64;
    let turn = index as f64 * 2.399_963_229_728_653;
    let across = (1.0 - height * height).sqrt();
    DVec3::new(across * turn.cos(), height, across * turn.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_surround_the_eye_and_cover_nothing() {
        let recipe = Recipe::builtin("two-spheres").unwrap();
        let with = with_far_spheres(&recipe, 2.0);
        with.job().unwrap();
        let added = &with.scene.spheres[recipe.scene.spheres.len()..];
        assert_eq!(added.len(), COUNT);
        let eye = recipe.camera.look_from;
        let mean = added.iter().map(|s| s.center - eye).sum::<DVec3>() / COUNT as f64;
        assert!(mean.length() < 0.05 * DISTANCE * 2.0, "{mean}");
        let share: f64 = added.iter().map(|s| (s.radius / s.center.distance(eye)).powi(2) / 4.0).sum();
        assert!(share < 2e-9, "{share}");
    }
}
