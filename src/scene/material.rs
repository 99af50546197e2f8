//! How surfaces scatter light. (Book 1, sections 9 to 11.)

use super::SceneError;
use super::error::{allowed, colour};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::RangeInclusive;

pub const REFRACTION_INDEX_LIMITS: RangeInclusive<f64> = 1e-9..=1e9;

/// How a surface scatters light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields, expecting = "a table of a material")]
pub enum Material {
    /// Scatters with a density proportional to the cosine of the angle to the normal. (Section 9.4.)
    Lambertian {
        /// Reflectance, linear RGB, each component in `0..=1`.
        albedo: DVec3,
    },
    /// A mirror, blurred by `fuzz`. (Section 10.)
    Metal {
        /// Reflectance, linear RGB, each component in `0..=1`.
        albedo: DVec3,
        /// Radius of the sphere that the offset to the reflected unit direction is drawn from; 0 is a mirror. Not
        /// negative. Values above 1 act as 1, as in the book.
        #[serde(default)]
        fuzz: f64,
    },
    /// Refracts or reflects light and absorbs none. (Section 11.)
    Dielectric {
        /// Relative to the surroundings; greater than 0 and at most `1e9`.
        refraction_index: f64,
    },
}

/// Which of the book's ways of scattering a material follows, or comes closest to. Explanations, drawings, path
/// comparisons and the plain tracer of `check` distinguish materials only by this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Look {
    /// Scatters in all directions. (Section 9.)
    Matte,
    /// Reflects. (Section 10.)
    Mirror {
        /// In effect, `0..=1`.
        fuzz: f64,
    },
    /// Refracts or reflects. (Section 11.)
    Glass {
        /// Relative to the surroundings.
        refraction_index: f64,
    },
}

/// A material with its name in the scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Unique within a scene.
    pub name: String,
    pub material: Material,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    Number(f64),
    Colour(DVec3),
}

impl Material {
    /// The book's names of all kinds.
    pub const KINDS: [&'static str; 3] = ["lambertian", "metal", "dielectric"];

    /// The parameters with their names in scene files, in writing order.
    pub fn parameters(&self) -> Vec<(&'static str, Parameter)> {
        use Parameter::{Colour, Number};
        match *self {
            Material::Lambertian { albedo } => vec![("albedo", Colour(albedo))],
            Material::Metal { albedo, fuzz } => vec![("albedo", Colour(albedo)), ("fuzz", Number(fuzz))],
            Material::Dielectric { refraction_index } => vec![("refraction_index", Number(refraction_index))],
        }
    }

    /// The fuzz in effect: at most 1 for metals, 0 for other materials.
    pub fn effective_fuzz(&self) -> f64 {
        match self {
            Material::Metal { fuzz, .. } => fuzz.min(1.0),
            _ => 0.0,
        }
    }

    /// Linear RGB; `None` for glass.
    pub fn albedo(&self) -> Option<DVec3> {
        match *self {
            Material::Lambertian { albedo } | Material::Metal { albedo, .. } => Some(albedo),
            Material::Dielectric { .. } => None,
        }
    }

    pub fn look(&self) -> Look {
        match *self {
            Material::Lambertian { .. } => Look::Matte,
            Material::Metal { .. } => Look::Mirror { fuzz: self.effective_fuzz() },
            Material::Dielectric { refraction_index } => Look::Glass { refraction_index },
        }
    }

    /// Whether rays can enter a sphere of this material.
    pub fn is_transparent(&self) -> bool {
        match self {
            Material::Dielectric { .. } => true,
            Material::Lambertian { .. } | Material::Metal { .. } => false,
        }
    }

    /// The book's name.
    pub fn kind(&self) -> &'static str {
        match self {
            Material::Lambertian { .. } => Material::KINDS[0],
            Material::Metal { .. } => Material::KINDS[1],
            Material::Dielectric { .. } => Material::KINDS[2],
        }
    }

    pub(crate) fn validate(&self, what: fmt::Arguments<'_>) -> Result<(), SceneError> {
        let of = |key: &str| format!("{what}.{key}");
        match *self {
            Material::Lambertian { albedo } => colour(|| of("albedo"), albedo, 1.0),
            Material::Metal { albedo, fuzz } => {
                colour(|| of("albedo"), albedo, 1.0)?;
                allowed(|| of("fuzz"), fuzz, fuzz >= 0.0, "0 or more", "use 0 for a perfect mirror")
            }
            Material::Dielectric { refraction_index } => allowed(
                || of("refraction_index"),
                refraction_index,
                REFRACTION_INDEX_LIMITS.contains(&refraction_index),
                "between 1e-9 and 1e9",
                "glass is about 1.5; an air bubble in glass is 1/1.5",
            ),
        }
    }
}
