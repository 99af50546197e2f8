//! A sphere. (Book 1, section 5.)

use super::SceneError;
use super::error::{LENGTH_LIMIT, allowed, missing_material, position};
use glam::DVec3;
use std::ops::RangeInclusive;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Scene units.
    pub center: DVec3,
    /// Scene units, greater than 0. The book's early editions made hollow spheres with a negative radius; since version
    /// 4 a hollow sphere contains one of the inverse refraction index.
    pub radius: f64,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
}

/// Limits on the radius, scene units. The smallest square must be a normal `f32`.
pub const RADIUS_LIMITS: RangeInclusive<f64> = 1e-18..=LENGTH_LIMIT;

impl Sphere {
    pub(crate) fn validate(&self, index: usize, material_count: usize) -> Result<(), SceneError> {
        let of = |key: &str| format!("spheres[{index}].{key}");
        position(|| of("center"), self.center)?;
        let remedy = match self.radius {
            ..0.0 => "for a hollow glass sphere, put a smaller sphere of index 1/n inside it",
            _ => "give the sphere a size or remove it",
        };
        let is_allowed = RADIUS_LIMITS.contains(&self.radius);
        allowed(|| of("radius"), self.radius, is_allowed, "between 1e-18 and 1e18", remedy)?;
        if self.material >= material_count {
            return Err(missing_material(index, &self.material.to_string()));
        }
        Ok(())
    }
}
