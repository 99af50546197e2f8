//! Chapters 2 to 8: pictures, rays, spheres and their normals, antialiasing.

use super::setups::{LINEAR, ONE_RAY, PATHS};
use crate::scene::builtin::{matte_on_ground, one_sphere};
use crate::stages::{Means, Rules, Setup, Shading, Sight, Stage};

const CHAPTER_2: &str = "Output an Image";
const CHAPTER_4: &str = "Rays, a Simple Camera, and Background";
const CHAPTER_5: &str = "Adding a Sphere";
const CHAPTER_6: &str = "Surface Normals and Multiple Objects";
const CHAPTER_8: &str = "Antialiasing";

const NORMAL_COLOURS: Rules = Rules { shading: Shading::Normals, ..LINEAR };
const IMAGE_GRADIENT: Rules = Rules { shading: Shading::ImageGradient, antialiasing: false, ..LINEAR };

/// The bottom of the ball, where its outline is almost level.
const BOTTOM_OF_THE_BALL: Option<[f64; 4]> = Some([0.46, 0.765, 0.54, 0.81]);

pub(super) const STAGES: &[Stage] = &[
    Stage {
        id: "ppm-tiny",
        section: "2.1",
        section_title: "The PPM Image Format",
        chapter_title: CHAPTER_2,
        title: "A picture small enough to read",
        what_is_new: "A file of 16 by 9 pixels: a short header, then three numbers per pixel.",
        why: "Before any light is simulated, you must be able to trust the way from a number to a coloured \
              dot. At this size every value can be checked by eye.",
        look_for: "Rows come from the top, pixels from the left: red grows to the right, green grows \
                   downwards, and the first pixel is black.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.0, 0.0, 0.3125, 0.334]),
            caption: "The first pixel is black. From there, red grows to the right and green downwards.",
        },
        alt: "A gradient of 16 by 9 large pixels: black at the top left, red at the top right, green at \
              the bottom left, yellow at the bottom right.",
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, width: 16, height: 9, ..ONE_RAY },
    },
    Stage {
        id: "ppm-gradient",
        section: "2.2",
        section_title: "Creating an Image File",
        chapter_title: CHAPTER_2,
        title: "The same picture at full size",
        what_is_new: "The same gradient in the size of most later pictures, 480 by 270 pixels.",
        why: "A picture that is known in advance shows at once if rows are swapped, channels mixed up or \
              the last column is missing.",
        look_for: "The corners: black and red above, green and yellow below. There is no seam and no \
                   border between them.",
        sight: Sight {
            means: Means::Luminance([-4.0, 0.0]),
            part: None,
            caption: "Luminance in false colours: smooth from corner to corner, without a seam or a \
                      border.",
        },
        alt: "A smooth gradient: black at the top left, red at the top right, green at the bottom left, \
              yellow at the bottom right.",
        pair: None,
        setup: Setup { rules: IMAGE_GRADIENT, ..ONE_RAY },
    },
    Stage {
        id: "sky",
        section: "4.2",
        section_title: "Sending Rays Into the Scene",
        chapter_title: CHAPTER_4,
        title: "The first rays",
        what_is_new: "A camera sends one ray through the middle of each pixel. What a ray brings back \
                      depends only on how steeply it climbs.",
        why: "The gradient is the light of every later scene: there are no lamps, only this sky all \
              around.",
        look_for: "White below, blue above. The bands of equal colour bend slightly, since what counts is \
                   the height of a unit direction and not the row.",
        sight: Sight {
            means: Means::Luminance([-0.75, 0.25]),
            part: None,
            caption: "Luminance in false colours: the band at the height of the eye is level, the others \
                      bend away from it.",
        },
        alt: "A gradient from light blue at the top to white at the bottom.",
        pair: None,
        setup: ONE_RAY,
    },
    Stage {
        id: "red-sphere",
        section: "5.2",
        section_title: "Creating Our First Raytraced Image",
        chapter_title: CHAPTER_5,
        title: "Something to hit",
        what_is_new: "Each ray asks whether it meets a sphere: a quadratic equation that has real \
                      solutions or has none.",
        why: "The sign of the discriminant alone separates inside from outside. Everything else in a ray \
              tracer is built on this question.",
        look_for: "A flat red disk. Nothing in it tells a ball from a coin, because no ray reports where \
                   it hit.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: Some([0.3, 0.16, 0.7, 0.84]),
            caption: "Right, one red for every hit. Left, the next stage knows where each ray has hit.",
        },
        alt: "A flat red disk in front of the blue and white sky.",
        pair: Some("normals"),
        setup: Setup {
            scene: one_sphere,
            rules: Rules { shading: Shading::FirstHitRed, ..ONE_RAY.rules },
            ..ONE_RAY
        },
    },
    Stage {
        id: "normals",
        section: "6.1",
        section_title: "Shading with Surface Normals",
        chapter_title: CHAPTER_6,
        title: "Which way the surface faces",
        what_is_new: "The hit point gives a normal, and its three components are shown as red, green and \
                      blue.",
        why: "A normal decides where light goes next, so a wrong one spoils every later stage. Painted as \
              a colour it cannot hide.",
        look_for: "Red to the right, green on top, blue where the surface looks at the camera.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.31, 0.17, 0.69, 0.83]),
            caption: "Red grows to the right, green upwards, and blue towards you.",
        },
        alt: "A ball in the colours of its normals: turquoise at the top, pink on the right, blue in the \
              middle, violet at the bottom.",
        pair: Some("red-sphere"),
        setup: Setup { scene: one_sphere, rules: Rules { antialiasing: false, ..NORMAL_COLOURS }, ..ONE_RAY },
    },
    Stage {
        id: "normals-world",
        section: "6.5",
        section_title: "A List of Hittable Objects",
        chapter_title: CHAPTER_6,
        title: "More than one sphere",
        what_is_new: "A list of spheres, of which a ray takes the nearest in front of it. The ground is \
                      just a very large ball.",
        why: "With two things in a scene one can stand before the other, and only the distance along the \
              ray says which.",
        look_for: "The ball covers the ground behind it, and the ground is nearly uniform: its normal \
                   hardly turns from straight up.",
        sight: Sight {
            means: Means::Picture,
            part: Some([0.56, 0.42, 0.78, 0.68]),
            caption: "The ball hides the horizon, and the ground is one green.",
        },
        alt: "The ball in the colours of its normals, on ground that is light green all over.",
        pair: None,
        setup: Setup {
            scene: matte_on_ground,
            rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
            ..ONE_RAY
        },
    },
    Stage {
        id: "aliased",
        section: "8.2",
        section_title: "Generating Pixels with Multiple Samples",
        chapter_title: CHAPTER_8,
        title: "Edges made of steps",
        what_is_new: "Nothing yet: one ray per pixel, the starting point of the comparison.",
        why: "A pixel is an area, but one ray asks about a single point of it. A yes-or-no answer cannot \
              say that the edge runs through the middle.",
        look_for: "The outline of the ball and the horizon are staircases. Zoom in on where they are \
                   almost level.",
        sight: Sight {
            means: Means::Picture,
            part: BOTTOM_OF_THE_BALL,
            caption: "The bottom of the ball: a pixel is either ball or ground, so the outline goes in \
                      steps.",
        },
        alt: "The ball in the colours of its normals; its outline and the horizon are made of small steps.",
        pair: Some("antialiased"),
        setup: Setup {
            scene: matte_on_ground,
            rules: Rules { antialiasing: false, ..NORMAL_COLOURS },
            ..ONE_RAY
        },
    },
    Stage {
        id: "antialiased",
        section: "8.2",
        section_title: "Generating Pixels with Multiple Samples",
        chapter_title: CHAPTER_8,
        title: "Averages over a pixel",
        what_is_new: "Many rays per pixel, each through a different point of it, and their mean.",
        why: "The mean estimates how much of the pixel each surface covers. The same averaging will later \
              also cover light paths and the lens, at no extra cost.",
        look_for: "Edge pixels take shades between the two sides, and the steps are gone without the \
                   inside becoming soft.",
        sight: Sight {
            means: Means::Wipe(0.5),
            part: BOTTOM_OF_THE_BALL,
            caption: "Left, one ray per pixel. Right, edge pixels have shades between ball and ground.",
        },
        alt: "The same ball with a smooth outline and a smooth horizon.",
        pair: Some("aliased"),
        setup: Setup { rules: NORMAL_COLOURS, samples_per_pixel: 64, max_depth: 1, ..PATHS },
    },
];
