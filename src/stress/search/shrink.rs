//! Makes a failing scene as small and simple as possible.

use crate::recipe::Recipe;
use crate::scene::{Camera, Material, Scene, Sky};
use crate::stress::families::build::moved;
use glam::DVec3;
use std::sync::Arc;

/// A change that makes a recipe simpler; `None` if there is nothing to change.
type Step = Box<dyn Fn(&Recipe) -> Option<Recipe>>;

/// Applies every change after which the scene still fails, until none is left.
pub fn shrink(recipe: Recipe, mut still_fails: impl FnMut(&Recipe) -> bool) -> Recipe {
    let mut smallest = recipe;
    loop {
        let mut has_shrunk = false;
        let mut index = 0;
        loop {
            let all = steps(&smallest);
            let Some(step) = all.get(index) else { break };
            match step(&smallest).filter(|smaller| *smaller != smallest && still_fails(smaller)) {
                // The same index again: once a sphere is dropped, the next one has its index.
                Some(smaller) => {
                    smallest = smaller;
                    has_shrunk = true;
                }
                None => index += 1,
            }
        }
        if !has_shrunk {
            return without_unused_materials(&smallest);
        }
    }
}

/// Possible changes, the largest first.
fn steps(recipe: &Recipe) -> Vec<Step> {
    let count = recipe.scene.spheres.len();
    let mut steps: Vec<Step> = Vec::new();
    for index in 0..count {
        steps.push(Box::new(move |recipe| {
            with_scene(recipe, |scene| {
                scene.spheres.remove(index);
            })
        }));
    }
    steps.push(Box::new(|recipe| {
        with_scene(recipe, |scene| scene.sky = Sky { bottom: DVec3::ONE, top: DVec3::ONE })
    }));
    steps.push(Box::new(|recipe| {
        let mut recipe = recipe.clone();
        recipe.settings.max_depth = (recipe.settings.max_depth / 2).max(1);
        Some(recipe)
    }));
    steps.push(Box::new(|recipe| with_camera(recipe, |camera| camera.defocus_angle_degrees = 0.0)));
    steps.push(Box::new(|recipe| Some(moved(recipe, 1.0, -recipe.camera.look_from))));
    for index in 0..count {
        steps.push(Box::new(move |recipe| with_scene(recipe, |scene| make_matte(scene, index))));
    }
    for digits in [1, 2, 3, 5] {
        for index in 0..count {
            steps.push(Box::new(move |recipe| {
                with_scene(recipe, |scene| {
                    scene.spheres[index].center = scene.spheres[index].center.map(|x| rounded(x, digits));
                })
            }));
            steps.push(Box::new(move |recipe| {
                with_scene(recipe, |scene| {
                    scene.spheres[index].radius = rounded(scene.spheres[index].radius, digits);
                })
            }));
        }
        steps.push(Box::new(move |recipe| {
            with_camera(recipe, |camera| camera.look_from = camera.look_from.map(|x| rounded(x, digits)))
        }));
        steps.push(Box::new(move |recipe| {
            with_camera(recipe, |camera| camera.look_at = camera.look_at.map(|x| rounded(x, digits)))
        }));
        steps.push(Box::new(move |recipe| {
            with_camera(recipe, |camera| camera.vfov_degrees = rounded(camera.vfov_degrees, digits))
        }));
    }
    steps
}

fn with_scene(recipe: &Recipe, change: impl FnOnce(&mut Scene)) -> Option<Recipe> {
    let mut scene = Scene::clone(&recipe.scene);
    change(&mut scene);
    Some(Recipe { scene: Arc::new(scene), ..recipe.clone() })
}

fn with_camera(recipe: &Recipe, change: impl FnOnce(&mut Camera)) -> Option<Recipe> {
    let mut recipe = recipe.clone();
    change(&mut recipe.camera);
    Some(recipe)
}

fn make_matte(scene: &mut Scene, index: usize) {
    let matte = Material::Lambertian { albedo: DVec3::splat(0.5) };
    let known = scene.materials.iter().position(|named| named.material == matte);
    let material = known.unwrap_or_else(|| {
        let name = format!("matte{}", scene.materials.len());
        scene.add_material(name, matte)
    });
    scene.spheres[index].material = material;
}

fn without_unused_materials(recipe: &Recipe) -> Recipe {
    let mut scene = Scene { sky: recipe.scene.sky, ..Scene::default() };
    let mut places = vec![None; recipe.scene.materials.len()];
    for sphere in &recipe.scene.spheres {
        let named = &recipe.scene.materials[sphere.material];
        let place = *places[sphere.material]
            .get_or_insert_with(|| scene.add_material(named.name.clone(), named.material));
        scene.add_sphere(sphere.center, sphere.radius, place);
    }
    Recipe { scene: Arc::new(scene), ..recipe.clone() }
}

