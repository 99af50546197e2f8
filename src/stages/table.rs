//! The stages in the book's order. Section numbers and scene values are those of v4.0.2.

mod camera;
mod materials;
mod rays;

use super::{Rules, Setup, Stage, Transfer};
use crate::scene::Camera;
use crate::scene::builtin::{LeftSphere, empty, matte_on_ground, three_spheres};

const LINEAR: Rules = Rules { transfer: Transfer::Linear, ..Rules::FINISHED };

/// One ray through each pixel's centre, which ends at its first hit.
const ONE_RAY: Setup = Setup {
    scene: empty,
    camera: Camera::BOOK,
    rules: Rules { antialiasing: false, ..LINEAR },
    width: 480,
    height: 270,
    samples_per_pixel: 1,
    max_depth: 1,
};

/// Paths with as many rays as the book allows. The number of samples is a power of two, at which Sobol points are most
/// evenly distributed.
const PATHS: Setup = Setup {
    scene: matte_on_ground,
    camera: Camera::BOOK,
    rules: Rules::FINISHED,
    width: 480,
    height: 270,
    samples_per_pixel: 128,
    max_depth: 50,
};

const THREE_BALLS: Setup = Setup { scene: || three_spheres(LeftSphere::HollowGlass), ..PATHS };

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
