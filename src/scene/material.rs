//! What happens to light at a surface. (Book 1, sections 9 to 11.)

use super::SceneError;
use super::error::{colour, finite};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A surface's behaviour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Material {
    /// Scatters in proportion to the cosine with the normal. (Section 9.4.)
    Lambertian {
        /// Reflected share, linear RGB, each in `0..=1`.
        albedo: DVec3,
    },
    /// Reflects as a mirror, blurred by `fuzz`. (Section 10.)
    Metal {
        /// Reflected share, linear RGB, each in `0..=1`.
        albedo: DVec3,
        /// Radius of the sphere that the reflected unit direction is moved within; 0 is a mirror.
        /// Not negative; what is above 1 acts as 1, as in the book.
        #[serde(default)]
        fuzz: f64,
    },
    /// Refracts or reflects, and absorbs nothing. (Section 11.)
    Dielectric {
        /// The material's index over that of what surrounds it, more than 0 and at most `1e9`.
        refraction_index: f64,
    },
}

/// A material and what the scene file calls it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Unique within a scene.
    pub name: String,
    /// The behaviour.
    pub material: Material,
}

/// A number or colour that a material has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parameter {
    /// A plain number.
    Number(f64),
    /// Linear RGB.
    Colour(DVec3),
}

impl Material {
    /// The book's words for all kinds.
    pub const KINDS: [&'static str; 3] = ["lambertian", "metal", "dielectric"];

    /// What scene files call its numbers and colours, in the order in which they are written.
    pub fn parameters(&self) -> Vec<(&'static str, Parameter)> {
        use Parameter::{Colour, Number};
        match *self {
            Material::Lambertian { albedo } => vec![("albedo", Colour(albedo))],
            Material::Metal { albedo, fuzz } => vec![("albedo", Colour(albedo)), ("fuzz", Number(fuzz))],
            Material::Dielectric { refraction_index } => vec![("refraction_index", Number(refraction_index))],
        }
    }

    /// The fuzz that acts: 0 for other materials, at most 1 for a metal.
    pub fn effective_fuzz(&self) -> f64 {
        match self {
            Material::Metal { fuzz, .. } => fuzz.min(1.0),
            _ => 0.0,
        }
    }

    /// The share that it reflects, linear RGB; glass has none of its own.
    pub fn albedo(&self) -> Option<DVec3> {
        match *self {
            Material::Lambertian { albedo } | Material::Metal { albedo, .. } => Some(albedo),
            Material::Dielectric { .. } => None,
        }
    }

    /// The book's word for it.
    pub fn kind(&self) -> &'static str {
        match self {
            Material::Lambertian { .. } => Material::KINDS[0],
            Material::Metal { .. } => Material::KINDS[1],
            Material::Dielectric { .. } => Material::KINDS[2],
        }
    }

    pub(super) fn validate(&self, name: &str) -> Result<(), SceneError> {
        let of = |key: &str| format!("materials.{name}.{key}");
        match *self {
            Material::Lambertian { albedo } => colour(|| of("albedo"), albedo, 1.0),
            Material::Metal { albedo, fuzz } => {
                colour(|| of("albedo"), albedo, 1.0)?;
                finite(|| of("fuzz"), fuzz)?;
                if fuzz < 0.0 {
                    return Err(SceneError::range(
                        of("fuzz"),
                        fuzz,
                        "0 or more",
                        "use 0 for a perfect mirror",
                    ));
                }
                Ok(())
            }
            Material::Dielectric { refraction_index } => {
                finite(|| of("refraction_index"), refraction_index)?;
                if !(refraction_index > 0.0 && (1e-9..=1e9).contains(&refraction_index)) {
                    return Err(SceneError::range(
                        of("refraction_index"),
                        refraction_index,
                        "within 1e-9 and 1e9",
                        "glass is about 1.5; an air bubble in glass is 1/1.5",
                    ));
                }
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(material: Material) -> String {
        material.validate("m").expect_err("refused").to_string()
    }

    #[test]
    fn materials_reflect_no_more_than_they_get() {
        for albedo in [DVec3::new(0.0, 1.1, 0.0), DVec3::new(0.0, 0.0, -0.1)] {
            assert!(refusal(Material::Lambertian { albedo }).starts_with("materials.m.albedo is [0, "));
            assert!(refusal(Material::Metal { albedo, fuzz: 0.0 }).contains("within 0 and 1"));
        }
        Material::Lambertian { albedo: DVec3::ONE }.validate("m").expect("white is fine");
    }

    #[test]
    fn fuzz_above_one_is_kept_and_acts_as_one() {
        let fuzzy = Material::Metal { albedo: DVec3::ONE, fuzz: 5.0 };
        fuzzy.validate("m").expect("as in the book");
        assert_eq!(fuzzy.effective_fuzz(), 1.0);
        let refused = refusal(Material::Metal { albedo: DVec3::ONE, fuzz: -0.5 });
        assert!(refused.starts_with("materials.m.fuzz is -0.5, but must be 0 or more"), "{refused}");
        assert!(refusal(Material::Metal { albedo: DVec3::ONE, fuzz: f64::NAN }).contains("fuzz is NaN"));
    }

    #[test]
    fn refraction_indices_are_positive() {
        for refraction_index in [0.0, -1.5, 1e10, f64::INFINITY] {
            let refused = refusal(Material::Dielectric { refraction_index });
            assert!(refused.starts_with("materials.m.refraction_index is"), "{refused}");
        }
    }
}
