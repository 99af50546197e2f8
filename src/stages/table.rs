//! The stages in the book's order. Section numbers and scene values are those of v4.0.2.

mod camera;
mod materials;
mod rays;
mod setups;

use super::Stage;

pub(super) const STAGES: &[Stage] = &[
    rays::PPM_TINY,
    rays::PPM_GRADIENT,
    rays::SKY,
    rays::RED_SPHERE,
    rays::NORMALS,
    rays::NORMALS_WORLD,
    rays::ALIASED,
    rays::ANTIALIASED,
    materials::DIFFUSE,
    materials::DIFFUSE_LIMITED,
    materials::SHADOW_ACNE,
    materials::LAMBERTIAN_LINEAR,
    materials::LAMBERTIAN_GAMMA,
    materials::GAMUT,
    materials::METAL,
    materials::METAL_FUZZY,
    materials::GLASS_REFRACT,
    materials::GLASS_TIR,
    materials::GLASS_SCHLICK,
    materials::HOLLOW_GLASS,
    materials::THREE_SPHERES,
    camera::FOV_WIDE,
    camera::FOV_NARROW,
    camera::VIEW_DISTANT,
    camera::VIEW_CLOSE,
    camera::DEFOCUS,
    camera::BOOK,
];
