//! The materials of a scene file.

use super::error::Reason;
use super::numbers::Real;
use super::triple::Triple;
use crate::scene::Material;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A material with the keys of all kinds. Whether they suit its kind is checked later, which gives clearer messages.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMaterial {
    kind: String,
    albedo: Option<Triple>,
    fuzz: Option<Real>,
    refraction_index: Option<Real>,
}

pub(super) enum NamedOrInline {
    Named(String),
    Inline(RawMaterial),
}

impl<'de> Deserialize<'de> for NamedOrInline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = NamedOrInline;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a material's name or a table such as { kind = \"metal\", albedo = [0.8, 0.8, 0.8] }",
                )
            }
            fn visit_str<E: de::Error>(self, name: &str) -> Result<NamedOrInline, E> {
                Ok(NamedOrInline::Named(name.to_owned()))
            }
            fn visit_string<E: de::Error>(self, name: String) -> Result<NamedOrInline, E> {
                Ok(NamedOrInline::Named(name))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<NamedOrInline, A::Error> {
                RawMaterial::deserialize(de::value::MapAccessDeserializer::new(map))
                    .map(NamedOrInline::Inline)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

/// Makes a material.
///
/// # Errors
/// The key that is wrong, and the reason.
pub(super) fn material_of(raw: &RawMaterial, what: &str) -> Result<Material, (&'static str, Reason)> {
    let missing =
        |kind, key, example| (key, Reason::MissingKey { what: what.to_owned(), kind, key, example });
    let none_of =
        |kind, keys, foreign: &[(&'static str, bool)]| match foreign.iter().find(|(_, is_there)| *is_there) {
            None => Ok(()),
            Some((key, _)) => Err((*key, Reason::ForeignKey { what: what.to_owned(), kind, key, keys })),
        };
    let albedo = |kind| match &raw.albedo {
        Some(albedo) => Ok(albedo.0),
        None => Err(missing(kind, "albedo", "albedo = [0.5, 0.5, 0.5]")),
    };
    let (has_albedo, has_fuzz) = (("albedo", raw.albedo.is_some()), ("fuzz", raw.fuzz.is_some()));
    let has_index = ("refraction_index", raw.refraction_index.is_some());
    match raw.kind.as_str() {
        "lambertian" => {
            none_of("lambertian", "albedo", &[has_fuzz, has_index])?;
            Ok(Material::Lambertian { albedo: albedo("lambertian")? })
        }
        "metal" => {
            none_of("metal", "albedo and fuzz", &[has_index])?;
            Ok(Material::Metal { albedo: albedo("metal")?, fuzz: raw.fuzz.unwrap_or_default().0 })
        }
        "dielectric" => {
            none_of("dielectric", "refraction_index", &[has_albedo, has_fuzz])?;
            let missing = || missing("dielectric", "refraction_index", "refraction_index = 1.5");
            Ok(Material::Dielectric { refraction_index: raw.refraction_index.ok_or_else(missing)?.0 })
        }
        kind => Err(("kind", Reason::UnknownKind { what: what.to_owned(), kind: kind.to_owned() })),
    }
}
