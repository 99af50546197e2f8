//! The built-in scenes and their registry.

mod book;
mod chapters;
mod field;
mod random;

pub use book::{BOOK_CAMERA, book, book_of};
pub use chapters::{
    LeftSphere, SIDE_VIEW, WIDE_LENS, empty, matte_on_ground, metals, one_sphere, three_spheres,
    touching_spheres,
};
pub use field::{FIELD_COUNT_LIMITS, field, is_field};

use super::{Camera, Scene};

/// A generated scene with default render settings.
#[derive(Clone, Copy, Debug)]
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

/// The settings that most of them share.
const SMALL: BuiltinScene = BuiltinScene {
    name: "",
    about: "",
    width: 800,
    height: 450,
    samples_per_pixel: 128,
    max_depth: 50,
    build: || (empty(), Camera::BOOK),
};

impl BuiltinScene {
    /// A [`field`] of the default size.
    pub const FIELD: BuiltinScene = BuiltinScene {
        name: "field",
        about: "ten thousand small spheres on a wide ground; field:N has N of them",
        max_depth: 24,
        build: || field(10_000),
        ..SMALL
    };

    /// All built-in scenes, the default first.
    pub const ALL: &'static [BuiltinScene] = &[
        BuiltinScene {
            name: "three-spheres",
            about: "hollow glass, matte and fuzzy metal side by side: the default (11.5)",
            samples_per_pixel: 200,
            max_depth: 24,
            build: || (three_spheres(LeftSphere::HollowGlass), Camera::BOOK),
            ..SMALL
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
            build: || (matte_on_ground(), Camera::BOOK),
            ..SMALL
        },
        BuiltinScene {
            name: "metals",
            about: "a matte ball between a smooth and a brushed mirror (10.6)",
            build: || (metals(0.3, 1.0), Camera::BOOK),
            ..SMALL
        },
        BuiltinScene {
            name: "close-up",
            about: "the three spheres from the side, through a wide lens (13.2)",
            samples_per_pixel: 256,
            build: || (three_spheres(LeftSphere::HollowGlass), WIDE_LENS),
            ..SMALL
        },
        BuiltinScene {
            name: "touching-spheres",
            about: "a blue and a red ball that fill a right angle exactly (12.1)",
            build: || (touching_spheres(), Camera::BOOK),
            ..SMALL
        },
    ];

    pub fn find(name: &str) -> Option<&'static BuiltinScene> {
        Self::ALL.iter().find(|scene| scene.name == name)
    }
}
