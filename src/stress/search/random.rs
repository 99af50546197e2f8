//! Random scenes that combine all difficulties: scales from 1e-6 to 1e6, copies, shells, contacts, glass of any index,
//! and eyes inside or on spheres.

use crate::recipe::Recipe;
use crate::sampling::pcg4d;
use crate::scene::{Camera, Material, Scene, Sky, Sphere};
use crate::stress::families::build::{moved, of_scene, sized};
use glam::DVec3;

/// A stream of random numbers.
struct Draws {
    key: [u32; 2],
    count: u32,
}

impl Draws {
    /// Uniform in `0..1`.
    fn unit(&mut self) -> f64 {
        let [word, ..] = pcg4d([self.key[0], self.key[1], self.count, 0x5712_e550]);
        self.count += 1;
        f64::from(word) / 4_294_967_296.0
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the logarithm.
    fn log(&mut self, low: f64, high: f64) -> f64 {
        (self.within(low.ln(), high.ln())).exp()
    }

    fn below(&mut self, count: u32) -> u32 {
        (self.unit() * f64::from(count)) as u32
    }

    fn happens(&mut self, chance: f64) -> bool {
        self.unit() < chance
    }

    fn direction(&mut self) -> DVec3 {
        let height = self.within(-1.0, 1.0);
        let turn = self.within(0.0, std::f64::consts::TAU);
        let across = (1.0 - height * height).sqrt();
        DVec3::new(across * turn.cos(), height, across * turn.sin())
    }
}

/// Scene `number` of a seed. The same numbers always give the same scene.
pub fn scene(seed: u32, number: u32) -> Recipe {
    let draws = &mut Draws { key: [seed, number], count: 0 };
    let mut scene = Scene { sky: sky(draws), ..Scene::default() };
    let count = draws.log(1.0, 14.0) as u32 + 1;
    for index in 0..count {
        let material = scene.add_material(format!("m{index}"), material(draws));
        let sphere = sphere(draws, &scene.spheres, material);
        scene.spheres.push(sphere);
    }
    if draws.happens(0.3) {
        let material = scene.add_material("ground", Material::Lambertian { albedo: DVec3::splat(0.5) });
        let radius = draws.log(1e2, 1e7);
        let lowest = scene.spheres.iter().map(|s| s.center.y - s.radius).fold(f64::INFINITY, f64::min);
        scene.add_sphere(DVec3::new(0.0, lowest - radius, 0.0), radius, material);
    }
    let camera = camera(draws, &scene);
    let mut recipe = of_scene(scene, camera);
    recipe.settings.max_depth = draws.log(2.0, 200.0) as u32;
    recipe.settings.seed = number;
    let factor = if draws.happens(0.5) { 1.0 } else { draws.log(1e-6, 1e6) };
    let offset =
        if draws.happens(0.5) { DVec3::ZERO } else { factor * draws.log(1.0, 1e5) * draws.direction() };
    let name = format!("{seed}-{number}");
    Recipe { name, ..sized(moved(&recipe, factor, offset), [16, 12], 16) }
}

fn sky(draws: &mut Draws) -> Sky {
    match draws.below(3) {
        0 => Sky::default(),
        1 => Sky { bottom: DVec3::ONE, top: DVec3::ONE },
        _ => Sky { bottom: DVec3::ZERO, top: DVec3::new(0.5, 1.0, 2.0) },
    }
}

fn material(draws: &mut Draws) -> Material {
    let mut grey = || DVec3::splat([1.0, 0.5, 0.9, 0.2][draws.below(4) as usize]);
    let albedo = grey();
    match draws.below(6) {
        0..=2 => Material::Lambertian { albedo },
        3 => Material::Metal { albedo, fuzz: if draws.happens(0.5) { 0.0 } else { draws.unit() } },
        _ => {
            let refraction_index = match draws.below(4) {
                0 => 1.5,
                1 => 1.0 / 1.5,
                2 => 1.0 + draws.log(1e-6, 1.0),
                _ => draws.log(1e-2, 1e2),
            };
            Material::Dielectric { refraction_index }
        }
    }
}

/// An independent sphere, or one in a stiff relation to an existing one.
fn sphere(draws: &mut Draws, others: &[Sphere], material: usize) -> Sphere {
    let free = |draws: &mut Draws| {
        let radius = draws.log(1e-3, 10.0);
        Sphere { center: draws.log(1e-2, 10.0) * draws.direction(), radius, material }
    };
    let Some(last) = others.len().checked_sub(1) else { return free(draws) };
    let other = others[(draws.below(others.len() as u32) as usize).min(last)];
    match draws.below(8) {
        // A copy, with the same material.
        0 => other,
        // Almost a copy.
        1 => Sphere {
            center: other.center + other.radius * draws.log(1e-9, 1e-2) * draws.direction(),
            ..other
        },
        // A shell or a coat.
        2 | 3 => Sphere { radius: other.radius * (1.0 - draws.log(1e-5, 0.5)), material, ..other },
        // In contact from outside.
        4 => {
            let radius = other.radius * draws.log(1e-3, 1e3);
            Sphere { center: other.center + (other.radius + radius) * draws.direction(), radius, material }
        }
        // In contact from inside.
        5 => {
            let radius = other.radius * draws.within(0.1, 0.9);
            Sphere { center: other.center + (other.radius - radius) * draws.direction(), radius, material }
        }
        _ => free(draws),
    }
}

fn camera(draws: &mut Draws, scene: &Scene) -> Camera {
    let count = scene.spheres.len() as u32;
    let chosen = scene.spheres[(draws.below(count) as usize).min(count as usize - 1)];
    let away = draws.direction();
    let look_from = match draws.below(4) {
        // Inside; on the surface or close to it; anywhere outside.
        0 => chosen.center + chosen.radius * draws.within(0.0, 0.99) * away,
        1 => chosen.center + chosen.radius * (1.0 + draws.log(1e-6, 1e-1)) * away,
        _ => chosen.center + chosen.radius * draws.log(1.1, 30.0) * away,
    };
    let aimed = scene.spheres[(draws.below(count) as usize).min(count as usize - 1)];
    let look_at = aimed.center + 0.3 * aimed.radius * draws.direction();
    let distance = look_from.distance(look_at);
    let has_lens = draws.happens(0.2);
    Camera {
        look_from,
        look_at: if distance > 0.0 { look_at } else { look_from + DVec3::X },
        vfov_degrees: draws.log(1.0, 120.0),
        defocus_angle_degrees: if has_lens { draws.log(1e-3, 30.0) } else { 0.0 },
        ..Camera::BOOK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_valid_and_repeat() {
        for number in 0..400 {
            let recipe = scene(1, number);
            if let Err(error) = recipe.job() {
                panic!("scene {number}: {error}");
            }
            assert_eq!(recipe, scene(1, number));
        }
        assert_ne!(scene(1, 0), scene(2, 0));
    }

    #[test]
    fn every_difficulty_comes_up() {
        let recipes: Vec<Recipe> = (0..300).map(|number| scene(0, number)).collect();
        let has = |test: &dyn Fn(&Recipe) -> bool| recipes.iter().any(test);
        let copies = |recipe: &Recipe| {
            let spheres = &recipe.scene.spheres;
            (1..spheres.len()).any(|i| spheres[..i].contains(&spheres[i]))
        };
        assert!(has(&copies), "copies");
        assert!(has(&|r| r.camera.look_from.length() > 1e4), "far from the origin");
        assert!(has(&|r| r.scene.spheres.iter().all(|s| s.radius < 1e-3)), "small");
        assert!(has(&|r| r.camera.defocus_angle_degrees > 0.0), "lenses");
        let within = |r: &Recipe| {
            r.scene.spheres.iter().any(|s| s.center.distance(r.camera.look_from) < 0.9 * s.radius)
        };
        assert!(has(&within), "eyes within");
    }
}
