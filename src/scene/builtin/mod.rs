//! The built-in scenes and their registry.

mod book;
mod chapters;
mod field;
mod random;

pub use book::{BOOK_CAMERA, book};
pub use chapters::{
    LeftSphere, empty, matte_on_ground, metals, one_sphere, three_spheres, touching_spheres,
    view_from_the_side,
};
pub use field::{FIELD_COUNT_LIMITS, field, is_field};

use super::{Camera, Scene};
use std::fmt;

/// A generated scene with default render settings.
#[derive(Clone, Copy)]
pub struct BuiltinScene {
    /// Name on the command line and in the window.
    pub name: &'static str,
    /// One line.
    pub about: &'static str,
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u64,
    /// Default limit on rays per path, including the camera ray.
    pub max_depth: u32,
    /// Always gives the same scene and camera.
    pub build: fn() -> (Scene, Camera),
}

impl BuiltinScene {
    /// A [`field`] of the default size.
    pub const FIELD: BuiltinScene = BuiltinScene {
        name: "field",
        about: "ten thousand small spheres on a wide ground; field:N has N of them",
        width: 800,
        height: 450,
        samples_per_pixel: 128,
        max_depth: 24,
        build: || field(10_000),
    };

    /// All built-in scenes, the default first.
    pub const ALL: &'static [BuiltinScene] = &[
        BuiltinScene {
            name: "three-spheres",
            about: "hollow glass, matte and fuzzy metal side by side: the default (11.5)",
            width: 800,
            height: 450,
            samples_per_pixel: 200,
            max_depth: 24,
            build: || (three_spheres(LeftSphere::HollowGlass), Camera::BOOK),
        },
        BuiltinScene {
            name: "book",
            about: "the book's final render: 485 spheres and a lens (14.1)",
            width: 1200,
            height: 675,
            samples_per_pixel: 500,
            max_depth: 50,
            build: || (book(), BOOK_CAMERA),
        },
        Self::FIELD,
        BuiltinScene {
            name: "two-spheres",
            about: "a grey matte ball on a grey matte ground: light transport and nothing else (9)",
            width: 800,
            height: 450,
            samples_per_pixel: 128,
            max_depth: 50,
            build: || (matte_on_ground(), Camera::BOOK),
        },
        BuiltinScene {
            name: "metals",
            about: "a matte ball between a smooth and a brushed mirror (10.6)",
            width: 800,
            height: 450,
            samples_per_pixel: 128,
            max_depth: 50,
            build: || (metals(0.3, 1.0), Camera::BOOK),
        },
        BuiltinScene {
            name: "close-up",
            about: "the three spheres from the side, through a wide lens (13.2)",
            width: 800,
            height: 450,
            samples_per_pixel: 256,
            max_depth: 50,
            build: || {
                let camera = Camera {
                    defocus_angle_degrees: 10.0,
                    focus_distance: Some(3.4),
                    ..view_from_the_side(20.0)
                };
                (three_spheres(LeftSphere::HollowGlass), camera)
            },
        },
        BuiltinScene {
            name: "touching-spheres",
            about: "a blue and a red ball that fill a right angle exactly (12.1)",
            width: 800,
            height: 450,
            samples_per_pixel: 128,
            max_depth: 50,
            build: || (touching_spheres(), Camera::BOOK),
        },
    ];

    pub fn find(name: &str) -> Option<&'static BuiltinScene> {
        Self::ALL.iter().find(|scene| scene.name == name)
    }
}

impl fmt::Debug for BuiltinScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BuiltinScene").field("name", &self.name).finish_non_exhaustive()
    }
}
