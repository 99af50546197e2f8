//! Rules and settings that several stages share.

use crate::scene::Camera;
use crate::scene::builtin::{LeftSphere, empty, matte_on_ground, three_spheres};
use crate::stages::{Rules, Setup, Transfer};

pub(super) const LINEAR: Rules = Rules { transfer: Transfer::Linear, ..Rules::FINISHED };

/// One ray through each pixel's centre, which ends at its first hit.
pub(super) const ONE_RAY: Setup = Setup {
    scene: empty,
    camera: Camera::BOOK,
    rules: Rules { antialiasing: false, ..LINEAR },
    width: 480,
    height: 270,
    samples_per_pixel: 1,
    max_depth: 1,
    is_in_book: true,
    is_about_pixels: false,
    has_random_spheres: false,
};

/// Paths with as many rays as the book allows. The number of samples is a power of two, at which Sobol points are most
/// evenly distributed.
pub(super) const PATHS: Setup = Setup {
    scene: matte_on_ground,
    camera: Camera::BOOK,
    rules: Rules::FINISHED,
    width: 480,
    height: 270,
    samples_per_pixel: 128,
    max_depth: 50,
    is_in_book: true,
    is_about_pixels: false,
    has_random_spheres: false,
};

pub(super) const THREE_BALLS: Setup = Setup { scene: || three_spheres(LeftSphere::HollowGlass), ..PATHS };
