//! Chapters 2 to 8: pictures, rays, spheres and their normals, antialiasing.

use super::setups::{LINEAR, ONE_RAY, PATHS};
use crate::scene::builtin::{matte_on_ground, one_sphere};
use crate::stages::{Rules, Setup, Shading, Stage, sights};

const CHAPTER_2: &str = "Output an Image";
const CHAPTER_4: &str = "Rays, a Simple Camera, and Background";
const CHAPTER_5: &str = "Adding a Sphere";
const CHAPTER_6: &str = "Surface Normals and Multiple Objects";
const CHAPTER_8: &str = "Antialiasing";

const NORMAL_COLOURS: Rules = Rules { shading: Shading::Normals, ..LINEAR };
const IMAGE_GRADIENT: Rules = Rules { shading: Shading::ImageGradient, antialiasing: false, ..LINEAR };

pub(super) const PPM_TINY: Stage = Stage {
    id: "ppm-tiny",
    section: "2.1",
    section_title: "The PPM Image Format",
    chapter_title: CHAPTER_2,
    title: "A picture small enough to read",
    what_is_new: "A file of 16 by 9 pixels: a short header, then three numbers per pixel.",
    why: "Before any light is simulated, the way from a number to a coloured dot must be trusted. \
          At this size every value can be checked by eye.",
    look_for: "Rows come from the top, pixels from the left: red grows to the right, green grows downwards, \
               and the first pixel is black.",
    sight: sights::PPM_TINY,
    pair: None,
    setup: Setup { rules: IMAGE_GRADIENT, width: 16, height: 9, ..ONE_RAY },
};

pub(super) const PPM_GRADIENT: Stage = Stage {
    id: "ppm-gradient",
    section: "2.2",
    section_title: "Creating an Image File",
    chapter_title: CHAPTER_2,
    title: "The same picture at full size",
    what_is_new: "The gradient in the size that all further pictures have.",
    why: "A picture that is known in advance shows at once if rows are swapped, channels mixed up or the \
          last column is missing.",
    look_for: "The corners: black and red above, green and yellow below. Between them is no seam and no border.",
    sight: sights::PPM_GRADIENT,
    pair: None,
    setup: Setup { rules: IMAGE_GRADIENT, ..ONE_RAY },
};

pub(super) const SKY: Stage = Stage {
    id: "sky",
    section: "4.2",
    section_title: "Sending Rays Into the Scene",
    chapter_title: CHAPTER_4,
    title: "The first rays",
    what_is_new: "A camera sends one ray through the middle of each pixel. What a ray brings back depends \
                  only on how steeply it climbs.",
    why: "The gradient is the light of every later scene: it has no lamps, only this sky all around.",
    look_for: "White below, blue above. The bands of equal colour bend slightly, since what counts is the \
               height of a unit direction and not the row.",
    sight: sights::SKY,
    pair: None,
    setup: ONE_RAY,
};

pub(super) const RED_SPHERE: Stage = Stage {
    id: "red-sphere",
    section: "5.2",
    section_title: "Creating Our First Raytraced Image",
    chapter_title: CHAPTER_5,
    title: "Something to hit",
    what_is_new: "Each ray asks whether it meets a sphere: a quadratic equation that has real solutions or \
                  has none.",
    why: "The sign of the discriminant alone separates inside from outside. Everything else in a ray tracer \
          is built on this question.",
    look_for: "A flat red disk. Nothing in it tells a ball from a coin, because no ray reports where it hit.",
    sight: sights::RED_SPHERE,
    pair: None,
    setup: Setup {
        scene: one_sphere,
        rules: Rules { shading: Shading::FirstHitRed, ..ONE_RAY.rules },
        ..ONE_RAY
    },
};

pub(super) const NORMALS: Stage = Stage {
    id: "normals",
    section: "6.1",
    section_title: "Shading with Surface Normals",
    chapter_title: CHAPTER_6,
    title: "Which way the surface faces",
    what_is_new: "The hit point gives a normal, and its three components are shown as red, green and blue.",
    why: "A normal decides where light goes next, so a wrong one spoils every later stage. Painted as a \
          colour it cannot hide.",
    look_for: "Red to the right, green on top, blue where the surface looks at the camera.",
    sight: sights::NORMALS,
    pair: None,
    setup: Setup { scene: one_sphere, rules: Rules { antialiasing: false, ..NORMAL_COLOURS }, ..ONE_RAY },
};

pub(super) const NORMALS_WORLD: Stage = Stage {
    id: "normals-world",
    section: "6.5",
    section_title: "A List of Hittable Objects",
    chapter_title: CHAPTER_6,
    title: "More than one sphere",
    what_is_new: "A list of spheres, of which a ray takes the nearest in front of it. The ground is just a \
                  very large ball.",
    why: "With two things in a scene one can stand before the other, and only the distance along the ray \
          says which.",
    look_for: "The ball covers the ground behind it, and the ground is nearly uniform: its normal hardly \
               turns from straight up.",
    sight: sights::NORMALS_WORLD,
    pair: None,
    setup: Setup {
        scene: matte_on_ground,
        rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
        ..ONE_RAY
    },
};

pub(super) const ALIASED: Stage = Stage {
    id: "aliased",
    section: "8.2",
    section_title: "Generating Pixels with Multiple Samples",
    chapter_title: CHAPTER_8,
    title: "Edges made of steps",
    what_is_new: "Nothing yet: one ray per pixel, the starting point of the comparison.",
    why: "A pixel is an area, but one ray asks about a single point of it. A yes-or-no answer cannot say \
          that the edge runs through the middle.",
    look_for: "The outline of the ball and the horizon are staircases. Zoom in on where they are almost \
               level.",
    sight: sights::ALIASED,
    pair: Some("antialiased"),
    setup: Setup {
        scene: matte_on_ground,
        rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
        ..ONE_RAY
    },
};

pub(super) const ANTIALIASED: Stage = Stage {
    id: "antialiased",
    section: "8.2",
    section_title: "Generating Pixels with Multiple Samples",
    chapter_title: CHAPTER_8,
    title: "Averages over a pixel",
    what_is_new: "Many rays per pixel, each through a different point of it, and their mean.",
    why: "The mean estimates how much of the pixel each surface covers. The same averaging will later \
          gather light, lens and blur for nothing extra.",
    look_for: "Edge pixels take shades between the two sides, and the steps are gone without the inside \
               becoming soft.",
    sight: sights::ANTIALIASED,
    pair: Some("aliased"),
    setup: Setup { rules: NORMAL_COLOURS, samples_per_pixel: 64, max_depth: 1, ..PATHS },
};