/// `x` rounded to this many significant digits.
fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits - 1).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::search::random;

    #[test]
    fn numbers_lose_digits() {
        assert_eq!(rounded(-0.0123456, 2), -0.012);
        assert_eq!(rounded(98765.0, 1), 1e5);
        assert_eq!(rounded(0.0, 3), 0.0);
    }

    #[test]
    fn spheres_that_become_matte_share_a_material() {
        let mut scene = Scene::default();
        let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        for x in [0.0, 3.0] {
            scene.add_sphere(DVec3::new(x, 0.0, 0.0), 1.0, glass);
        }
        make_matte(&mut scene, 0);
        make_matte(&mut scene, 1);
        let matte = Material::Lambertian { albedo: DVec3::splat(0.5) };
        assert!(scene.spheres.iter().all(|sphere| *scene.material_of(sphere) == matte));
        assert_eq!(scene.materials.len(), 2);
    }

    #[test]
    fn what_does_not_matter_goes_away() {
        // "Fails" as long as there is a glass sphere with a radius above a thousandth.
        let is_glass = |scene: &Scene| {
            scene.spheres.iter().any(|sphere| {
                matches!(scene.material_of(sphere), Material::Dielectric { .. }) && sphere.radius > 1e-3
            })
        };
        let recipe = (0..)
            .map(|number| random::scene(5, number))
            .find(|recipe| recipe.scene.spheres.len() > 6 && is_glass(&recipe.scene));
        let mut calls = 0;
        let small = shrink(recipe.unwrap(), |smaller| {
            calls += 1;
            smaller.job().is_ok() && is_glass(&smaller.scene)
        });
        assert!(is_glass(&small.scene) && calls < 2000);
        assert_eq!((small.scene.spheres.len(), small.scene.materials.len()), (1, 1));
        assert_eq!(small.settings.max_depth, 1);
        let sphere = small.scene.spheres[0];
        assert_eq!(sphere.radius, rounded(sphere.radius, 1));
        small.job().unwrap();
    }

    #[test]
    fn a_scene_that_no_longer_fails_is_left_as_it_is() {
        let recipe = random::scene(5, 3);
        let small = shrink(recipe.clone(), |_| false);
        assert_eq!(small.scene.spheres.len(), recipe.scene.spheres.len());
        assert_eq!(small.camera, recipe.camera);
    }

    #[test]
    fn numbers_become_as_short_as_the_failure_allows() {
        let mut scene = Scene { sky: Sky { bottom: DVec3::ZERO, top: DVec3::X }, ..Scene::default() };
        scene.add_material("of no use", Material::Lambertian { albedo: DVec3::ONE });
        let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        scene.add_sphere(DVec3::new(1.234, 5.678, -9.1011), 1.2345, glass);
        scene.add_sphere(DVec3::new(3.0, 4.0, 5.0), 1.0, glass);
        let camera = Camera {
            look_from: DVec3::new(0.5, 0.25, 0.125),
            look_at: DVec3::new(7.77, 8.88, 9.99),
            vfov_degrees: 33.3,
            defocus_angle_degrees: 2.0,
            ..Camera::BOOK
        };
        let recipe = crate::stress::families::build::of_scene(scene, camera);
        let is_large_glass = |recipe: &Recipe| {
            recipe
                .scene
                .spheres
                .iter()
                .any(|sphere| recipe.scene.material_of(sphere).is_transparent() && sphere.radius > 1.1)
        };
        let small = shrink(recipe.clone(), is_large_glass);
        let mut scene = Scene { sky: Sky { bottom: DVec3::ONE, top: DVec3::ONE }, ..Scene::default() };
        let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        scene.add_sphere(DVec3::new(0.7, 5.0, -9.0), 1.2, glass);
        let camera = Camera {
            look_from: DVec3::ZERO,
            look_at: DVec3::new(7.0, 9.0, 10.0),
            vfov_degrees: 30.0,
            ..Camera::BOOK
        };
        assert_eq!((&*small.scene, small.camera, small.settings.max_depth), (&scene, camera, 1));
    }

    #[test]
    fn the_largest_steps_come_first() {
        let recipe = random::scene(5, 3);
        let count = recipe.scene.spheres.len();
        let all = steps(&recipe);
        // Each sphere dropped; sky, depth, lens and place; each made matte; four times all numbers with fewer digits.
        assert_eq!(all.len(), 2 * count + 4 + 4 * (2 * count + 3));
        for (index, step) in all[..count].iter().enumerate() {
            let mut expected = recipe.scene.spheres.clone();
            expected.remove(index);
            assert_eq!(step(&recipe).unwrap().scene.spheres, expected);
        }
        let depth = |max_depth: u32| {
            let mut recipe = recipe.clone();
            recipe.settings.max_depth = max_depth;
            all[count + 1](&recipe).unwrap().settings.max_depth
        };
        assert_eq!([1, 2, 3, 50].map(depth), [1, 1, 1, 25]);
    }
}
