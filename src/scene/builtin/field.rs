//! A field of any number of spheres, for measuring how render time scales.

use super::random::{Draws, to_four_decimals};
use crate::scene::{Camera, Material, Scene, Sphere};
use glam::DVec3;
use std::ops::RangeInclusive;

/// Limits on a field's small spheres.
pub const FIELD_COUNT_LIMITS: RangeInclusive<u64> = 1..=10_000_000;

const SEED: u64 = 20;

/// Number of matte materials: the palette and the ground's, shared by all spheres.
const MATTE_COUNT: usize = 44;
const METAL_COUNT: usize = 15;
const GLASS_COUNT: usize = 4;

/// Side of each sphere's square cell, scene units.
const CELL: f64 = 1.0;

/// `count` small spheres on a large one, with a camera that looks across them.
///
/// Each sphere has its own cell in a square grid, so none overlap, and the width of the field follows from their
/// number. Colours form patches. `count` is clamped to [`FIELD_COUNT_LIMITS`]. Time and memory (40 bytes per sphere)
/// are proportional to it.
pub fn field(count: u64) -> (Scene, Camera) {
    let count = count.clamp(*FIELD_COUNT_LIMITS.start(), *FIELD_COUNT_LIMITS.end());
    let ground = Ground::of(count);
    let mut scene = ground.bare_scene();
    scene.spheres.reserve_exact(count as usize);
    scene.spheres.extend((0..count).map(|index| ground.sphere(index)));

    let half_width = ground.half_width;
    // Keep the middle ground in view as the far edge recedes.
    let height = 3.0 * (half_width / 16.0).sqrt().max(0.5);
    let camera = Camera {
        look_from: DVec3::new(0.35 * half_width, height, half_width + 2.0 * height),
        look_at: DVec3::new(0.0, 0.0, 0.25 * half_width),
        vfov_degrees: 35.0,
        ..Camera::BOOK
    };
    (scene, camera)
}

/// Whether a scene equals the [`field`] of `count` spheres, bit for bit. Allocates no memory.
pub fn is_field(scene: &Scene, count: u64) -> bool {
    if !FIELD_COUNT_LIMITS.contains(&count) || scene.spheres.len() as u64 != count + 1 {
        return false;
    }
    let ground = Ground::of(count);
    let bare = ground.bare_scene();
    (&scene.materials, scene.sky, scene.spheres[0]) == (&bare.materials, bare.sky, bare.spheres[0])
        && scene.spheres[1..].iter().copied().eq((0..count).map(|index| ground.sphere(index)))
}

struct Ground {
    columns: u64,
    /// Half the field's side, scene units.
    half_width: f64,
    radius: f64,
    center: DVec3,
}

impl Ground {
    fn of(count: u64) -> Self {
        let columns = (count as f64).sqrt().ceil() as u64;
        let half_width = 0.5 * CELL * columns as f64;
        // So large that the field is only a gently curved part of it.
        let radius = (100.0 * half_width).max(1000.0);
        Ground { columns, half_width, radius, center: DVec3::new(0.0, -radius, 0.0) }
    }

    /// A scene with all materials and only the ground.
    fn bare_scene(&self) -> Scene {
        let mut scene = Scene::default();
        let ground =
            scene.add_material("ground", Material::Lambertian { albedo: DVec3::new(0.45, 0.44, 0.42) });
        scene.add_sphere(self.center, self.radius, ground);
        add_palette(&mut scene);
        scene
    }

    /// The small sphere in cell `index`.
    fn sphere(&self, index: u64) -> Sphere {
        let mut draws = Draws::new(SEED, index);
        let radius = to_four_decimals(draws.within(0.18, 0.42));
        let room = 0.5 * CELL - radius;
        let mut along = |cell: u64| (cell as f64 + 0.5) * CELL - self.half_width + draws.within(-room, room);
        let (x, z) = (along(index % self.columns), along(index / self.columns));
        let toward = DVec3::new(x, self.radius, z).normalize();
        let center = (self.center + (self.radius + radius) * toward).map(to_four_decimals);
        Sphere { center, radius, material: 1 + palette_index(x, z, &mut draws) }
    }
}

fn add_palette(scene: &mut Scene) {
    for index in 0..MATTE_COUNT {
        let turn = index as f64 / MATTE_COUNT as f64;
        let albedo = hue(turn, 0.75, 0.85 - 0.3 * (index % 3) as f64 / 2.0);
        scene.add_material(format!("matte-{index}"), Material::Lambertian { albedo });
    }
    for index in 0..METAL_COUNT {
        let turn = 0.02 + 0.6 * index as f64 / METAL_COUNT as f64;
        let fuzz = [0.0, 0.1, 0.35][index % 3];
        scene.add_material(format!("metal-{index}"), Material::Metal { albedo: hue(turn, 0.3, 0.92), fuzz });
    }
    for (index, refraction_index) in [1.33, 1.5, 1.7, 2.4].into_iter().enumerate() {
        scene.add_material(format!("glass-{index}"), Material::Dielectric { refraction_index });
    }
}

/// Index of a palette material for a sphere at `(x, z)`; nearby spheres have similar hues.
fn palette_index(x: f64, z: f64, draws: &mut Draws) -> usize {
    let pick = |turn: f64, count: usize| ((turn.rem_euclid(1.0) * count as f64) as usize).min(count - 1);
    // Triangle waves, because sines differ between machines.
    let wave = |position: f64, length: f64| (2.0 * (position / length).rem_euclid(1.0) - 1.0).abs();
    let patch = 0.6 * wave(x + 0.3 * z, 29.0) + 0.6 * wave(z - 0.4 * x, 41.0) + draws.within(-0.07, 0.07);
    match draws.unit() {
        kind if kind < 0.72 => pick(patch, MATTE_COUNT),
        kind if kind < 0.92 => MATTE_COUNT + pick(draws.unit(), METAL_COUNT),
        _ => MATTE_COUNT + METAL_COUNT + pick(draws.unit(), GLASS_COUNT),
    }
}

/// Linear RGB of the hue `turn` (0 red, 1/3 green, 2/3 blue), `saturation` and `value` in `0..=1`.
fn hue(turn: f64, saturation: f64, value: f64) -> DVec3 {
    let channel = |offset: f64| {
        let distance = (6.0 * (turn + offset).rem_euclid(1.0) - 3.0).abs();
        let share = (distance - 1.0).clamp(0.0, 1.0);
        to_four_decimals(value * (1.0 - saturation * (1.0 - share)))
    };
    DVec3::new(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn field_spheres_touch_only_ground() {
        let (scene, _) = field(900);
        let (ground, small) = scene.spheres.split_first().expect("a ground");
        for (index, sphere) in small.iter().enumerate() {
            let gap = sphere.center.distance(ground.center) - ground.radius - sphere.radius;
            assert!(gap.abs() < 2e-4, "{index}: {gap}");
            for other in &small[..index] {
                let gap = sphere.center.distance(other.center) - sphere.radius - other.radius;
                assert!(gap > -1e-3, "{index}: {gap}");
            }
        }
    }

    #[test]
    fn changed_field_is_not_field() {
        let (scene, _) = field(17);
        assert!(is_field(&scene, 17) && !is_field(&scene, 16));
        let mut other = scene.clone();
        other.sky.top.x *= 0.5;
        assert!(!is_field(&other, 17), "another sky");
        let mut other = scene.clone();
        other.spheres[0].radius *= 2.0;
        assert!(!is_field(&other, 17), "another ground");
        let mut other = scene.clone();
        other.spheres[17].material = 0;
        assert!(!is_field(&other, 17), "another sphere");
    }
}
