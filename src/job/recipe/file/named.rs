//! Built-in scenes that a file names instead of listing their spheres.

use crate::film::Checksum;
use crate::scene::builtin::is_field;
use crate::scene::{Material, Parameter, Scene};
use glam::DVec3;

/// Fields of at least this many spheres are named in pictures: listing a million takes seconds and a hundred megabytes.
/// Smaller fields are listed, so that the picture can be rendered again even if the built-in field changes.
const NAMED_FROM: usize = 10_000;

/// Name of the built-in field that equals the scene to the bit; `None` if there is none, or it is small enough to list.
pub(super) fn name_of(scene: &Scene) -> Option<String> {
    let count = scene.spheres.len().checked_sub(1).filter(|count| *count >= NAMED_FROM)? as u64;
    is_field(scene, count).then(|| format!("field:{count}"))
}

/// A checksum of a scene: of all names and the bits of all numbers.
pub(super) fn mark(scene: &Scene) -> String {
    let mut sum = Checksum::default();
    let vector = |v: DVec3| v.to_array().map(f64::to_bits);
    let mut add = |words: &[u64]| sum.words(words);
    add(&vector(scene.sky.bottom));
    add(&vector(scene.sky.top));
    for named in &scene.materials {
        named.name.bytes().for_each(|byte| add(&[u64::from(byte)]));
        let kind = Material::KINDS.iter().position(|kind| *kind == named.material.kind());
        let mut words = vec![kind.map_or(0, |kind| kind as u64 + 1)];
        let (mut numbers, mut colours) = (Vec::new(), Vec::new());
        for (_, parameter) in named.material.parameters() {
            match parameter {
                Parameter::Number(number) => numbers.push(number.to_bits()),
                Parameter::Colour(colour) => colours.extend(vector(colour)),
            }
        }
        words.extend(numbers.into_iter().chain(colours));
        add(&words);
    }
    for sphere in &scene.spheres {
        add(&vector(sphere.center));
        add(&[sphere.radius.to_bits(), sphere.material as u64]);
    }
    sum.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_change_changes_the_mark() {
        let scene = |change: fn(&mut Scene)| {
            let mut scene = Scene::default();
            let albedo = DVec3::new(0.1, 0.2, 0.3);
            scene.add_material("a", Material::Lambertian { albedo });
            scene.add_material("b", Material::Metal { albedo, fuzz: 0.5 });
            scene.add_material("c", Material::Dielectric { refraction_index: 1.5 });
            for x in [0.0, 4.0] {
                scene.add_sphere(DVec3::X * x, 1.0, 0);
            }
            change(&mut scene);
            mark(&scene)
        };
        let changes: [fn(&mut Scene); 11] = [
            |_| {},
            |s| s.sky.bottom.z = 0.5,
            |s| s.materials[1].name.push('x'),
            |s| s.spheres[1].material = 1,
            |s| s.spheres[1].radius = 2.0,
            |s| s.spheres[0].center.y = -0.0,
            |s| s.spheres.swap(0, 1),
            |s| s.materials[0].material = Material::Lambertian { albedo: DVec3::new(0.1, 0.2, 0.4) },
            |s| s.materials[0].material = Material::Metal { albedo: DVec3::new(0.1, 0.2, 0.3), fuzz: 0.0 },
            |s| s.materials[1].material = Material::Metal { albedo: DVec3::new(0.1, 0.2, 0.3), fuzz: 0.25 },
            |s| s.materials[2].material = Material::Dielectric { refraction_index: 1.25 },
        ];
        let mut marks: Vec<String> = changes.into_iter().map(scene).collect();
        marks.sort_unstable();
        marks.dedup();
        assert_eq!(marks.len(), changes.len(), "each change gives another mark");
    }
}
