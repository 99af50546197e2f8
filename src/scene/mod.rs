//! A scene as plain data: spheres, materials, a sky and a camera.
//!
//! Nothing here depends on how pictures are made. Lengths are in scene units, angles in degrees (the renderers use
//! radians), and colours are linear RGB. All numbers are `f64`, so a scene survives a round trip through a file bit for
//! bit. The renderers round once, when they prepare the scene.

pub mod animation;

pub mod builtin;
mod camera;
mod error;
mod material;
mod pick;
mod sphere;

pub use camera::{Camera, CameraBasis, DEFOCUS_LIMIT_DEGREES, FOCUS_LIMITS, VFOV_LIMITS_DEGREES};
pub use error::{LENGTH_LIMIT, SceneError};
pub(crate) use error::{missing_material, toml_key, toml_string};
pub use material::{Look, Material, NamedMaterial, Parameter, REFRACTION_INDEX_LIMITS};
pub use pick::Pick;
pub use sphere::{RADIUS_LIMITS, Sphere};

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Upper limit on a component of a sky colour. The film's fixed point holds radiance below 128 per sample
/// ([`crate::film::RADIANCE_LIMIT`]), and paths never gain energy, so a sky within this limit never saturates.
pub const SKY_LIMIT: f64 = 100.0;

/// A vertical gradient around the scene, its only light source. (Book 1, section 4.2.)
///
/// A ray that leaves the scene in the unit direction `d` receives the radiance `(1 - a) bottom + a top`, where
/// `a = (d.y + 1) / 2`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sky {
    /// Radiance from straight below, linear RGB, each component in `0..=100`.
    pub bottom: DVec3,
    /// Radiance from straight above, linear RGB, each component in `0..=100`.
    pub top: DVec3,
}

impl Default for Sky {
    fn default() -> Self {
        Sky { bottom: DVec3::ONE, top: DVec3::new(0.5, 0.7, 1.0) }
    }
}

impl Sky {
    pub(crate) fn validate(&self) -> Result<(), SceneError> {
        error::colour(|| "sky.bottom".to_owned(), self.bottom, SKY_LIMIT)?;
        error::colour(|| "sky.top".to_owned(), self.top, SKY_LIMIT)
    }
}

/// Spheres under a sky.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// Spheres refer to them by index.
    pub materials: Vec<NamedMaterial>,
    /// In file order. May be empty.
    pub spheres: Vec<Sphere>,
    pub sky: Sky,
}

impl Scene {
    pub fn add_material(&mut self, name: impl Into<String>, material: Material) -> usize {
        self.materials.push(NamedMaterial { name: name.into(), material });
        self.materials.len() - 1
    }

    /// Adds a sphere, in scene units.
    pub fn add_sphere(&mut self, center: DVec3, radius: f64, material: usize) {
        self.spheres.push(Sphere { center, radius, material });
    }

    /// Panics if the sphere's material index is out of range, which [`Scene::validate`] excludes.
    pub fn material_of(&self, sphere: &Sphere) -> &Material {
        &self.materials[sphere.material].material
    }

    /// Checks every number against its limits. The error describes the first invalid value, with its limit and a
    /// remedy.
    pub fn validate(&self) -> Result<(), SceneError> {
        let mut names = HashSet::with_capacity(self.materials.len());
        for named in &self.materials {
            if !names.insert(named.name.as_str()) {
                return Err(SceneError(format!("two materials are called {:?}; rename one", named.name)));
            }
            named.material.validate(format_args!("materials.{}", named.name))?;
        }
        for (index, sphere) in self.spheres.iter().enumerate() {
            sphere.validate(index, self.materials.len())?;
        }
        self.sky.validate()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn material_names_are_unique() {
        let mut scene = Scene::default();
        scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        scene.add_material("glass", Material::Dielectric { refraction_index: 1.7 });
        let refused = scene.validate().expect_err("refused").to_string();
        assert!(refused.contains("\"glass\""), "{refused}");
    }
}
