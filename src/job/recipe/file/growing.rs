//! A scene while it is read.

use crate::scene::{Material, Scene, Sphere, missing_material};
use glam::DVec3;
use std::collections::HashMap;

/// A scene while it is read, and where its materials are. Errors name the next sphere.
#[derive(Default)]
pub(super) struct GrowingScene {
    pub scene: Scene,
    named: HashMap<String, usize>,
    coloured: HashMap<[u64; 3], usize>,
}

impl GrowingScene {
    /// Adds a material and returns its index.
    pub fn add_material(&mut self, name: String, material: Material) -> usize {
        let index = self.scene.add_material(name.clone(), material);
        self.named.insert(name, index);
        index
    }

    pub fn material(&self, name: &str) -> Result<usize, String> {
        let missing = || missing_material(self.scene.spheres.len(), name).to_string();
        self.named.get(name).copied().ok_or_else(missing)
    }

    /// Adds the own material of the next sphere, which gets a unique name.
    pub fn own_material(&mut self, material: Material) -> Result<usize, String> {
        let sphere = self.scene.spheres.len();
        material.validate(format_args!("spheres[{sphere}].material")).map_err(|error| error.to_string())?;
        let mut name = format!("sphere-{sphere}");
        while self.named.contains_key(&name) {
            name.push('*');
        }
        Ok(self.add_material(name, material))
    }

    /// The matte material of this colour, which spheres share.
    pub fn matte(&mut self, albedo: DVec3) -> Result<usize, String> {
        let bits = albedo.to_array().map(f64::to_bits);
        if let Some(known) = self.coloured.get(&bits) {
            return Ok(*known);
        }
        let material = self.own_material(Material::Lambertian { albedo })?;
        self.coloured.insert(bits, material);
        Ok(material)
    }

    pub fn add_sphere(&mut self, center: DVec3, radius: f64, material: usize) -> Result<(), String> {
        let Scene { spheres, materials, .. } = &mut self.scene;
        let sphere = Sphere { center, radius, material };
        sphere.validate(spheres.len(), materials.len()).map_err(|error| error.to_string())?;
        spheres.push(sphere);
        Ok(())
    }
}
