//! A sphere. (Book 1, section 5.)

use super::SceneError;
use super::error::finite;
use glam::DVec3;

/// A sphere with one material all over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, scene units.
    pub center: DVec3,
    /// Radius, scene units, more than 0. The book's early editions made a hollow sphere with a negative
    /// radius; since version 4 it is an inner sphere of the inverse refraction index.
    pub radius: f64,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
}

/// Largest coordinate or radius. Squares of it, and sums of three of those, must be finite in `f32`.
const LENGTH_LIMIT: f64 = 1e18;

/// Smallest radius. Its square must be a normal number in `f32`.
const RADIUS_MIN: f64 = 1e-18;

impl Sphere {
    pub(super) fn validate(&self, index: usize, material_count: usize) -> Result<(), SceneError> {
        let of = |key: &str| format!("spheres[{index}].{key}");
        for (axis, value) in [("x", self.center.x), ("y", self.center.y), ("z", self.center.z)] {
            finite(&format!("{}.{axis}", of("center")), value)?;
            if value.abs() > LENGTH_LIMIT {
                return Err(SceneError::range(
                    of("center"),
                    value,
                    "at most 1e18 in size",
                    "scale the scene down",
                ));
            }
        }
        finite(&of("radius"), self.radius)?;
        if !(RADIUS_MIN..=LENGTH_LIMIT).contains(&self.radius) {
            return Err(SceneError::range(
                of("radius"),
                self.radius,
                "within 1e-18 and 1e18",
                if self.radius < 0.0 {
                    "for a hollow glass sphere, put a smaller sphere of index 1/n inside it"
                } else {
                    "give the sphere a size or remove it"
                },
            ));
        }
        if self.material >= material_count {
            return Err(SceneError::MissingMaterial { sphere: index, material: self.material.to_string() });
        }
        Ok(())
    }
}
