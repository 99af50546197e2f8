//! What is to be rendered, as plain data: spheres, materials, a sky and a camera.
//!
//! Nothing here knows how a picture is made. Lengths are in scene units, angles in degrees (this is the
//! interface; the renderers work in radians), colours are linear RGB. All of it is `f64`, so that a scene
//! written to a file and read back is the same scene to the bit; the renderers round once, when they build
//! their own tables.

pub mod builtin;
mod camera;
mod error;
mod material;
mod pick;
mod sphere;

pub use camera::{Camera, CameraBasis, DEFOCUS_LIMIT_DEGREES, VFOV_LIMITS_DEGREES};
pub use error::SceneError;
pub use material::{Material, NamedMaterial, Parameter};
pub use pick::Pick;
pub use sphere::Sphere;

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Largest component of a sky colour. The film's fixed point holds one sample's radiance below 128
/// ([`crate::film::RADIANCE_LIMIT`]); no path gains energy on the way, so a sky below it never saturates.
pub const SKY_LIMIT: f64 = 100.0;

/// A vertical gradient that surrounds the scene and is its only light. (Book 1, section 4.2.)
///
/// A ray that leaves the scene in the unit direction `d` gathers
/// `(1 - a) bottom + a top` with `a = (d.y + 1) / 2`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    /// Radiance straight down, linear RGB, each component in `0..=100`.
    pub bottom: DVec3,
    /// Radiance straight up, linear RGB, each component in `0..=100`.
    pub top: DVec3,
}

impl Default for Sky {
    fn default() -> Self {
        Sky { bottom: DVec3::ONE, top: DVec3::new(0.5, 0.7, 1.0) }
    }
}

/// Spheres under a sky.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// Materials; a sphere names one by its index here.
    pub materials: Vec<NamedMaterial>,
    /// Spheres, in the order of the file. May be empty.
    pub spheres: Vec<Sphere>,
    /// The light.
    pub sky: Sky,
}

impl Scene {
    /// Adds a material and returns its index.
    pub fn add_material(&mut self, name: impl Into<String>, material: Material) -> usize {
        self.materials.push(NamedMaterial { name: name.into(), material });
        self.materials.len() - 1
    }

    /// Adds a sphere with its centre and radius in scene units.
    pub fn add_sphere(&mut self, center: DVec3, radius: f64, material: usize) {
        self.spheres.push(Sphere { center, radius, material });
    }

    /// The material of a sphere.
    ///
    /// # Panics
    /// If the sphere's material index is out of range, which [`Scene::validate`] rules out.
    pub fn material_of(&self, sphere: &Sphere) -> &Material {
        &self.materials[sphere.material].material
    }

    /// Checks every number against its limits.
    ///
    /// # Errors
    /// The first value that no picture can be made with, with its limit and what to do about it.
    pub fn validate(&self) -> Result<(), SceneError> {
        let mut names = HashSet::with_capacity(self.materials.len());
        for named in &self.materials {
            if !names.insert(named.name.as_str()) {
                return Err(SceneError::DuplicateMaterial { name: named.name.clone() });
            }
            named.material.validate(&named.name)?;
        }
        for (index, sphere) in self.spheres.iter().enumerate() {
            sphere.validate(index, self.materials.len())?;
        }
        error::colour(|| "sky.bottom".to_owned(), self.sky.bottom, SKY_LIMIT)?;
        error::colour(|| "sky.top".to_owned(), self.sky.top, SKY_LIMIT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies_are_bright_but_not_too_bright() {
        let under = |sky| Scene { sky, ..Scene::default() }.validate();
        under(Sky { bottom: DVec3::ZERO, top: DVec3::splat(SKY_LIMIT) }).expect("within the limits");
        let bright = under(Sky { top: DVec3::splat(101.0), ..Sky::default() }).expect_err("refused");
        assert!(bright.to_string().starts_with("sky.top is [101, 101, 101]"), "{bright}");
        let nan = under(Sky { bottom: DVec3::NAN, ..Sky::default() }).expect_err("refused");
        assert!(nan.to_string().starts_with("sky.bottom.x is NaN"), "{nan}");
    }

    #[test]
    fn material_names_are_unique() {
        let mut scene = Scene::default();
        scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        scene.add_material("glass", Material::Dielectric { refraction_index: 1.7 });
        let refused = scene.validate().expect_err("refused").to_string();
        assert!(refused.contains("\"glass\""), "{refused}");
    }
}
